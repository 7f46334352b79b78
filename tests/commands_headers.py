# SPDX-License-Identifier: MIT
"""What images' headers tell, and renders that are repeated by them.

usage: commands_headers.py MANYLIGHT SCENES [TEST ...]
"""
import base64
import json
import re
import struct
import subprocess
import unittest

from program import CommandTest


class HeaderTest(CommandTest):
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

    # What an image does not depend on, or not by itself.
    NOT_OF_THE_IMAGE = {"help", "output", "time", "threads", "cluster-map", "top-lights", "stats",
                        "checkpoint", "checkpoint-every", "resume", "quiet", "like",
                        "set"}  # where the sampler has parameters

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
        of_exr, told, of_other = self.headers("a.exr", "a.png", "b.exr")
        self.assertEqual({k: v for k, v in of_exr.items() if k not in ("pixels", "seconds")},
                         {k: v for k, v in told.items()
                          if k not in ("exposure", "pixels", "seconds")})
        self.assertEqual(of_other["aov"], "error")
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
            told = self.headers("a.exr", "a.png", "b.exr", "b.png")
            for of_image in told:
                del of_image["seconds"]
            self.assertEqual(told[2:], told[:2])
        # The command line counts, flags as well, and a picture's exposure is one that may be asked.
        self.run_program("render", "--like", "a.png", "--lamp-scale", 0.2, "--hide-emitters",
                         "--spp", 2, "-o", "b.exr", "-o", "b.png", "-q")
        told, before = self.headers("b.png", "a.png")
        self.assertEqual((told["lamp_scale"], told["hide_emitters"], told["spp"], told["seed"],
                          told["exposure"]), ("0.2", "true", "2", "5", before["exposure"]))
        self.assertNotEqual(told["pixels"], before["pixels"])
        # A stop by the error, its layer, for which a picture has no place, and clusters.
        for more in (["--target-error", "0.02"], ["--aov", "error"],
                     ["--sampler", "contribution", "--max-depth", "1"]):
            self.run_program("render", self.cornell, "--height", 16, "-q", "-o", "c.exr", *more)
            self.run_program("render", "--like", "c.exr", "-o", "d.exr", "-q")
            before, after = self.headers("c.exr", "d.exr")
            self.assertEqual(after["pixels"], before["pixels"], more)
        self.run_program("render", "--like", "c.exr", "--aov", "error", "-o", "d.exr", "-q")
        self.run_program("render", "--like", "d.exr", "-o", "d.png", "-q")

    def test_parameters_of_samplers_are_repeated(self):
        for row in json.loads(self.run_program("samplers", "--json").stdout):
            self.refuse("render", self.cornell, "--sampler", row["name"], "--set", "foo=1",
                        words=["--set foo=1", row["name"], "no such parameter"])
            if not row["parameters"]:
                continue
            p = row["parameters"][0]
            value = p["most"] if p["value"] != p["most"] else p["least"]
            self.refuse("render", self.cornell, "--sampler", row["name"], "--set",
                        f"{p['name']}={p['most'] + 1}", words=[p["name"], f"to {p['most']:g}"])
            shape = ("--height", 16, "--spp", 1, "--emitter-points", 0)
            self.run_program("render", self.cornell, "--sampler", row["name"], *shape, "--set",
                             f"{p['name']}={value}", "-o", "a.exr", "-q")
            self.run_program("render", "--like", "a.exr", "-o", "b.exr", "-q")
            before, after = self.headers("a.exr", "b.exr")
            self.assertEqual(after["pixels"], before["pixels"])
            self.assertEqual(after["set"], before["set"])
            self.assertIn(f"{p['name']}={value:g}", after["set"])
            # What the command line names goes before; the others, and the same sampler, stay.
            other = row["parameters"][-1]
            self.run_program("render", "--like", "a.exr", "--sampler", row["name"], "--set",
                             f"{other['name']}={other['least']}", "-o", "b.exr", "-q")
            told = self.headers("b.exr")[0]["set"]
            self.assertIn(f"{other['name']}={other['least']:g}", told)
            if other is not p:
                self.assertIn(f"{p['name']}={value:g}", told)
            self.run_program("render", "--like", "a.exr", "--sampler", "uniform", "-o", "b.exr",
                             "-q")
            self.assertNotIn("set", self.headers("b.exr")[0])

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


if __name__ == "__main__":
    unittest.main()
