# SPDX-License-Identifier: MIT
"""What is said: help, names of files, and a standard output that takes nothing.

usage: commands_messages.py MANYLIGHT SCENES [TEST ...]
"""
import json
import subprocess
import unittest

from program import CommandTest, PROGRAM


class MessageTest(CommandTest):
    def test_help(self):
        text = self.run_program("--help").stdout
        self.assertIn("render", text)
        self.assertEqual(self.run_program("help").stdout, text)
        of = {command: self.run_program(command, "--help").stdout
              for command in ("render", "inspect", "verify", "scene", "chart", "compare")}
        for text in of.values():
            self.assertIn("Example", text)
        self.assertEqual(self.run_program("help", "render").stdout, of["render"])
        self.assertIn("0.1", self.run_program("--version").stdout)

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


if __name__ == "__main__":
    unittest.main()
