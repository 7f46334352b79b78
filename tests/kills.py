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
    ("cornell", "--spp", "12", "--memory", "12400K"),
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


def start(program, arguments, folder):
    return subprocess.Popen([program, *arguments], cwd=folder, stderr=subprocess.PIPE, text=True)


def finish(run):
    """Waits for a run that must succeed."""
    _, errors = run.communicate()
    if run.returncode != 0:
        sys.exit(f"{' '.join(run.args)}: exit code {run.returncode}: {errors}")


def stamp(file):
    return file.stat().st_mtime_ns if file.exists() else None


def is_killed(run, state, delay, wait_for_state):
    """Kills a run `delay` seconds after its start or first checkpoint, unless it ends before."""
    old = stamp(state)
    while wait_for_state and run.poll() is None and stamp(state) in (None, old):
        time.sleep(0.002)
    try:
        run.wait(timeout=delay)
        return False
    except subprocess.TimeoutExpired:
        run.kill()
        run.communicate()
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
        most = 10 * options.kills  # renders
        while (kills < options.kills or resumed * 2 < options.kills) and number < most:
            scene, *more = RENDERS[number % len(RENDERS)]
            number += 1
            arguments = ["render", str(scenes / f"{scene}.glb"), "-q", "--height", "64", *more]
            key = tuple(arguments)
            if key not in whole:
                begun = time.monotonic()
                finish(start(program, [*arguments, "-o", "whole.exr"], folder))
                whole[key] = (pixels(folder / "whole.exr"), time.monotonic() - begun)
            expected, seconds = whole[key]
            saved = [*arguments, "-o", "broken.exr", "--checkpoint", "state", "--resume",
                     "--checkpoint-every", "0"]
            breaks = 0
            run = start(program, saved, folder)
            while breaks < 4 and is_killed(run, folder / "state", chance.uniform(0, 0.7 * seconds),
                                           wait_for_state=chance.random() < 0.7):
                breaks += 1
                resumed += (folder / "state").exists()
                run = start(program, saved, folder)
            finish(run)
            kills += breaks
            if pixels(folder / "broken.exr") != expected or not expected:
                sys.exit(f"{' '.join(saved)}: another image after {breaks} kills")
            (folder / "broken.exr").unlink()
            (folder / "state").unlink()
    print(f"{kills} kills, {resumed} of them with a checkpoint to go on from: all {number} images "
          "equal to those of renders without a break")
    if kills < options.kills or resumed * 2 < options.kills:
        sys.exit("too few of them")


if __name__ == "__main__":
    main()
