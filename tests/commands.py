# SPDX-License-Identifier: MIT
"""Runs whole commands as a user would: files made, messages, exit codes.

usage: commands.py MANYLIGHT SCENES
"""
import base64
import json
import os
import pathlib
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
SCENES = pathlib.Path(sys.argv.pop(1)).resolve()


class CommandTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cornell = str(SCENES / "cornell.glb")

    def run_program(self, *arguments, code=0):
        run = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True,
                             cwd=self.folder, timeout=600)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run

    def refuse(self, *arguments, words, code=2):
        run = self.run_program(*arguments, code=code)
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        self.assertTrue(run.stderr.startswith("error: "), run.stderr)
        for word in words:
            self.assertIn(word, run.stderr)

    def oiio(self, *arguments):
        subprocess.run(["oiiotool", *arguments], cwd=self.folder, check=True)

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())

    def write_lamp(self, lights=True):
        """A triangle of material 'paint' below a light 'lamp'; the camera frames it."""
        corners = struct.pack("<9f", -1, 0, 1, 1, 0, 1, 0, 0, -1)
        scene = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0, 1] if lights else [0]}],
            "nodes": [{"mesh": 0}, {"name": "lamp", "translation": [0, 1, 0],
                                    "extensions": {"KHR_lights_punctual": {"light": 0}}}],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3}]}},
            "materials": [{"name": "paint"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [-1, 0, -1], "max": [1, 0, 1]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," +
                         base64.b64encode(corners).decode()}]}
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))

    def write_moving_lamp(self):
        """The same with a camera 'eye', a variant 'night' and a lamp that moves, an emitter, and a
        mesh in two places."""
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["materials"] += [{"name": "blue", "pbrMetallicRoughness":
                                {"baseColorFactor": [0.1, 0.2, 0.9, 1]}},
                               {"emissiveFactor": [1, 1, 1]}]
        scene["extensionsUsed"].append("KHR_materials_variants")
        scene["extensions"]["KHR_materials_variants"] = {"variants": [{"name": "night"}]}
        scene["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {
            "mappings": [{"material": 1, "variants": [0]}]}}
        scene["meshes"].append({"primitives": [{"attributes": {"POSITION": 0}, "material": 2}]})
        scene["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1,
                                                                    "aspectRatio": 1}}]
        scene["nodes"] += [{"name": "eye", "camera": 0, "translation": [0, 0.7, 3]},
                           {"mesh": 0, "translation": [0, 0.3, -1]},
                           {"mesh": 1, "translation": [0, 2, 0], "rotation": [1, 0, 0, 0],
                            "scale": [0.2, 0.2, 0.2]}]
        scene["scenes"][0]["nodes"] += [2, 3, 4]
        values = struct.pack("<8f", 0, 1, 0, 1, 0, 0.2, 1, 1)  # two moments, two places
        scene["buffers"].append({"byteLength": 32, "uri": "data:application/octet-stream;base64," +
                                 base64.b64encode(values).decode()})
        scene["bufferViews"] += [{"buffer": 1, "byteLength": 8},
                                 {"buffer": 1, "byteOffset": 8, "byteLength": 24}]
        scene["accessors"] += [{"bufferView": 1, "componentType": 5126, "count": 2,
                                "type": "SCALAR",
                                "min": [0], "max": [1]},
                               {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}]
        scene["animations"] = [{"samplers": [{"input": 1, "output": 2}], "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "translation"}}]}]
        (self.folder / "moving.gltf").write_text(json.dumps(scene))
        return "moving.gltf"

    # What render makes.

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
        for name in ("a.exr", "b.exr"):
            self.run_program("render", self.cornell, "--height", 32, "--seed", 3, "-o", name)
        run = self.run_program("compare", "a.exr", "b.exr", "--json")
        self.assertEqual(json.loads(run.stdout)["rmse"], 0)
        self.run_program("render", self.cornell, "--height", 32, "--seed", 4, "-o", "b.exr")
        run = self.run_program("compare", "a.exr", "b.exr", "--json")
        self.assertGreater(json.loads(run.stdout)["relmse"], 0)

    def test_header_and_layers_of_an_exr(self):
        self.run_program("render", self.cornell, "--height", 16, "-o", "a.exr", "--aov",
                         "normal,depth", "--aov", "lights", "--seed", 4294967295)
        header = subprocess.run(["oiiotool", "--info", "-v", "a.exr"], cwd=self.folder,
                                capture_output=True, text=True, check=True).stdout
        for words in ("8 channel, float openexr",
                      "R, G, B, depth.Z, lights.Y, normal.X, normal.Y, normal.Z",
                      'manylight:sampler: "contribution-defensive"',
                      'manylight:seed: "4294967295"', "manylight:version:", "manylight:device:",
                      "manylight:seconds:", 'manylight:first_light_samples: "4"',
                      'manylight:lamp_scale: "1.0"', 'manylight:shift: "0,0"'):
            self.assertIn(words, header)
        self.assertNotIn("albedo", header)

    def facts(self, image):
        """The program's facts in an image's header, by name."""
        text = subprocess.run(["oiiotool", "--info", "-v", image], cwd=self.folder,
                              capture_output=True, text=True, check=True).stdout
        return {name: value.strip('"') for name, value in
                re.findall(r"^ *manylight:(\w+): (.*)$", text, re.M)}

    def rmse(self, a, b):
        return json.loads(self.run_program("compare", a, b, "--json").stdout)["rmse"]

    # What an image does not depend on, or not by itself.
    NOT_OF_THE_IMAGE = {"help", "output", "time", "threads", "cluster-map", "top-lights", "stats",
                        "checkpoint", "checkpoint-every", "resume", "quiet", "like"}

    def test_headers_tell_all_options(self):
        scene = self.write_moving_lamp()
        given = ["--camera", "eye", "--emitter-points", 3, "--at", 0.7, "--lamp-scale", 0.1,
                 "--variant", "night", "--instances", "copied", "--device", 0, "--device-form",
                 "gpu", "--height", 12, "--shift", "2,-0.5", "--light-samples", 3, "--spp", 2,
                 "--target-error", 1e-6, "--exposure", 1.5, "--memory", "512M",
                 "--seed", 4294967295, "--normal-threshold", 9.3, "--cull-back-faces",
                 "--pixel-centre", "--hide-emitters", "--no-reflections", "--sampler", "uniform"]
        self.run_program("render", scene, "-o", "a.exr", "-o", "a.png", "-q", *given)
        # The one layer that changes where samples lie.
        self.run_program("render", scene, "-o", "b.exr", "--aov", "error,depth", "-q",
                         "--height", 8)
        told = self.facts("a.png")
        self.assertEqual({k: v for k, v in self.facts("a.exr").items() if k != "seconds"},
                         {k: v for k, v in told.items() if k not in ("exposure", "seconds")})
        self.assertEqual(self.facts("b.exr")["aov"], "error")
        text = self.run_program("render", "--help").stdout
        options = set(re.findall(r"^  (?:-\w,)?--([a-z-]+)", text, re.M))
        self.assertGreater(len(options), 30)
        self.assertEqual({o for o in options - self.NOT_OF_THE_IMAGE
                          if o.replace("-", "_") not in told}, {"aov"})
        for name, value in dict(camera="eye", emitter_points="3", at="0.7", lamp_scale="0.1",
                                variant="night", instances="copied", device_form="gpu",
                                width="12", height="12", shift="2,-0.5", light_samples="3",
                                spp="2", exposure="1.5", seed="4294967295",
                                normal_threshold="9.3", cull_back_faces="true",
                                pixel_centre="true", hide_emitters="true", no_reflections="true",
                                memory="536870912", file="moving.gltf").items():
            self.assertEqual(told[name], value, name)

    def test_like_repeats_a_render(self):
        scene = self.write_moving_lamp()
        given = ["--at", 0.7, "--lamp-scale", 0.1, "--variant", "night", "--shift", "2,-0.3",
                 "--light-samples", 3, "--spp", 3, "--seed", 5, "--height", 16, "--sampler",
                 "uniform"]
        self.run_program("render", scene, "-o", "a.exr", "-o", "a.png", "-q", *given)
        for like in ("a.exr", "a.png"):
            self.run_program("render", "--like", like, "-o", "b.exr", "-o", "b.png", "-q")
            self.assertEqual(self.rmse("b.exr", "a.exr"), 0)
            self.assertEqual(self.rmse("b.png", "a.png"), 0)
            self.assertEqual({k: v for k, v in self.facts("b.exr").items() if k != "seconds"},
                             {k: v for k, v in self.facts("a.exr").items() if k != "seconds"})
        # The command line counts, flags as well, and a picture's exposure is one that may be asked.
        self.run_program("render", "--like", "a.png", "--lamp-scale", 0.2, "--hide-emitters",
                         "--spp", 2, "-o", "b.exr", "-o", "b.png", "-q")
        told, before = self.facts("b.png"), self.facts("a.png")
        self.assertEqual((told["lamp_scale"], told["hide_emitters"], told["spp"], told["seed"],
                          told["exposure"]), ("0.2", "true", "2", "5", before["exposure"]))
        self.assertGreater(self.rmse("b.exr", "a.exr"), 0)
        # A stop by the error, its layer, for which a picture has no place, and clusters.
        for more in (["--target-error", "0.02"], ["--aov", "error"],
                     ["--sampler", "contribution", "--max-depth", "1"]):
            self.run_program("render", self.cornell, "--height", 16, "-q", "-o", "c.exr", *more)
            self.run_program("render", "--like", "c.exr", "-o", "d.exr", "-q")
            self.assertEqual(self.rmse("d.exr", "c.exr"), 0, more)
        self.run_program("render", "--like", "c.exr", "--aov", "error", "-o", "d.exr", "-q")
        self.run_program("render", "--like", "d.exr", "-o", "d.png", "-q")

    def test_like_says_what_it_cannot_repeat(self):
        self.write_lamp()
        self.run_program("render", "lamp.gltf", "--height", 8, "-o", "a.exr", "-q")
        self.oiio("a.exr", "--eraseattrib", "manylight:.*", "-o", "plain.exr")
        self.refuse("render", "--like", "plain.exr", words=["--like plain.exr", "header"])
        self.refuse("render", "--like", "none.exr", words=["none.exr"])
        self.oiio("a.exr", "--attrib", "manylight:cut_short", "true", "--attrib", "manylight:spp",
                  "1.25", "--attrib", "manylight:version", "0.0.1", "-o", "old.exr")
        run = self.run_program("render", "--like", "old.exr", "-o", "b.exr")
        self.assertIn("warning: --like old.exr: was cut short at 1.25 spp; 2 are", run.stderr)
        self.assertIn("was rendered by manylight 0.0.1", run.stderr)
        self.assertIn(" 2 spp", run.stdout)
        self.oiio("a.exr", "--attrib", "manylight:sampler", "magic", "-o", "bad.exr")
        self.refuse("render", "--like", "bad.exr", words=["magic"])
        self.oiio("a.exr", "--attrib", "manylight:width", "none", "-o", "bad.exr")
        self.refuse("render", "--like", "bad.exr", words=["--like bad.exr", "--width", "none"])

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

    def test_warnings_do_not_stop(self):
        scene = json.loads('{"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_ies"]}')
        (self.folder / "dark.gltf").write_text(json.dumps(scene))
        run = self.run_program("render", "dark.gltf", "--height", 8)
        self.assertIn("warning: dark.gltf: extension KHR_lights_ies", run.stderr)
        self.assertIn("no lights", run.stderr)
        self.assertIn("dark.png", self.files())

    def black(self, *arguments, change=lambda scene: None):
        """What is said of a black image of the lamp's scene, seen from a camera at (0, 1, 3)."""
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}]
        scene["nodes"].append({"camera": 0, "translation": [0, 1, 3]})
        scene["scenes"][0]["nodes"].append(2)
        change(scene)
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))
        run = self.run_program("render", "lamp.gltf", "--height", 16, "-q", *arguments)
        lines = [line for line in run.stderr.splitlines() if "black" in line]
        self.assertEqual(len(lines), 1 if lines else 0, run.stderr)
        return lines[0] if lines else ""

    def test_black_images_say_why(self):
        self.assertEqual(self.black(), "")

        def look_away(scene):
            scene["nodes"][2]["rotation"] = [0, 1, 0, 0]

        def go_below(scene):
            scene["nodes"][2]["translation"] = [0, -1, 3]

        def cover(scene):
            scene["nodes"].append({"mesh": 1, "translation": [0, 0.5, 0], "scale": [9, 1, 9]})
            scene["meshes"].append(json.loads(json.dumps(scene["meshes"][0])))
            scene["meshes"][1]["primitives"][0]["material"] = 1
            scene["materials"].append({"name": "glass"})
            scene["scenes"][0]["nodes"].append(3)
            scene["nodes"][2].update(translation=[0, 0.4, 0], rotation=[-0.7071, 0, 0, 0.7071])

        def paint(scene):
            scene["materials"][0]["pbrMetallicRoughness"] = {"baseColorFactor": [0, 0, 0, 1],
                                                             "metallicFactor": 0}
            scene["materials"][0]["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
            scene["extensionsUsed"].append("KHR_materials_specular")

        def switch_off(scene):
            scene["scenes"][0]["nodes"] = [0, 2]

        def shine(scene):
            switch_off(scene)
            scene["materials"][0]["emissiveFactor"] = [1, 1, 1]

        def shorten(scene):
            scene["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = 0.1

        def empty(scene):
            scene["scenes"][0]["nodes"] = [1, 2]

        for change, arguments, words in (
                (look_away, [], "no geometry is in view"),
                (go_below, [], "from below a floor"),
                (cover, [], "block all light on its way to what is in view, most of it those of "
                            "material 'glass'"),
                (paint, [], "reflects none"),
                (switch_off, ["--headlight", "never"], "no lights"),
                (shine, ["--hide-emitters"], "--hide-emitters"),
                (shorten, [], "out of range"),
                (empty, [], "no triangles")):
            with self.subTest(change=change.__name__):
                said = self.black(*arguments, change=change)
                self.assertIn("warning: the image is black: ", said)
                self.assertIn(words, said)

    def test_light_that_should_go_through(self):
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["extensionsUsed"] += ["KHR_materials_transmission", "KHR_materials_clearcoat"]
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))
        lines = self.run_program("render", "lamp.gltf", "--height", 8, "-q").stderr.splitlines()
        self.assertEqual(lines, [
            "warning: lamp.gltf: extension KHR_materials_clearcoat is not rendered",
            "warning: lamp.gltf: extension KHR_materials_transmission is not rendered: its "
            "surfaces are opaque, and block the light of lamps behind them"])

    # What names hold that files or users make up.

    def test_names_do_not_command_the_terminal(self):
        evil = "\x1b[31m\x07\nerror: fake\x7f\x9b2J\u202e"
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["nodes"][1]["name"] = "lamp" + evil
        scene["materials"][0]["name"] = "paint" + evil
        scene["cameras"] = [{"type": "perspective", "name": "eye" + evil,
                             "perspective": {"yfov": 1, "znear": 0.1}}]
        scene["nodes"].append({"camera": 0, "translation": [0, 1, 4]})
        scene["scenes"][0]["nodes"].append(2)
        scene["extensionsUsed"].append("EXT" + evil)
        name = "evil\x1b[31m\nerror: fake.gltf"
        (self.folder / name).write_text(json.dumps(scene))
        runs = [self.run_program("render", name, "--height", 16, "--top-lights", 2,
                                 "--stats", "s.json"),
                self.run_program("inspect", name, "--height", 16, "--pixel", "14,11",
                                 "--json", "i.json"),
                self.run_program("verify", name, "--width", 16),
                self.run_program("render", name, "--camera", evil, code=2),
                self.run_program("render", "no" + name, code=2),
                self.run_program("compare", name, name, code=2),
                self.run_program(evil, code=2)]
        scene["extensionsRequired"] = ["EXT" + evil]
        (self.folder / name).write_text(json.dumps(scene))
        runs.append(self.run_program("render", name, code=2))
        for run in runs:
            with self.subTest(arguments=run.args):
                for text in (run.stdout, run.stderr):
                    self.assertFalse([c for c in text if c != "\n" and not c.isprintable()], text)
                    self.assertFalse([line for line in text.splitlines()
                                      if line.startswith("error: fake")], text)
                if run.returncode != 0:
                    self.assertEqual(("\n" + run.stderr).count("\nerror: "), 1)
                    self.assertTrue(run.stderr.splitlines()[-1].startswith("error: "), run.stderr)
        for report in ("s.json", "i.json"):
            text = (self.folder / report).read_text()
            self.assertFalse([c for c in text if c != "\n" and not c.isprintable()], text)
            self.assertIn("lamp" + json.dumps(evil)[1:-1], text)
        words = ["lamp\\x1b[31m\\x07\\nerror: fake\\x7f\\u009b2J\\u202e", "eye\\x1b[31m"]
        for word in words:
            self.assertIn(word, runs[0].stdout)
        self.assertIn("paint\\x1b[31m", runs[1].stdout)
        self.assertIn("extension EXT\\x1b[31m\\x07\\nerror", runs[0].stderr)

    def test_broken_unicode_is_shown_as_bytes(self):
        run = subprocess.run([PROGRAM, "render", b"a\xff\xc0\xaf\xed\xa0\x80\xe2\x82\xc3\xa9.glb"],
                             capture_output=True, cwd=self.folder)
        self.assertEqual(run.returncode, 2)
        self.assertEqual(run.stderr,
                         b"error: a\\xff\\xc0\\xaf\\xed\\xa0\\x80\\xe2\\x82\xc3\xa9.glb: "
                                     b"no such file\n")

    def test_json_for_programs_holds_no_raw_controls(self):
        self.run_program("render", self.cornell, "--height", 8, "-q", "-o", "a.exr")
        name = "\x1b[31m\x9b\u202e.exr"
        (self.folder / name).write_bytes((self.folder / "a.exr").read_bytes())
        run = self.run_program("compare", name, "a.exr", "--ref", "a.exr", "--json")
        self.assertTrue(run.stdout[:-1].isprintable(), run.stdout)
        self.assertEqual(json.loads(run.stdout)["images"][0]["file"], name)

    def test_headlight(self):
        def mean(*options):
            """The image's mean red, and the lines about headlights or the lack of lights."""
            run = self.run_program("render", "lamp.gltf", "-o", "a.exr", "--height", 16, "--spp", 2,
                                   "--stats", "s.json", "--seed", 3, *options)
            self.assertEqual(json.loads((self.folder / "s.json").read_text())["spp"], 2)
            stats = subprocess.run(["oiiotool", "--stats", "a.exr"], cwd=self.folder, check=True,
                                   capture_output=True, text=True).stdout
            said = [line for line in run.stderr.splitlines() if "light" in line]
            return float(re.search(r"Stats Avg: +([-\d.e]+)", stats).group(1)), said

        self.write_lamp(lights=False)
        light, said = mean()
        self.assertGreater(light, 0.01)
        self.assertEqual(len(said), 1)
        self.assertIn("headlight", said[0])
        self.refuse("render", "lamp.gltf", "--checkpoint", "state", "--resume", "--headlight",
                    "sometimes", words=["--headlight", "sometimes"])
        dark, said = mean("--headlight", "never")
        self.assertEqual(dark, 0)
        for line in said:  # of the scene, and of the black image
            self.assertIn("no lights", line)
        self.write_lamp()
        plain, said = mean("--checkpoint", "state")
        self.assertEqual(said, [])
        self.assertGreater(mean("--headlight", "always")[0], plain)
        self.assertEqual(mean("--headlight", "never")[0], plain)
        self.refuse("render", "lamp.gltf", "--height", 16, "--spp", 3, "--seed", 3, "--checkpoint",
                    "state", "--resume", "--headlight", "always", words=["another render"])

    def test_variants_of_materials(self):
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        scene["materials"].append({"name": "other"})
        scene["extensions"]["KHR_materials_variants"] = {"variants": [{"name": "night"}]}
        scene["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {
            "mappings": [{"material": 1, "variants": [0]}]}}
        scene["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
        scene["nodes"].append({"camera": 0, "translation": [0, 1, 4]})
        scene["scenes"][0]["nodes"].append(2)
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))
        arguments = ["inspect", "lamp.gltf", "--height", 16, "--pixel", "14,11"]
        self.assertIn("paint", self.run_program(*arguments).stdout)
        self.assertIn("other", self.run_program(*arguments, "--variant", "night").stdout)
        self.refuse(*arguments, "--variant", "day", words=["--variant day", "'night'"])

    # What the machine does not take.

    def test_a_full_standard_output_is_an_error(self):
        for arguments in (["render", self.cornell, "--height", "8"], ["--help"], ["devices"],
                          ["render", "--help"], ["scene", "--list"], ["--version"]):
            with self.subTest(arguments=arguments), open("/dev/full", "w") as full:
                run = subprocess.run([PROGRAM, *arguments], stdout=full, stderr=subprocess.PIPE,
                                     text=True, cwd=self.folder, timeout=600)
                self.assertEqual(run.returncode, 1)
                self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
                self.assertTrue(run.stderr.startswith("error: standard output cannot be written"))

    def test_a_full_standard_error_keeps_the_status(self):
        with open("/dev/full", "w") as full:
            run = subprocess.run([PROGRAM, "render", "none.glb"], stderr=full, cwd=self.folder)
        self.assertEqual(run.returncode, 2)

    def test_names_too_long(self):
        for option, name in (("-o", 252 * "x" + ".exr"), ("-o", 2048 * "./" + "a.exr"),
                             ("--stats", 256 * "s"), ("--checkpoint", 256 * "c")):
            with self.subTest(option=option, name=name[-10:]):
                self.refuse("render", self.cornell, "--height", 8, option, name,
                            words=[option, "too long"])
                self.assertEqual(self.files(), [])
        self.refuse("chart", self.cornell, "-o", 256 * "x", words=["--output", "too long"])
        name = 251 * "x" + ".png"  # the longest that there is
        self.run_program("render", self.cornell, "--height", 8, "-q", "-o", name)
        self.assertEqual(self.files(), [name])

    def test_an_empty_cache_folder_is_none(self):
        run = subprocess.run([PROGRAM, "devices"], capture_output=True, text=True,
                             env={**os.environ, "POCL_CACHE_DIR": ""})
        self.assertEqual(run.returncode, 0, run.stderr)

    # What is refused.

    def test_bad_options(self):
        out = ["-o", "x.exr"]
        for arguments, words in (
                (["--sampler", "magic"], ["--sampler", "magic", "uniform"]),
                (["--light-samples", 0], ["--light-samples", "0"]),
                (["--light-samples", "many"], ["--light-samples", "many"]),
                (["--spp", -1], ["--spp", "-1"]),
                (["--spp", 2.5], ["--spp", "2.5"]),
                (["--seed", 2**32], ["--seed", str(2**32)]),
                (["--width", 0], ["--width", "0"]),
                (["--height", 70000], ["--height", "70000"]),
                (["--memory", "lots"], ["--memory", "lots"]),
                (["--memory", "1M"], ["--memory", "1.0 MiB"]),
                (["--device", "abacus"], ["--device", "abacus"]),
                (["--device", 99], ["--device", "99"]),
                (["--camera", "top"], ["--camera", "top", "front"]),
                (["--threads", 1000], ["--threads", "1000"]),
                (["--tile-size", 33], ["--tile-size", "33"]),
                (["--max-depth", 8], ["--max-depth", "8"]),
                (["--visibility-threshold", 1.5], ["--visibility-threshold", "1.5"]),
                (["--time", 0], ["--time", "0"]),
                (["--time", "soon"], ["--time", "soon"]),
                (["--target-error", "small"], ["--target-error", "small"]),
                (["--target-error", 0.1, "--spp", 1], ["--spp 1", "two or more"]),
                (["--aov", "error", "--spp", 1], ["--spp 1", "two or more"]),
                (["--aov", "smell"], ["--aov", "smell"]),
                (["--aov", "cluster", "--sampler", "power"], ["--aov", "cluster", "power"]),
                (["--lamp-scale", 0], ["--lamp-scale", "0"]),
                (["--exposure", "bright"], ["--exposure", "bright"]),
                (["--colour"], ["--colour"])):
            with self.subTest(arguments=arguments):
                self.refuse("render", self.cornell, *out, *arguments, words=words)
                self.assertEqual(self.files(), [])

    def test_bad_outputs(self):
        (self.folder / "folder.exr").mkdir()
        for name, words in (("a.jpg", ["a.jpg", ".exr"]), ("no/a.exr", ["no/a.exr", "folder"]),
                            ("folder.exr", ["folder.exr", "regular"])):
            with self.subTest(name=name):
                self.refuse("render", self.cornell, "-o", name, words=words)

    def test_outputs_do_not_overwrite_each_other_or_the_scene(self):
        scene = self.folder / "x.png"  # a scene by another name
        scene.write_bytes(pathlib.Path(self.cornell).read_bytes())
        for arguments, words in (
                (["-o", "a.exr", "-o", "./a.exr"], ["a.exr", "--output"]),
                (["-o", "a.png", "--cluster-map", "a.png"], ["a.png", "--cluster-map"]),
                (["-o", "a.png", "--stats", "a.png"], ["a.png", "--stats"]),
                (["-o", "x.png"], ["x.png", "scene"])):
            with self.subTest(arguments=arguments):
                self.refuse("render", "x.png", *arguments, words=words)
                self.assertEqual(self.files(), ["x.png"])

    def test_files_of_the_scene_are_no_outputs(self):
        document = {"asset": {"version": "2.0"}, "images": [{"uri": "house.png"}]}
        (self.folder / "house.gltf").write_text(json.dumps(document))
        (self.folder / "house.png").write_bytes(b"the scene's texture")
        run = self.run_program("render", "house.gltf", "--height", 16, code=2)
        self.assertIn("error: --output house.png: is a file of the scene", run.stderr)
        self.assertEqual((self.folder / "house.png").read_bytes(), b"the scene's texture")

    def test_what_a_killed_process_left_is_in_nobodys_way(self):
        script = (f'touch .x.exr.$$-0.part; '
                  f'exec "{PROGRAM}" render "{self.cornell}" --height 8 -q -o x.exr')
        subprocess.run(["bash", "-c", script], cwd=self.folder, check=True)
        self.assertIn("x.exr", self.files())

    def test_layers_need_an_exr(self):
        self.refuse("render", self.cornell, "-o", "a.png", "--aov", "depth",
                    words=["--aov", ".exr"])

    def test_a_refusal_keeps_the_old_output(self):
        old = self.folder / "a.exr"
        old.write_bytes(b"precious")
        (self.folder / "bad.gltf").write_text("{}")
        self.refuse("render", "bad.gltf", "-o", "a.exr", words=["bad.gltf", "asset"])
        self.refuse("render", self.cornell, "-o", "a.exr", "--memory", "1M", words=["--memory"])
        self.assertEqual(old.read_bytes(), b"precious")
        self.assertEqual(self.files(), ["a.exr", "bad.gltf"])

    def test_missing_arguments(self):
        self.refuse(words=["no command", "--help"])
        for arguments, what in ((["render"], "render: the scene's file"),
                                (["scene", "cornell"], "scene: --output FILE.glb"),
                                (["inspect", "a.glb"], "inspect: --pixel X,Y"),
                                (["chart"], "chart: the scene's file"),
                                (["compare", "a.exr"], "compare: the image that it should be"),
                                (["compare", "--ref", "a.exr"], "compare: the image to judge"),
                                (["bench"],
                                 "bench: what to measure (traversal, stages or a file)")):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, words=[f"error: {what} is missing; 'manylight "
                                               f"{arguments[0]} --help' shows examples"])

    def test_mistyped_words(self):
        for arguments, words in (
                (["rendr", self.cornell], "rendr: is no command; did you mean render?"),
                (["chrat", "--seeds", 3], "chrat: is no command; did you mean chart?"),
                (["picture"], "picture: is no command\n"),
                (["room.glb", "-o", "a.png"],
                 "room.glb: is no command; 'manylight render room.glb' renders it"),
                (["help", "verfy"], "help: verfy: is no command; did you mean verify?"),
                (["render", self.cornell, "--ssp", 4],
                 "render: --ssp: there is no such option; did you mean --spp?"),
                (["render", self.cornell, "--pixel-center"],
                 "render: --pixel-center: there is no such option; did you mean --pixel-centre?"),
                (["render", self.cornell, "--check"], "did you mean --checkpoint?"),
                (["render", self.cornell, "--light_samples=4"], "did you mean --light-samples?"),
                (["render", self.cornell, "--colour"], "--colour: there is no such option\n"),
                (["render", self.cornell, "other.glb"],
                 "render: other.glb: is one argument too many"),
                (["render", self.cornell, "--instances", "foo"],
                 "--instances: foo is not auto, copied or shared"),
                (["verify", "--device-form", "5"],
                 "--device-form: 5 is not 16, 4, 8, auto or gpu"),
                (["bench", "traversal", "--bvh-width", "5"], "--bvh-width: 5 is not 16, 4 or 8"),
                (["chart", self.cornell, "--samplers", "foo"],
                 "--samplers foo: no such sampler (there are: exhaustive"),
                (["verify", "--instances", "shared"], "--instances go with a file")):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, words=[words])

    def test_help_of_a_command(self):
        for arguments, same in ((["help", "render"], ["render", "--help"]), (["help"], ["--help"])):
            self.assertEqual(self.run_program(*arguments).stdout, self.run_program(*same).stdout)

    # inspect.

    def test_inspect(self):
        run = self.run_program("inspect", self.cornell, "--height", 32, "--pixel", "16,20",
                               "--json", "i.json", "--top-lights", 320)
        self.assertEqual(self.files(), ["cornell-pixel.png", "i.json"])
        facts = json.loads((self.folder / "i.json").read_text())
        for key, value in dict(pixel=[16, 20], tile=0, hit=True, width=32, height=32, lights=64,
                               light_samples=4, spp=4, seed=0).items():
            self.assertEqual(facts[key], value, key)
        nodes = facts["ranked"]
        self.assertEqual(sorted(n["light"] for n in nodes), list(range(64)))
        self.assertAlmostEqual(sum(n["draws"] for n in nodes), facts["draws"])
        self.assertAlmostEqual(sum(n["contribution"] for n in nodes), facts["luminance"])
        self.assertAlmostEqual(sum(n["noise_share"] for n in nodes) + facts["count_noise_share"], 1)
        importance = [max(n["contribution"] / facts["luminance"], n["draws"] / facts["draws"],
                          n["noise_share"]) for n in nodes]
        self.assertEqual(importance, sorted(importance, reverse=True))
        for words in ("pixel 16, 20 of 32 x 32", "surface: ", "material ", "a cut of 64 nodes",
                      f"oriented light {nodes[0]['light']} ", "V^", "deviates by",
                      "wrote cornell-pixel.png", "wrote i.json", *facts["explanation"]):
            self.assertIn(words, run.stdout)
        self.run_program("inspect", self.cornell, "--height", 32, "--pixel", "16,20",
                         "--top-lights",
                         2, "-o", "p.png", "--seed", 4, "--spp", 1, "--light-samples", 2, "--json",
                         "i.json")
        facts = json.loads((self.folder / "i.json").read_text())
        self.assertEqual((len(facts["ranked"]), facts["seed"], facts["spp"]), (2, 4, 1))
        self.assertIn("p.png", self.files())

    def test_inspect_names_what_it_finds(self):
        self.write_lamp()
        run = self.run_program("inspect", "lamp.gltf", "--height", 32, "--pixel", "28,17")
        self.assertIn("point light 'lamp'", run.stdout)
        self.assertIn("at (0.00, 1.00, 0.00)", run.stdout)
        self.assertIn("material 'paint'", run.stdout)

    def test_inspect_speaks_of_places_in_the_file(self):
        self.write_lamp()
        scene = json.loads((self.folder / "lamp.gltf").read_text())
        arguments = ["inspect", "lamp.gltf", "--height", 32, "--pixel", "28,17", "--json", "i.json"]
        self.run_program(*arguments)
        near = json.loads((self.folder / "i.json").read_text())
        scene["nodes"].append({"translation": [1e6, 0, -5e5], "children": [0, 1]})
        scene["scenes"][0]["nodes"] = [2]
        (self.folder / "lamp.gltf").write_text(json.dumps(scene))
        run = self.run_program(*arguments)
        far = json.loads((self.folder / "i.json").read_text())
        self.assertIn("at (1000000.00, 1.00, -500000.00)", run.stdout)
        self.assertEqual(far["ranked"][0]["position"], [1e6, 1, -5e5])
        for before, after, moved in zip(near["surface"]["position"], far["surface"]["position"],
                                        [1e6, 0, -5e5]):
            self.assertAlmostEqual(after, before + moved, 5)
        self.assertEqual(far["luminance"], near["luminance"])

    def test_inspect_where_nothing_is_to_be_seen(self):
        self.write_lamp()
        run = self.run_program("inspect", "lamp.gltf", "--height", 32, "--pixel", "0,0", "--json",
                               "i.json")
        self.assertIn("sees nothing", run.stdout)
        facts = json.loads((self.folder / "i.json").read_text())
        self.assertFalse(facts["hit"])
        self.assertIn("lamp-pixel.png", self.files())
        self.write_lamp(lights=False)
        run = self.run_program("inspect", "lamp.gltf", "--height", 32, "--pixel", "28,16",
                               "--headlight", "never")
        self.assertIn("no lights", run.stdout)
        run = self.run_program("inspect", "lamp.gltf", "--height", 32, "--pixel", "28,16")
        self.assertIn("point light 'headlight'", run.stdout)

    def test_inspect_refuses(self):
        scene = self.folder / "x.png"  # a scene by another name
        scene.write_bytes(pathlib.Path(self.cornell).read_bytes())
        pixel = ["--pixel", "3,4"]
        for arguments, words in (
                ([], ["--pixel"]),
                (["--pixel", "3"], ["--pixel", "3", "320,200"]),
                (["--pixel", "3;4"], ["--pixel", "3;4"]),
                (["--pixel", "3,4,5"], ["--pixel", "3,4,5"]),
                (["--pixel", "a,b"], ["--pixel", "a,b"]),
                (["--pixel=-3,4"], ["--pixel", "-3,4"]),
                (["--pixel", "3,1.5"], ["--pixel", "3,1.5"]),
                (["--pixel", "8,4", "--height", 8], ["x.png", "--pixel", "8,4", "8 x 8"]),
                (["--pixel", "4,8", "--height", 8], ["x.png", "--pixel", "4,8", "8 x 8"]),
                ([*pixel, "--top-lights", 0], ["--top-lights", "0"]),
                ([*pixel, "-o", "a.exr"], ["--output", "a.exr", ".png"]),
                ([*pixel, "-o", "no/a.png"], ["--output", "no/a.png", "folder"]),
                ([*pixel, "--json", "no/a.json"], ["--json", "no/a.json", "folder"]),
                ([*pixel, "-o", "a.png", "--json", "a.png"], ["--json", "a.png", "--output"]),
                ([*pixel, "-o", "x.png"], ["--output", "x.png", "scene"]),
                ([*pixel, "--json", "x.png"], ["--json", "x.png", "scene"]),
                ([*pixel, "--memory", "130M"], ["--memory", "130.0 MiB", "512 x 512", "at once"]),
                ([*pixel, "--camera", "top"], ["--camera", "top"])):
            with self.subTest(arguments=arguments):
                self.refuse("inspect", "x.png", *arguments, words=words)
                self.assertEqual(self.files(), ["x.png"])
        self.refuse("inspect", "none.glb", *pixel, words=["none.glb"])

    # The other commands.

    def test_scene(self):
        self.run_program("scene", "pinhole", "-o", "p.glb")
        (self.folder / "p.glb").unlink()
        kept = sorted(path.stem for path in SCENES.glob("*.glb"))
        self.assertEqual(kept, ["blinds", "cornell", "glossy", "pinhole"])
        for name in kept:
            self.run_program("scene", name, "-o", "p.glb")
            self.assertEqual((self.folder / "p.glb").read_bytes(),
                             (SCENES / f"{name}.glb").read_bytes(), name)
        self.run_program("scene", "city", "--lights", 50, "-o", "c.glb")
        for arguments in (["cornell", "--lights", 5], ["blinds", "--slats", 2],
                          ["blinds", "--slats", 4.5], ["near", "--distance", "nan"]):
            self.refuse("scene", *arguments, "-o", "v.glb", words=[arguments[0], arguments[1]])
        self.refuse("scene", "-o", "v.glb", words=["name"])
        self.refuse("scene", "village", "-o", "v.glb", words=["village", "cornell"])
        self.refuse("scene", "cornell", "-o", "c.gltf", words=["c.gltf", ".glb"])
        self.refuse("scene", "cornell", "-o", "no/c.glb", words=["no/c.glb"])
        self.refuse("scene", "dragon", "--mesh", "none.glb", "-o", "d.glb", words=["none.glb"])
        self.assertEqual(self.files(), ["c.glb", "p.glb"])

    def test_scene_list(self):
        scenes = json.loads(self.run_program("scene", "--list").stdout)
        page = (pathlib.Path(__file__).parent.parent / "docs" / "scenes.md").read_text()
        text = self.run_program("scene", "--help").stdout
        for scene in scenes:
            self.assertIn(f"| `{scene['name']}` |", page)
            for parameter in scene["parameters"]:
                values = ", ".join(f"{value:.6g}" for value in parameter["sweep"])
                self.assertIn(f"| `{scene['name']} --{parameter['name']}` | {values} ", page)
                self.assertIn(f"--{parameter['name']} ", text)

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

    def test_verify(self):
        run = self.run_program("verify", SCENES / "pinhole.glb", "--width", 40)
        for stage in ("layout", "random", "gbuffer", "clusters", "representatives", "contributions",
                      "refinement", "pdf", "samples", "accumulate"):
            self.assertIn(stage, run.stdout)
        self.assertIn("driver ", run.stdout.splitlines()[0])
        self.assertIn("No error was found in what this scene tests. Not tested:", run.stdout)
        self.assertIn("stage reflections", run.stdout)
        self.assertNotIn("computes correctly", run.stdout)
        self.assertNotIn("FAIL", run.stdout)

    def test_verify_everything(self):
        run = self.run_program("verify", "--width", 40, "--json", "verify.json")
        self.assertIn("driver ", run.stdout.splitlines()[0])
        self.assertEqual(run.stdout.splitlines()[-1], "The device computes correctly.")
        found = json.loads((self.folder / "verify.json").read_text())
        for name in ("device", "platform", "opencl", "driver", "version"):
            self.assertTrue(found[name], name)
        self.assertEqual((found["verdict"], found["not_tested"]), ("correct", []))
        check = found["scenes"][0]["checks"][0]
        for name in ("stage", "items", "telling", "failed", "borderline", "largest", "tolerance"):
            self.assertIn(name, check)
        self.assertEqual(check["verdict"], "pass")
        kernels = SCENES.parent / "kernels"
        expected = set()
        for path in kernels.rglob("*.cl"):
            text = path.read_text()
            if '#include "lib/samples.h"' in text:
                text += (kernels / "lib" / "samples.h").read_text()
            file = path.relative_to(kernels).as_posix()
            expected |= {(file, name) for name in re.findall(r"^KERNEL void (\w+)", text, re.M)}
        self.assertEqual({(k["file"], k["kernel"]) for k in found["kernels"]}, expected)
        states = {k["kernel"]: k["state"] for k in found["kernels"]}
        self.assertEqual(states["adaptive_draw"], "tested")
        self.assertEqual(states["gbuffer_trace_rays"], "tested")
        self.assertNotIn("not tested", states.values())

    def test_verify_json(self):
        run = self.run_program("verify", SCENES / "pinhole.glb", "--width", 24, "--json", "-")
        found = json.loads(run.stdout)
        self.assertEqual(found["verdict"], "incomplete")
        self.assertIn("stage reflections", found["not_tested"])
        self.refuse("verify", "--camera", "front", words=["--camera", "file"])
        self.refuse("verify", "--json", "none/a.json", words=["--json", "none"])
        self.refuse("verify", "", words=["name is empty"])

    def test_bench(self):
        run = self.run_program("bench", SCENES / "pinhole.glb", "--height", 48, "--rounds", 2,
                               "--json", "b.json")
        self.assertIn("shadow_incoherent", run.stdout)
        figures = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(sorted(figures["rays"]),
                         ["primary", "shadow_coherent", "shadow_incoherent"])
        self.assertGreater(figures["rays"]["primary"]["packets"]["mrays_per_s"], 0)
        self.assertGreater(figures["stages"]["shadows"]["seconds"], 0)
        if "embree" in figures:
            ratio = figures["ratios"]["shadow_incoherent"]
            low, high = ratio["over_single_quartiles"]
            self.assertTrue(low <= ratio["over_single"] <= high)
            self.assertGreater(ratio["over_best"], 0)
        run = self.run_program("bench", SCENES / "pinhole.glb", "--loading", "--json", "b.json")
        self.assertIn("tinygltf alone", run.stdout)
        loading = json.loads((self.folder / "b.json").read_text())["loading"]
        self.assertGreater(loading["load_s"], 0)
        self.assertGreater(loading["ratio"], 0)
        self.assertGreater(loading["peak_over_file"], 1)
        self.refuse("bench", "traversal", "--loading", words=["--loading", "traversal"])
        self.refuse("bench", "none.glb", words=["none.glb"])
        self.refuse("bench", SCENES / "pinhole.glb", "--mesh", "x.glb", words=["--mesh", "x.glb"])
        self.refuse("bench", SCENES / "pinhole.glb", "--view", "far", words=["--view", "far"])
        self.refuse("bench", "stages", "--camera", "far", words=["--camera", "far"])
        copy = self.folder / "copy.glb"
        copy.write_bytes((SCENES / "pinhole.glb").read_bytes())
        self.refuse("bench", copy, "--json", copy, words=["--json", "copy.glb"])
        self.refuse("bench", "traversal", "--view", "above", words=["--view", "above"])
        self.refuse("bench", "traversal", "--json", "no/x.json", words=["--json", "no/x.json"])
        self.assertEqual(self.files(), ["b.json", "copy.glb"])

    def test_devices(self):
        run = self.run_program("devices")
        self.assertIn("0: ", run.stdout)
        self.assertIn("(default)", run.stdout)

    def test_compare(self):
        for name, spp in (("a.exr", 1), ("b.exr", 2)):
            self.run_program("render", self.cornell, "--height", 16, "--spp", spp, "-o", name, "-q")
        self.assertIn("relMSE", self.run_program("compare", "a.exr", "b.exr").stdout)
        self.run_program("render", self.cornell, "--height", 8, "-o", "c.exr", "-q")
        self.refuse("compare", "a.exr", "c.exr", words=["a.exr", "16", "c.exr", "8"])
        self.refuse("compare", "a.exr", "none.exr", words=["none.exr"])

    def test_compare_with_a_reference(self):
        for name, spp in (("a.exr", 4), ("b.exr", 1), ("r.exr", 64)):
            self.run_program("render", self.cornell, "--height", 16, "--spp", spp, "--pixel-centre",
                             "-o", name, "-q")
        run = self.run_program("compare", "a.exr", "b.exr", "--ref", "r.exr", "-o", "e.png")
        for words in ("a.exr: relMSE", "b.exr: relMSE", "b.exr over a.exr", "MAPE", "worst 0.1%",
                      "wrote e.png"):
            self.assertIn(words, run.stdout)
        both = json.loads(self.run_program("compare", "a.exr", "b.exr", "--ref", "r.exr",
                                           "--json").stdout)["images"]
        for name, of_both in zip(("a.exr", "b.exr"), both):
            alone = json.loads(self.run_program("compare", name, "r.exr", "--json").stdout)
            self.assertEqual(of_both, {"file": name, **alone})
        self.assertLess(both[0]["relmse"], both[1]["relmse"])
        self.assertEqual((self.folder / "e.png").read_bytes()[:4], b"\x89PNG")

    def test_compare_many(self):
        for name, spp in (("a.exr", 4), ("b.exr", 1), ("c.exr", 2), ("r.exr", 16)):
            self.run_program("render", self.cornell, "--height", 8, "--spp", spp, "-o", name, "-q")
        run = self.run_program("compare", "a.exr", "b.exr", "c.exr", "r.exr", "-o", "e.png")
        self.assertEqual([line.split(":")[0] for line in run.stdout.splitlines()],
                         ["a.exr", "b.exr", "c.exr", "b.exr over a.exr", "c.exr over a.exr",
                          "wrote e.png"])
        self.assertEqual(run.stdout.replace("wrote e.png\n", ""),
                         self.run_program("compare", "a.exr", "b.exr", "c.exr", "--ref",
                                          "r.exr").stdout)
        images = json.loads(self.run_program("compare", "a.exr", "b.exr", "c.exr", "r.exr",
                                             "--json").stdout)["images"]
        self.assertEqual([i["file"] for i in images], ["a.exr", "b.exr", "c.exr"])

    def test_compare_of_what_is_exposed_differently(self):
        for exposure in (1, 2):
            self.run_program("render", self.cornell, "--height", 8, "-o", "a.exr", "-o",
                             f"{exposure}.png", "--exposure", exposure, "-q")
        self.run_program("render", self.cornell, "--height", 8, "-o", "auto.png", "-q")
        for a, b, words in (("a.exr", "auto.png", ["a.exr is not exposed, auto.png exposed by "]),
                            ("1.png", "2.png", ["1.png is exposed by 1 stops, 2.png exposed by 2"]),
                            ("a.exr", "a.exr", []), ("1.png", "1.png", [])):
            run = self.run_program("compare", a, b)
            self.assertEqual(len(run.stderr.splitlines()), len(words), run.stderr)
            for word in words:
                self.assertIn("warning: " + word, run.stderr)

    def test_compare_refuses(self):
        self.run_program("render", self.cornell, "--height", 8, "-o", "a.exr", "-q")
        self.oiio("a.exr", "--ch", "R,G", "-o", "two.exr")
        self.oiio("a.exr", "--mulc", "0", "-o", "black.exr")
        self.oiio("a.exr", "--fill:color=nan,1,1", "1x1+3+2", "-o", "nan.exr")
        (self.folder / "text.exr").write_text("no image")
        for arguments, words in (
                (["two.exr", "a.exr"], ["two.exr", "channel B", "R, G"]),
                (["a.exr", "two.exr"], ["two.exr", "channel B"]),
                (["a.exr", "black.exr"], ["black.exr", "luminance"]),
                (["a.exr", "nan.exr"], ["nan.exr", "pixel 3, 2, channel R", "nan"]),
                (["text.exr", "a.exr"], ["text.exr", "cannot be read"]),
                ([self.folder, "a.exr"], [self.folder.name, "cannot be read"]),
                (["a.exr", "a.exr", "-o", "a.exr"], ["--output", "a.exr", ".png"]),
                (["a.exr", "a.exr", "-o", "no/e.png"], ["--output", "no/e.png", "folder"]),
                (["a.exr", "a.exr", "--ref", "none.exr"], ["none.exr"])):
            with self.subTest(arguments=arguments):
                self.refuse("compare", *arguments, words=words)
        run = self.run_program("compare", "nan.exr", "a.exr", code=3)
        self.assertIn("nan.exr: 1 of its values", run.stderr)
        self.assertIn("pixel 3, 2, channel R", run.stderr)
        self.assertIn("relMSE", run.stdout)
        self.assertNotIn("nan", run.stdout)

    # chart.

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
                                "exhaustive,uniform", "--baseline", "uniform", "--light-samples",
                                60000,
                                "--spp", 1)
        self.assertEqual([s["sampler"] for s in chart["settings"]], ["exhaustive"])
        self.assertIn("warning: --baseline uniform", run.stderr)
        self.assertEqual(chart["baseline"], "exhaustive")

    def test_checkpoints(self):
        arguments = ["render", self.cornell, "--height", "32", "-q", "-o", "image.exr"]
        saved = [*arguments, "--checkpoint", "state", "--spp", "4"]
        self.refuse(*arguments, "--checkpoint", "state", "--time", 1, words=["state", "--time"])
        self.refuse(*arguments, "--checkpoint", "image.exr", words=["image.exr", "--output"])
        self.run_program(*saved)
        self.assertEqual(self.files(), ["image.exr", "state"])
        before = (self.folder / "state").read_bytes()
        self.refuse(*saved, words=["state", "is there already", "--resume"])
        for other in (["--seed", 2], ["--device-form", "gpu"], ["--hide-emitters"]):
            self.refuse(*saved, "--resume", *other, words=["state", "another render"])
        (self.folder / "state").write_bytes(before[:-100] + before[-99:])
        self.refuse(*saved, "--resume", words=["state", "damaged"])
        (self.folder / "state").write_bytes(before[:-20] + bytes([before[-20] ^ 1]) + before[-19:])
        self.refuse(*saved, "--resume", words=["state", "damaged"])
        (self.folder / "state").write_bytes(b"something else")
        self.refuse(*saved, "--resume", words=["state", "no checkpoint"])
        # More pixel samples on top of those that are there.
        (self.folder / "state").write_bytes(before)
        more = [*arguments, "--spp", "12"]
        self.run_program(*more, "--checkpoint", "state", "--resume", "-o", "more.exr")
        self.run_program(*more, "-o", "whole.exr")
        run = self.run_program("compare", "more.exr", "whole.exr", "--json")
        self.assertEqual(json.loads(run.stdout)["rmse"], 0)
        self.assertNotEqual((self.folder / "state").read_bytes(), before)
        # A stop by the error saves at the end, and rays count from the start.
        early = [*arguments, "--target-error", "1", "--spp", "64", "--sampler", "contribution",
                 "--checkpoint", "early", "--stats", "early.json"]
        self.run_program(*early)
        self.assertIn("early", self.files())
        rays = json.loads((self.folder / "early.json").read_text())["rays"]
        self.run_program(*early, "--resume")
        again = json.loads((self.folder / "early.json").read_text())
        self.assertEqual(again["rays"], rays)
        self.assertEqual(again["spp"], 16)  # 16,384 pixel samples in all

    def test_a_checkpoint_becomes_an_image_at_any_time(self):
        arguments = ["render", self.cornell, "--height", "40", "-q", "-o", "image.exr"]
        several = ["--memory", "12M"]  # batches
        self.run_program(*arguments[:-1], "whole.exr", "--spp", 16)
        for more in ([], several):
            run = self.start(*arguments, *more, "--spp", 4000, "--checkpoint", "state",
                             "--checkpoint-every", 0)
            self.wait_for("state")
            run.kill()
            run.wait()
            before = (self.folder / "state").read_bytes()
            for spp in (1, 2):
                self.run_program(*arguments, *more, "--spp", spp, "--checkpoint", "state",
                                 "--resume", "--stats", "s.json")
                stats = json.loads((self.folder / "s.json").read_text())
                self.assertGreaterEqual(stats["spp"], spp)
                self.assertEqual(stats["batches"] > 1, bool(more))
                found = json.loads(self.run_program("compare", "image.exr", "whole.exr",
                                                    "--json").stdout)
                self.assertLess(found["rmse"], 1)  # no part of it is missing
            if more:  # no pixel is without a sample, and the state is what it was
                self.assertEqual((self.folder / "state").read_bytes(), before)
                self.refuse(*arguments, *more, "--spp", 5000, "--checkpoint", "state", "--resume",
                            words=["--spp 5000", "batches", "4000"])
            (self.folder / "state").unlink()

    def start(self, *arguments, **options):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, text=True,
                                **options)

    def wait_for(self, name):
        end = time.monotonic() + 120
        while not (self.folder / name).exists():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def test_lines_come_as_they_are_said(self):
        run = self.start("render", self.cornell, "--height", 64, "--spp", 1000000, "-o", "a.exr",
                         stdout=subprocess.PIPE)
        try:
            ready, _, _ = select.select([run.stdout], [], [], 60)
            self.assertTrue(ready)
            self.assertIn("sampler ", run.stdout.readline())
        finally:
            run.kill()
            run.communicate()

    def test_an_interrupt_writes_the_image_so_far(self):
        for number, name in ((signal.SIGINT, "SIGINT"), (signal.SIGTERM, "SIGTERM")):
            with self.subTest(name):
                run = self.start("render", self.cornell, "--height", 64, "--spp", 1000000, "-o",
                                 "a.exr", "--checkpoint", "state", "--checkpoint-every", 0,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.wait_for("state")
                run.send_signal(number)
                said, errors = run.communicate(timeout=60)
                self.assertEqual(run.returncode, -number, errors)  # which a shell tells as 128 + n
                spp = int(self.facts("a.exr")["spp"])
                self.assertGreater(spp, 0)
                self.assertIn(f"warning: interrupted at {spp} of 1000000 spp", errors)
                self.assertIn("wrote a.exr", said)
                self.assertEqual(self.facts("a.exr")["cut_short"], "true")
                self.assertEqual(self.files(), ["a.exr", "state"])
                # The state is of the same samples: the image is one of that many.
                self.run_program("render", self.cornell, "--height", 64, "--spp", spp, "-o",
                                 "b.exr", "-q")
                self.assertEqual(self.rmse("a.exr", "b.exr"), 0)
                self.run_program("render", self.cornell, "--height", 64, "--spp", 1, "-o", "b.exr",
                                 "-q", "--checkpoint", "state", "--resume")
                self.assertEqual(self.rmse("a.exr", "b.exr"), 0)
                for file in self.files():
                    (self.folder / file).unlink()

    def test_a_second_interrupt_ends_at_once(self):
        (self.folder / "a.exr").write_text("precious")
        # Pixel samples of seconds, which are finished where there is a checkpoint.
        run = self.start("render", self.cornell, "--height", 256, "--sampler", "exhaustive",
                         "--emitter-points", 512, "--spp", 1000, "-o", "a.exr", "--checkpoint",
                         "state", "--checkpoint-every", 0, stdout=subprocess.PIPE)
        self.wait_for("state")
        run.send_signal(signal.SIGINT)
        time.sleep(0.1)  # two at once are one
        self.assertIsNone(run.poll())
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=20)
        self.assertEqual(run.returncode, -signal.SIGINT)
        self.assertEqual(self.files(), ["a.exr", "state"])
        self.assertEqual((self.folder / "a.exr").read_text(), "precious")

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

    def test_help(self):
        self.assertIn("render", self.run_program("--help").stdout)
        for command in ("render", "inspect", "verify", "scene", "chart", "compare"):
            text = self.run_program(command, "--help").stdout
            self.assertIn("Example", text)
        self.assertIn("0.1", self.run_program("--version").stdout)


if __name__ == "__main__":
    unittest.main()
