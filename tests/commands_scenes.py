# SPDX-License-Identifier: MIT
"""What is made of scene files, and those that the program writes.

usage: commands_scenes.py MANYLIGHT SCENES [TEST ...]
"""
import json
import pathlib
import re
import subprocess
import unittest

from program import CommandTest, SCENES


class SceneTest(CommandTest):
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

    def test_scene(self):
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


if __name__ == "__main__":
    unittest.main()
