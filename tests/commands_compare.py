# SPDX-License-Identifier: MIT
"""compare.

usage: commands_compare.py MANYLIGHT SCENES [TEST ...]
"""
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from program import PROGRAM, SCENES, CommandTest


class CompareTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        """Renders images of 16 x 16 pixels, of more and more samples, for all tests."""
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.images = pathlib.Path(folder.name)
        for name, spp in (("b.exr", 1), ("c.exr", 2), ("a.exr", 4), ("r.exr", 64)):
            subprocess.run([PROGRAM, "render", SCENES / "cornell.glb", "--height", "16", "--spp",
                            str(spp), "--pixel-centre", "-o", cls.images / name, "-q"], check=True,
                           timeout=600)

    def setUp(self):
        super().setUp()
        for image in self.images.iterdir():
            shutil.copy(image, self.folder)

    def test_compare(self):
        self.assertIn("relMSE", self.run_program("compare", "a.exr", "b.exr").stdout)
        self.oiio("a.exr", "--cut", "8x8", "-o", "c.exr")
        self.refuse("compare", "a.exr", "c.exr", words=["a.exr", "16", "c.exr", "8"])
        self.refuse("compare", "a.exr", "none.exr", words=["none.exr"])

    def test_compare_with_a_reference(self):
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


if __name__ == "__main__":
    unittest.main()
