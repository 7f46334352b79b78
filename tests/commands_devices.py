# SPDX-License-Identifier: MIT
"""verify, bench and devices.

usage: commands_devices.py MANYLIGHT SCENES [TEST ...]
"""
import json
import os
import re
import subprocess
import unittest

from program import CommandTest, PROGRAM, SCENES


class DeviceTest(CommandTest):
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
            for header in re.findall(r'#include "(lib/(?:samples|reflected)\.h)"', text):
                text += (kernels / header).read_text()
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

    def test_verify_selection(self):
        run = self.run_program("verify", "--width", 24, "--scene", "mirrors", "--stage",
                               "contributions,pdf", "--stage", "random", "--sampler", "power")
        self.assertEqual(re.findall(r"^(\S.*?) +\d+ +\d+ +\S+  pass", run.stdout, re.M),
                         ["random", "contributions", "pdf (power)"])
        self.assertIn("No error was found in what was selected. Not tested:\n"
                      "  all that is not selected by --scene mirrors "
                      "--stage contributions,pdf,random --sampler power", run.stdout)
        run = self.run_program("verify", SCENES / "pinhole.glb", "--width", 24, "--stage",
                               "reflections", "--json", "-")
        found = json.loads(run.stdout)
        self.assertEqual({c["stage"].partition(" (")[0] for c in found["scenes"][0]["checks"]},
                         {"reflections"})
        self.assertEqual(found["verdict"], "incomplete")
        self.assertEqual(found["not_tested"][0], "stage reflections")
        self.assertIn("stage reflections (lighttree)", found["not_tested"])
        self.assertEqual(found["not_tested"][-1],
                         "all that is not selected by --stage reflections")
        for arguments, words in (
                (["--stage", "gbufer"], "--stage: gbufer is not layout, random, gbuffer,"),
                (["--stage", "gbufer"], "or reflections; did you mean gbuffer?"),
                (["--scene", "mirror"], "or veil; did you mean mirrors?"),
                (["--scene", "mirrors", SCENES / "pinhole.glb"],
                 "--scene mirrors: goes without a file"),
                (["--sampler", "rys"], "--sampler rys: no such sampler (there are: exhaustive"),
                (["--sampler", "ris", "--stage", "pdf"],
                 "--sampler ris: its stages are samples, of which --stage names none")):
            with self.subTest(arguments=arguments):
                self.refuse("verify", *arguments, words=[words])

    def test_bench(self):
        run = self.run_program("bench", SCENES / "pinhole.glb", "--height", 48, "--rounds", 1,
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

    def test_samplers(self):
        lines = [line for line in self.run_program("samplers").stdout.splitlines()
                 if not line.startswith(" ")]  # without the rows' parameters
        rows = json.loads(self.run_program("samplers", "--json").stdout)
        self.assertEqual([line.split()[0] for line in lines], [row["name"] for row in rows])
        biased = {row["name"]: row["biased"] for row in rows}
        self.assertTrue(biased["contribution"])
        self.assertFalse(biased["adaptive"])
        self.assertEqual(len({row["color"] for row in rows}), len(rows))
        for row, line in zip(rows, lines):
            self.assertRegex(row["color"], "^#[0-9a-f]{6}$")
            self.assertIn(row["summary"], line)
        self.refuse("render", self.cornell, "--sampler", "best",
                    words=["--sampler best", *(row["name"] for row in rows)])

    def test_an_empty_cache_folder_is_none(self):
        run = subprocess.run([PROGRAM, "devices"], capture_output=True, text=True,
                             env={**os.environ, "POCL_CACHE_DIR": ""})
        self.assertEqual(run.returncode, 0, run.stderr)


if __name__ == "__main__":
    unittest.main()
