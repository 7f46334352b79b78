# SPDX-License-Identifier: MIT
"""What render refuses: options, and files to write.

usage: commands_refusals.py MANYLIGHT SCENES [TEST ...]
"""
import json
import pathlib
import subprocess
import unittest

from program import CommandTest, PROGRAM


class RefusalTest(CommandTest):
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


if __name__ == "__main__":
    unittest.main()
