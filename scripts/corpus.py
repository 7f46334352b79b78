# SPDX-License-Identifier: MIT
"""Renders every glTF file below a folder, small, and tells what goes wrong; see corpus.sh."""
import argparse
import collections
import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile

import OpenImageIO

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("program", type=pathlib.Path)
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--only", default="", help="files whose paths contain this")
options = arguments.parse_args()
image = pathlib.Path(tempfile.mkdtemp()) / "image.exr"
most_seconds = 120

# What a path contains, what its refusal says, and why that is right.
EXPECTED = [
    ("assimp/models/glTF/", "gltf-pipeline", "glTF 1.0"),
    ("BoxTextured-glTF-techniqueWebGL/", "KHR_technique_webgl", "its materials are glTF 1.0's"),
    ("BoxWithInfinites.glb", "is not finite", "broken on purpose: infinite positions"),
    ("glTF2/IncorrectVertexArrays/", "beyond buffer 0",
     "broken on purpose: a view beyond its buffer"),
    ("glTF2/IndexOutOfRange/", "24 vertices", "broken on purpose: indices beyond the vertices"),
    ("RecursiveNodes.gltf", "its own ancestor", "broken on purpose: a node within itself"),
    ("sceneWrongType.gltf", "no such file", "broken on purpose: a buffer that there is not"),
    ("NoScene.gltf", "no scene 0", "broken on purpose: a scene that there is not"),
    ("wrongTypes/badArray.gltf", "is not an array", "broken on purpose: a wrong type"),
    ("wrongTypes/badExtension.gltf", "is not an object", "broken on purpose: a wrong type"),
    ("wrongTypes/badNumber.gltf", "'index' is missing", "broken on purpose: a wrong type"),
    ("wrongTypes/badObject.gltf", "is not an object", "broken on purpose: a wrong type"),
    ("wrongTypes/badUint.gltf", "-1 is not an integer", "broken on purpose: a wrong type"),
    ("CubeScaledInstances/glTF/cube_att.gltf", "already a child", "a node with two parents"),
    ("models/BoundsChecking/integer-", "1e+300", "broken on purpose: a number beyond all bounds"),
    ("models/BoundsChecking/invalid-", "there is no buffer", "broken on purpose: no such buffer"),
]


def files():
    """Each once, however many packages ship it."""
    seen = set()
    for path in sorted(options.folder.rglob("*")):
        if path.suffix.lower() not in (".gltf", ".glb") or not path.is_file():
            continue
        data = path.read_bytes()
        digest = hashlib.sha256(data).digest()
        if digest not in seen and options.only in str(path):
            seen.add(digest)
            yield path, data


def expected(path, message):
    return next((why for part, words, why in EXPECTED
                 if part in str(path) and words in message), None)


def is_black():
    # An ImageBuf would be the cached one of a render in the same second.
    return OpenImageIO.ImageInput.open(str(image)).read_image()[..., :3].max() == 0


def outcome(path):
    """What became of it, rendered or a word for what is wrong, and words."""
    image.unlink(missing_ok=True)
    try:
        done = subprocess.run(
            [options.program.resolve(), "render", path, "-o", image, "--height", "24", "--spp", "1",
             "-q"], capture_output=True, text=True, errors="replace", timeout=most_seconds)
    except subprocess.TimeoutExpired:
        return "slow", f"more than {most_seconds} s"
    message = done.stderr.strip().replace(f"{path}: ", "")
    if done.returncode == 2:
        why = expected(path, message)
        return ("expected", f"{message} ({why})") if why else ("refused", message)
    if done.returncode != 0:
        return "crashed", f"exit code {done.returncode}: {message[-300:]}"
    if any(part in str(path) for part, _, _ in EXPECTED):
        return "changed", "is expected to be refused, and is rendered"
    if is_black() and "the image is black" not in message:
        return "black", message
    return "rendered", ""


counts = collections.Counter()
packages = collections.Counter()
exporters = set()
for path, data in files():
    found, words = outcome(path)
    counts[found] += 1
    packages[path.relative_to(options.folder).parts[0]] += 1
    exporters.update(re.findall(rb'"generator"\s*:\s*"([^"]*)"', data[:1 << 20]))
    if words:
        print(f"{found:9}{path.relative_to(options.folder)}: {words}", flush=True)
print(", ".join(f"{name} {count}" for name, count in packages.items()))
print(f"{counts.total()} files of {len(exporters)} exporters and versions: "
      f"{counts['rendered']} rendered, {counts['expected']} refused as expected, "
      f"{counts['refused']} refused otherwise, {counts['changed']} not refused as expected, "
      f"{counts['crashed']} crashed, {counts['slow']} too slow, {counts['black']} black")
sys.exit(counts["rendered"] + counts["expected"] < counts.total() or counts.total() == 0)
