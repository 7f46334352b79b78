# SPDX-License-Identifier: MIT
"""Kills checkpointed renders at random moments until they are done, and compares each image with
that of a render without a break, bit for bit.

usage: kills.py MANYLIGHT SCENES [--kills N] [--seed S]
"""
import argparse
import pathlib
import random
import subprocess
import sys
import tempfile
import time

# Scene and options: a plain render, one of several batches, clusters, a stop by the error, layers.
RENDERS = (
    ("pinhole", "--spp", "16"),
    ("cornell", "--spp", "12", "--memory", "12M"),
    ("blinds", "--spp", "6", "--sampler", "contribution"),
    ("cornell", "--target-error", "0.002", "--aov", "error,albedo"),
    ("glossy", "--spp", "8", "--sampler", "lighttree", "--pixel-centre"),
    ("cornell", "--spp", "8", "--emitter-points", "0"),
)


def pixels(image):
    """What says whether all channels of an image are the same."""
    run = subprocess.run(["oiiotool", "-v", "--hash", str(image)], check=True, capture_output=True,
                         text=True)
    return [line.strip() for line in run.stdout.splitlines() if "SHA-1" in line]


def render(program, arguments, folder, kill_after=None):
    """Whether it came to its end."""
    run = subprocess.Popen([program, *arguments], cwd=folder, stderr=subprocess.PIPE, text=True)
    try:
        _, errors = run.communicate(timeout=kill_after)
    except subprocess.TimeoutExpired:
        run.kill()
        run.communicate()
        return False
    if run.returncode != 0:
        sys.exit(f"{' '.join(arguments)}: exit code {run.returncode}: {errors}")
    return True


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("scenes", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program, scenes = str(options.program.resolve()), options.scenes.resolve()
    chance = random.Random(options.seed)
    kills = resumed = 0
    whole = {}  # of each render: its pixels and its seconds
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        number = 0
        while kills < options.kills:
            scene, *more = RENDERS[number % len(RENDERS)]
            number += 1
            arguments = ["render", str(scenes / f"{scene}.glb"), "-q", "--height", "64", *more]
            key = tuple(arguments)
            if key not in whole:
                begun = time.monotonic()
                render(program, [*arguments, "-o", "whole.exr"], folder)
                whole[key] = (pixels(folder / "whole.exr"), time.monotonic() - begun)
            expected, seconds = whole[key]
            saved = [*arguments, "-o", "broken.exr", "--checkpoint", "state", "--resume",
                     "--checkpoint-every", "0"]
            breaks = 0
            while not render(program, saved, folder, chance.uniform(0.3, 1) * seconds
                             if breaks < 4 else None):
                breaks += 1
                resumed += (folder / "state").exists()
            kills += breaks
            if pixels(folder / "broken.exr") != expected or not expected:
                sys.exit(f"{' '.join(saved)}: another image after {breaks} kills")
            (folder / "broken.exr").unlink()
            (folder / "state").unlink()
    print(f"{kills} kills, {resumed} of them with a checkpoint to go on from: all {number} images "
          "equal to those of renders without a break")
    if resumed * 2 < kills:
        sys.exit("too few kills came after a checkpoint")


if __name__ == "__main__":
    main()
