# SPDX-License-Identifier: MIT
"""Renders that end early: checkpoints, interrupts and kills.

usage: commands_breaks.py MANYLIGHT SCENES [TEST ...]
"""
import json
import select
import signal
import subprocess
import time
import unittest

from program import PROGRAM, CommandTest


class BreakTest(CommandTest):
    def start(self, *arguments, **options):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, text=True,
                                **options)

    def wait_for(self, name):
        end = time.monotonic() + 120
        while not (self.folder / name).exists():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

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
                (told,) = self.headers("a.exr")
                spp = int(told["spp"])
                self.assertGreater(spp, 0)
                self.assertIn(f"warning: interrupted at {spp} of 1000000 spp", errors)
                self.assertIn("wrote a.exr", said)
                self.assertEqual(told["cut_short"], "true")
                self.assertEqual(self.files(), ["a.exr", "state"])
                # The state is of the same samples: the image is one of that many.
                self.run_program("render", self.cornell, "--height", 64, "--spp", spp, "-o",
                                 "b.exr", "-q")
                self.run_program("render", self.cornell, "--height", 64, "--spp", 1, "-o", "c.exr",
                                 "-q", "--checkpoint", "state", "--resume")
                self.assertEqual({header["pixels"] for header in self.headers("b.exr", "c.exr")},
                                 {told["pixels"]})
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


if __name__ == "__main__":
    unittest.main()
