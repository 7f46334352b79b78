# SPDX-License-Identifier: MIT
"""The table of stopping.sh, which builds the program first.

The error of an image is its relMSE against a render of 512 pixel samples by sampler adaptive, less
what that one says of its own error. Per scene, sampler and number of pixel samples: the mean error
over seeds; the mean estimate over it; the median over seeds of an image's estimate over its error;
and the share of images whose error lies in the interval of 95%.
"""
import argparse
import json
import pathlib
import statistics
import subprocess

PROGRAM = "build/manylight"
FOLDER = pathlib.Path("build/stopping")


def render(scene, sampler, spp, seed, height, name):
    """Renders to FOLDER/name.exr; returns its estimate: relMSE and standard error."""
    subprocess.run([PROGRAM, "render", scene, "--quiet", "--sampler", sampler, "--spp", str(spp),
                    "--seed", str(seed), "--height", str(height), "--aov", "error", "-o",
                    FOLDER / f"{name}.exr", "--stats", FOLDER / "stats.json"], check=True)
    error = json.loads((FOLDER / "stats.json").read_text())["error"]
    return error["relmse"], error["standard_error"]


def error_of(name):
    run = subprocess.run([PROGRAM, "compare", FOLDER / f"{name}.exr", FOLDER / "reference.exr",
                          "--json"], check=True, capture_output=True, text=True)
    return json.loads(run.stdout)["relmse"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", help="scenes")
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--spp", default="4,16")
    parser.add_argument("--height", type=int, default=64)
    arguments = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    listed = subprocess.run([PROGRAM, "scene", "--list"], check=True, capture_output=True,
                            text=True)
    names = [scene["name"] for scene in json.loads(listed.stdout)]
    print("| Scene | Sampler | spp | relMSE | estimate / relMSE | its median |"
          " intervals that hold it |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in arguments.only.split(",") if arguments.only else names:
        scene = FOLDER / f"{name}.glb"
        subprocess.run([PROGRAM, "scene", name, "-o", scene], check=True, capture_output=True)
        own = render(scene, "adaptive", 512, 999, arguments.height, "reference")[0]
        for sampler in ("adaptive", "uniform"):
            for spp in map(int, arguments.spp.split(",")):
                estimates, errors, held = [], [], 0
                for seed in range(arguments.seeds):
                    estimate, deviation = render(scene, sampler, spp, seed, arguments.height,
                                                 "image")
                    error = error_of("image") - own
                    estimates.append(estimate)
                    errors.append(error)
                    held += abs(estimate - error) <= 1.96 * deviation
                ratio = statistics.mean(estimates) / statistics.mean(errors)
                median = statistics.median(e / f for e, f in zip(estimates, errors))
                print(f"| `{name}` | {sampler} | {spp} | {statistics.mean(errors):.2g} |"
                      f" {ratio:.2f} | {median:.2f} | {held} of {arguments.seeds} |", flush=True)


main()
