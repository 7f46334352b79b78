# SPDX-License-Identifier: MIT
"""chart.

usage: commands_chart.py MANYLIGHT SCENES [TEST ...]
"""
import json
import signal
import subprocess
import time
import unittest

from program import CommandTest, PROGRAM


class ChartTest(CommandTest):
    def chart(self, *arguments, folder="cornell-chart"):
        run = self.run_program("chart", self.cornell, "--cache", "cache", "--height", 16,
                               *arguments)
        return json.loads((self.folder / folder / "chart.json").read_text()), run

    def test_chart(self):
        chart, run = self.chart("--seeds", 3, "--light-samples", "4,1", "--spp", "1", "--seed", 7,
                                "--samplers", "power,exhaustive,adaptive")
        self.assertEqual(self.files(), ["cache", "cornell-chart"])
        self.assertEqual(sorted(path.name for path in (self.folder / "cornell-chart").iterdir()),
                         sorted(chart["files"]))
        for words in ("64 lights", "relMSE", "reference: exhaustive", "cornell-chart/report.html"):
            self.assertIn(words, run.stdout)
        self.assertNotIn("warning", run.stderr)
        steps = [("exhaustive", 64), ("power", 1), ("power", 4), ("adaptive", 1), ("adaptive", 4)]
        # Seed by seed, all in turn.
        self.assertEqual([(r["sampler"], r["light_samples"], r["seed"]) for r in chart["runs"]],
                         [(*step, seed) for seed in (7, 8, 9) for step in steps])
        for setting in chart["settings"]:
            runs = [r for r in chart["runs"] if (r["sampler"], r["light_samples"]) ==
                    (setting["sampler"], setting["light_samples"])]
            errors = sorted(r["relmse"] for r in runs)
            self.assertEqual(setting["relmse"]["median"], errors[1])
            self.assertAlmostEqual(setting["relmse"]["lower"], (errors[0] + errors[1]) / 2)
            self.assertAlmostEqual(setting["bias"], sum(r["bias"] for r in runs) / 3, places=6)
            seconds = sorted(r["seconds"]["prepare"] + r["seconds"]["render"] for r in runs)
            self.assertAlmostEqual(setting["seconds"]["median"], seconds[1])
        exhaustive = chart["settings"][0]
        self.assertEqual((exhaustive["relmse"]["median"], exhaustive["z"]), (0, None))
        self.assertEqual(chart["reference"]["relmse"], 0)
        self.assertEqual(chart["baseline"], "adaptive")
        # An image of it, made by the command that it tells, has the error that it tells.
        image = next(i for i in chart["images"] if i["sampler"] == "power" and i["equal_samples"])
        self.run_program(*image["command"].split()[1:], "-q")
        found = json.loads(self.run_program("compare", image["command"].split()[-1],
                                            "cornell-chart/reference.exr", "--json").stdout)
        self.assertEqual(found["relmse"], image["relmse"])
        # Again, by the command that it tells, with the reference of the cache.
        again = self.run_program(*chart["command"].split()[1:], "--cache", "cache", "-q")
        self.assertEqual(again.stdout + again.stderr, "")
        second = json.loads((self.folder / "cornell-chart" / "chart.json").read_text())
        self.assertEqual(second["reference"]["images_from_cache"], 1)
        self.assertEqual([r["relmse"] for r in second["runs"]],
                         [r["relmse"] for r in chart["runs"]])
        # Another view has a reference of its own.
        self.chart("--seeds", 1, "--width", 20, "--samplers", "power", "-o", "b", folder="b")
        self.assertEqual(len(list((self.folder / "cache").iterdir())), 2)

    def test_chart_leaves_out_what_takes_too_long(self):
        chart, run = self.chart("--seeds", 2, "--most-seconds", 0.05, "--samplers",
                                "contribution,uniform", "--light-samples", "1,1000,60000", "--spp",
                                1)
        left = [(s["sampler"], s["light_samples"]) for s in chart["left_out"]]
        self.assertIn(("uniform", 60000), left)
        self.assertNotIn(("uniform", 1), left)
        self.assertIn("left out: uniform, 60000 light samples, 1 spp", run.stdout)
        self.assertNotIn(60000, [s["light_samples"] for s in chart["settings"]])
        chart, run = self.chart("--seeds", 1, "--most-seconds", 0.05, "--samplers",
                                "exhaustive,uniform", "--baseline", "uniform",
                                "--light-samples", 60000,
                                "--spp", 1)
        self.assertEqual([s["sampler"] for s in chart["settings"]], ["exhaustive"])
        self.assertIn("warning: --baseline uniform", run.stderr)
        self.assertEqual(chart["baseline"], "exhaustive")

    def test_an_interrupted_chart_goes_on(self):
        arguments = ["chart", self.cornell, "--emitter-points", "0", "--height", "48", "--samplers",
                     "adaptive", "--light-samples", "16", "--seeds", "2", "--spp", "4", "--cache",
                     "cache", "-q"]
        (self.folder / "cache").mkdir()
        run = subprocess.Popen([PROGRAM, *arguments], cwd=self.folder)
        end = time.monotonic() + 120
        while not list((self.folder / "cache").glob("*.exr")):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(60), -signal.SIGINT)
        self.assertEqual(self.files(), ["cache"])
        run = self.run_program(*arguments, "--reference-time", 0.001)
        chart = json.loads((self.folder / "cornell-chart" / "chart.json").read_text())
        reference = chart["reference"]
        self.assertGreaterEqual(reference["images_from_cache"], 1)
        self.assertLess(reference["images"], 8)
        self.assertGreater(reference["relmse"], 0)
        self.assertIn("warning: the reference's own relMSE", run.stderr)
        self.assertTrue(chart["settings"][0]["limited_by_reference"])
        cached = next((self.folder / "cache").glob("*.exr"))
        cached.write_bytes(cached.read_bytes()[:1000])
        run = self.run_program(*arguments, "--reference-time", 0.001)
        self.assertIn(f"warning: {cached.relative_to(self.folder)}: cannot be read", run.stderr)

    def test_chart_converges_its_reference(self):
        chart, run = self.chart("--emitter-points", 0, "--samplers", "adaptive", "--light-samples",
                                16, "--spp", 8, "--seeds", 2)
        reference = chart["reference"]
        self.assertNotIn("warning", run.stderr)
        self.assertGreater(reference["images"], 4)
        self.assertLess(100 * reference["relmse"], reference["judges_relmse"])
        self.assertGreater(reference["luminance_standard_error"], 0)
        self.assertFalse(chart["settings"][0]["limited_by_reference"])

    def test_whole_pixels(self):
        chart, _ = self.chart("--whole", "--emitter-points", 0, "--samplers", "power,adaptive",
                              "--light-samples", 4, "--seeds", 2, "--reference-time", 2)
        self.assertEqual((chart["whole"], chart["spp"]), (True, [4, 16]))
        self.assertIn("--whole", chart["command"])
        self.assertEqual(chart["reference"]["sampler"], "adaptive")
        for run in chart["runs"]:
            self.assertGreater(run["seconds"]["start"], 0)
        setting = chart["settings"][0]
        runs = [r for r in chart["runs"] if all(r[k] == setting[k] for k in
                                                ("sampler", "light_samples", "spp"))]
        seconds = [sum(r["seconds"][k] for k in ("start", "prepare", "render")) for r in runs]
        self.assertAlmostEqual(setting["seconds"]["median"], sum(seconds) / 2)
        # An image of it, made by the command that it tells, has the error that it tells.
        image = chart["images"][0]
        self.assertNotIn("--pixel-centre", image["command"])
        self.run_program(*image["command"].split()[1:], "-q")
        found = json.loads(self.run_program("compare", image["command"].split()[-1],
                                            "cornell-chart/reference.exr", "--json").stdout)
        self.assertAlmostEqual(found["relmse"] / image["relmse"], 1, places=5)

    def test_chart_refuses(self):
        (self.folder / "mine").mkdir()
        (self.folder / "mine" / "thesis.txt").write_text("precious")
        self.write_lamp(lights=False)
        for arguments, words in (
                ([self.cornell, "-o", "mine"], ["--output", "mine", "thesis.txt"]),
                ([self.cornell, "-o", "no/chart"], ["--output", "no/chart", "folder"]),
                ([self.cornell, "-o", "lamp.gltf"], ["--output", "lamp.gltf", "no folder"]),
                ([self.cornell, "--samplers", "power,magic"], ["magic", "uniform"]),
                ([self.cornell, "--light-samples", "4,0"], ["--light-samples", "0"]),
                ([self.cornell, "--spp", "many"], ["--spp", "many"]),
                ([self.cornell, "--whole", "--spp", "1,4"], ["--spp 1", "--whole"]),
                ([self.cornell, "--seeds", "0"], ["--seeds", "0"]),
                ([self.cornell, "--samplers", "power", "--baseline", "ris"],
                 ["--baseline", "ris", "power"]),
                ([self.cornell, "--most-seconds", "-1"], ["--most-seconds", "-1"]),
                ([self.cornell, "--cache", "lamp.gltf"], ["--cache", "lamp.gltf"]),
                (["none.glb"], ["none.glb"])):
            with self.subTest(arguments=arguments):
                self.refuse("chart", *arguments, words=words)
        run = self.run_program("chart", "lamp.gltf", "--headlight", "never", code=2)
        self.assertIn("lamp.gltf: has no lights: samplers have none to choose from", run.stderr)
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["materials"][0]["extensions"] = {"KHR_materials_unlit": {}}
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))
        run = self.run_program("chart", "lamp.gltf", code=2)
        self.assertIn("lamp.gltf: has no lights, but surfaces that are unlit", run.stderr)
        self.assertEqual(self.files(), ["lamp.gltf", "mine"])
        self.assertEqual((self.folder / "mine" / "thesis.txt").read_text(), "precious")


if __name__ == "__main__":
    unittest.main()
