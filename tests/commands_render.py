# SPDX-License-Identifier: MIT
"""What render makes, and when it ends.

usage: commands_render.py MANYLIGHT SCENES [TEST ...]
"""
import json
import re
import time
import unittest

from program import CommandTest, SCENES


class RenderTest(CommandTest):
    def test_render_by_default_makes_a_png_here(self):
        run = self.run_program("render", self.cornell, "--height", 32)
        self.assertEqual(self.files(), ["cornell.png"])
        self.assertIn("64 lights", run.stdout)
        self.assertIn("sampler adaptive", run.stdout)
        self.assertIn("pixels in work", run.stdout)  # what memory will be needed
        self.assertEqual(run.stderr, "")     # nor a bar where there is no terminal

    def test_options_may_come_before_the_file(self):
        self.run_program("render", "-q", "--height", 8, "--aov", "depth", "-o", "a.exr",
                         self.cornell)
        self.assertEqual(self.files(), ["a.exr"])

    def test_render_outputs_and_stats(self):
        self.run_program("render", self.cornell, "--height", 24, "--width", 40, "-o", "a.exr", "-o",
                         "b.png", "--stats", "s.json", "--cluster-map", "c.png", "--sampler",
                         "contribution", "--light-samples", 3, "--spp", 2, "--seed", 7, "--quiet")
        self.assertEqual(self.files(), ["a.exr", "b.png", "c.png", "s.json"])
        stats = json.loads((self.folder / "s.json").read_text())
        for key, value in dict(sampler="contribution", light_samples=3, spp=2, seed=7, width=40,
                               height=24, lights=64, lamp_scale=1, cut_short=False).items():
            self.assertEqual(stats[key], value, key)
        self.assertGreater(stats["clusters"], 3)
        # Two pixel samples, and the rays through the centres that clusters are made from.
        self.assertEqual(stats["rays"]["primary"], 3 * 40 * 24)
        self.assertGreater(stats["rays"]["shadow"], 0)
        self.assertGreater(stats["memory_bytes"]["device_peak"], stats["memory_bytes"]["matrix"])
        self.assertGreater(stats["memory_bytes"]["matrix"], 0)
        self.assertTrue(stats["device"])
        self.assertEqual(sorted(stats["seconds"]),
                         ["build", "compile", "device", "load", "prepare", "render", "start",
                          "total", "upload", "write"])

    def test_seconds_are_all_accounted_for(self):
        begun = time.monotonic()
        run = self.run_program("render", self.cornell, "--height", 200, "--spp", 8, "-o", "a.exr",
                               "--stats", "s.json")
        elapsed = time.monotonic() - begun
        seconds = json.loads((self.folder / "s.json").read_text())["seconds"]
        total = seconds.pop("total")
        self.assertAlmostEqual(sum(seconds.values()), total, places=6)
        self.assertLess(total, elapsed + 0.02)  # the start is known to 10 ms
        self.assertGreater(total, 0.7 * elapsed - 0.3)
        summary = next(line for line in run.stdout.splitlines() if "8 spp" in line)
        parts = re.findall(r"([a-z]+) (\d+\.\d\d)[,)]", summary)
        self.assertEqual([name for name, _ in parts],
                         ["start", "load", "device", "build", "upload", "compile", "prepare",
                          "render", "write"])
        for name, value in parts:
            self.assertAlmostEqual(float(value), seconds[name], delta=0.006)

    def test_stops_where_the_error_is_small_enough(self):
        run = self.run_program("render", self.cornell, "--height", 32, "--target-error", 0.01,
                               "--aov", "error", "-o", "a.exr", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertIn("estimated relMSE", run.stdout)
        self.assertLessEqual(stats["error"]["relmse"], 0.01)
        self.assertGreater(stats["error"]["standard_error"], 0)
        run = self.run_program("render", self.cornell, "--height", 32, "--target-error", 1e-9,
                               "--spp", 4, "-o", "a.exr")
        self.assertIn("--target-error 1e-09: not reached: relMSE may be", run.stderr)

    def test_an_estimate_that_cannot_be_made_is_none(self):
        run = self.run_program("render", self.cornell, "--height", 32, "--target-error", 0.01,
                               "--time", 0.001, "-o", "a.exr", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertEqual(stats["spp"], 1)
        self.assertIsNone(stats["error"])
        self.assertIn("no estimate of relMSE", run.stdout)
        self.assertIn("--target-error 0.01: not reached", run.stderr)
        self.assertRegex(run.stderr, r"--time 0.001: exceeded by [0-9.]+ s \(start .*compile .*\); "
                                     "every pixel gets one sample")
        # Without lights there is nothing to wait for.
        self.write_lamp(lights=False)
        run = self.run_program("render", "lamp.gltf", "--height", 16, "--target-error", 0.01, "-q",
                               "--headlight", "never", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertIsNone(stats["error"])
        self.assertGreater(stats["spp"], 1)
        self.assertIn("--target-error 0.01: not reached", run.stderr)
        # Nor is more said of errors than there is to say.
        run = self.run_program("render", self.cornell, "--height", 16, "--stats", "s.json")
        self.assertNotIn("error", json.loads((self.folder / "s.json").read_text()))
        self.assertNotIn("relMSE", run.stdout)

    def test_mostly_noise_is_said(self):
        run = self.run_program("render", SCENES / "blinds.glb", "--height", 32, "--sampler",
                               "uniform", "--light-samples", 1, "--aov", "error", "-o", "a.exr")
        self.assertIn("(95%), or more: the image is mostly noise", run.stdout)
        run = self.run_program("render", self.cornell, "--height", 32, "--spp", 16, "--aov",
                               "error", "-o", "a.exr")
        self.assertNotIn("or more", run.stdout)

    def test_stops_in_time(self):
        self.run_program("render", self.cornell, "--height", 32, "--time", 0.2, "-o", "a.exr",
                         "--stats", "s.json")
        self.assertGreaterEqual(json.loads((self.folder / "s.json").read_text())["spp"], 1)

    def test_quiet_prints_nothing(self):
        run = self.run_program("render", self.cornell, "--height", 8, "-q")
        self.assertEqual(run.stdout + run.stderr, "")

    def test_same_seed_same_image(self):
        for name, seed in (("a.exr", 3), ("b.exr", 3), ("c.exr", 4)):
            self.run_program("render", self.cornell, "--height", 32, "--seed", seed, "-o", name)
        a, b, c = (header["pixels"] for header in self.headers("a.exr", "b.exr", "c.exr"))
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)

    def test_emitter_points(self):
        for points, lights in ((0, 4), (9, 9)):
            self.run_program("render", self.cornell, "--height", 8, "--emitter-points", points,
                             "--stats", "s.json", "-q")
            self.assertEqual(json.loads((self.folder / "s.json").read_text())["lights"], lights)

    def test_top_lights(self):
        run = self.run_program("render", self.cornell, "--height", 32, "--top-lights", 3, "--stats",
                               "s.json", "-o", "a.png")
        top = json.loads((self.folder / "s.json").read_text())["top_lights"]
        self.assertEqual(len(top["lights"]), 3)
        self.assertGreater(top["points"], 500)
        self.assertEqual(top["light_samples"], 16)
        for light in top["lights"]:
            self.assertIn(f"oriented light {light['light']} ", run.stdout)
            self.assertTrue(0 < light["standard_error"] < light["share"] < 0.05, light)
            self.assertTrue(0 < light["seen"] <= 1, light)
        for words in ("of the light", "seen from", "16 draws", "standard error"):
            self.assertIn(words, run.stdout)
        self.write_lamp()
        run = self.run_program("render", "lamp.gltf", "--height", 16, "--top-lights", 5)
        self.assertIn("point light 'lamp'", run.stdout)
        self.assertIn("100.00%", run.stdout)
        self.write_lamp(lights=False)
        run = self.run_program("render", "lamp.gltf", "--height", 16, "--top-lights", 5,
                               "--headlight", "never")
        self.assertIn("no light reaches the image", run.stdout)
        self.refuse("render", self.cornell, "--top-lights", 0, words=["--top-lights", "0"])

    def test_shift(self):
        view = [self.cornell, "--pixel-centre", "--sampler", "exhaustive", "--width", 24,
                "--height", 24, "--spp", 1, "-q"]
        self.run_program("render", *view, "-o", "a.exr")
        for text in ("1", "1,", "1,2,3", "x,1", "1e9,0", "nan,0", ""):
            self.refuse("render", *view, "-o", "b.exr", "--shift", text, words=["--shift"])
        self.run_program("render", *view, "--shift", "0,0", "-o", "b.exr")
        compare = ["compare", "a.exr", "b.exr", "--json"]
        self.assertEqual(json.loads(self.run_program(*compare).stdout)["relmse"], 0)
        self.run_program("render", *view, "--shift", "-3,2.5", "-o", "b.exr")
        self.assertGreater(json.loads(self.run_program(*compare).stdout)["relmse"], 0.01)


if __name__ == "__main__":
    unittest.main()
