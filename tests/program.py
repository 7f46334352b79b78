# SPDX-License-Identifier: MIT
"""Runs whole commands as a user would: files made, messages, exit codes. For commands_*.py."""
import base64
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
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

    def headers(self, *images):
        """[image] the program's facts in its header, by name, and what says whether all values of
        two are the same, as 'pixels'."""
        text = subprocess.run(["oiiotool", "--info", "-v", "--hash", *images], cwd=self.folder,
                              capture_output=True, text=True, check=True).stdout
        found = [{name: value.strip('"') for name, value in
                  re.findall(r"^ *manylight:(\w+): (.*)$", part, re.M)} |
                 {"pixels": re.search(r"SHA-1: (\w+)", part).group(1)}
                 for part in text.split("Reading ")[1:]]
        self.assertEqual(len(found), len(images))
        return found
