# SPDX-License-Identifier: MIT
"""inspect.

usage: commands_inspect.py MANYLIGHT SCENES [TEST ...]
"""
import json
import pathlib
import unittest

from program import CommandTest


class InspectTest(CommandTest):
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


if __name__ == "__main__":
    unittest.main()
