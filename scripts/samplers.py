# SPDX-License-Identifier: MIT
"""The tables of samplers.sh, which builds the program first.

All images have half the scene's usual size and one or more pixel samples at the pixel's centre (but
for few-lights), and show what emitters light, not the emitters. Errors are relMSE against an image
of all lights, or, where those are too many, a long run of sampler adaptive; the mean over seeds.
Times are prepare + render of --stats: light tree, cuts and learning are in, loading, the BVH and
compiling are not. The error of a sampler at another one's time is read between its own runs
(log-log).
"""
import argparse
import itertools
import json
import math
import pathlib
import statistics
import subprocess

PROGRAM = "build/manylight"
FOLDER = pathlib.Path("build/samplers")
HEIGHTS = {"cornell": 256, "dragon": 256}  # others: 180
BUILTIN = ("cornell", "dragon", "rooms", "city", "glossy", "blinds")
LADDER = ((4, 1), (8, 1), (16, 1), (32, 1), (64, 1), (8, 4), (8, 8))  # light samples, pixel samples
MOST_LIGHTS = 20_000  # of which all can be drawn


def render(scene, sampler, samples, spp, seed, name, device, positions=("--pixel-centre",)):
    """Renders to FOLDER/name.exr; returns prepare + render seconds and all statistics."""
    subprocess.run([PROGRAM, "render", scene, "--quiet", "--sampler", sampler, "--light-samples",
                    str(samples), "--spp", str(spp), "--seed", str(seed), *positions,
                    "--hide-emitters", "--height", str(HEIGHTS.get(scene.stem, 180)),
                    "-o", FOLDER / f"{name}.exr", "--stats", FOLDER / "stats.json", *device],
                   check=True)
    stats = json.loads((FOLDER / "stats.json").read_text())
    return stats["seconds"]["prepare"] + stats["seconds"]["render"], stats


def relmse(name, reference):
    run = subprocess.run([PROGRAM, "compare", FOLDER / f"{name}.exr", FOLDER / f"{reference}.exr",
                          "--json"], check=True, capture_output=True, text=True)
    return json.loads(run.stdout)["relmse"]


def make_reference(scene, device):
    """Returns the image's name and its own error (0: all lights)."""
    lights = render(scene, "uniform", 1, 1, 0, "scratch", device)[1]["lights"]
    if lights <= MOST_LIGHTS:
        spp = max(1, min(32, 20_000 // lights))
        render(scene, "exhaustive", 1, spp, 0, "reference", device)
        return f"all {lights} lights, {spp} spp", 0
    render(scene, "adaptive", 16, 128, 1, "reference", device)
    render(scene, "adaptive", 16, 128, 2, "other", device)
    return "adaptive, 128 spp", relmse("other", "reference") / 2


def measure(scene, seeds, device):
    made, own_error = make_reference(scene, device)
    runs = {("lighttree", 4, 1): [], ("lighttree", 16, 1): []}
    runs |= {("adaptive", *step): [] for step in LADDER}
    for seed in range(seeds + 1):  # all take turns; the first round compiles
        for key, results in runs.items():
            seconds = render(scene, *key, seed, "image", device)[0]
            if seed > 0:
                results.append((seconds, relmse("image", "reference")))
    time = {key: statistics.median(r[0] for r in results) for key, results in runs.items()}
    error = {key: statistics.fmean(r[1] for r in results) for key, results in runs.items()}
    target = time["lighttree", 16, 1]
    points = sorted((time["adaptive", *step], error["adaptive", *step]) for step in LADDER)
    after = next((i for i, p in enumerate(points) if p[0] >= target), len(points) - 1)
    (t0, e0), (t1, e1) = points[max(after - 1, 0)], points[max(after, 1)]
    slope = math.log(e1 / e0) / math.log(t1 / t0)
    equal = e0 * math.exp(slope * math.log(target / t0))
    return {"reference": made, "reference_error": own_error,
            "same_samples": {"lighttree": error["lighttree", 4, 1],
                             "adaptive": error["adaptive", 4, 1]},
            "equal_time": {"seconds": target, "lighttree": error["lighttree", 16, 1],
                           "adaptive": equal},
            "runs": [{"sampler": k[0], "light_samples": k[1], "spp": k[2], "seconds": time[k],
                      "relmse": error[k]} for k in runs]}


def worth(scenes, seeds, device):
    table = {}
    print("relMSE            4 light samples                 in the light tree's time for 16")
    print("           lighttree  adaptive   ratio   seconds  lighttree  adaptive   ratio")
    for scene in scenes:
        row = table[scene.stem] = measure(scene, seeds, device)
        same, equal = row["same_samples"], row["equal_time"]
        print(f"{scene.stem:10} {same['lighttree']:9.4f} {same['adaptive']:9.5f} "
              f"{same['lighttree'] / same['adaptive']:7.1f} {equal['seconds']:9.3f} "
              f"{equal['lighttree']:10.4f} {equal['adaptive']:9.5f} "
              f"{equal['lighttree'] / equal['adaptive']:7.1f}", flush=True)
        if row["reference_error"]:
            print(f"           (reference: {row['reference']}, its own relMSE "
                  f"{row['reference_error']:.5f})")
    return table


def error_at(points, seconds):
    """The error that a sampler of runs (seconds, relmse) has after `seconds`; none if it has none
    so soon."""
    best = []  # runs that no faster one is better than
    for point in sorted(points):
        if not best or point[1] < best[-1][1]:
            best.append(point)
    if seconds < best[0][0]:
        return math.inf
    before = max(i for i, p in enumerate(best) if p[0] <= seconds)
    (t0, e0) = best[before]
    if before + 1 == len(best):
        return e0 * t0 / seconds
    (t1, e1) = best[before + 1]
    return e0 * math.exp(math.log(e1 / e0) / math.log(t1 / t0) * math.log(seconds / t0))


def never_worse(scenes, seeds, device):
    """Adaptive's error over that of the best other sampler in the same time."""
    print("largest ratio of relMSE to the best other sampler's in the same time, over 1 to 64 "
          "light samples and 1 to 16 spp")
    table = {}
    for scene in scenes:
        make_reference(scene, device)
        ladder = list(itertools.product((1, 4, 16, 64), (1, 4, 16)))
        samplers = ("uniform", "power", "ris", "lighttree", "adaptive")
        runs = {(name, *step): [] for name in samplers for step in ladder}
        for name in samplers:
            render(scene, name, 4, 1, 0, "image", device)  # compiles
        for seed in range(1, seeds + 1):
            for key, results in runs.items():
                seconds = render(scene, *key, seed, "image", device)[0]
                results.append((seconds, relmse("image", "reference")))
        mean = {key: (statistics.median(r[0] for r in results),
                      statistics.fmean(r[1] for r in results)) for key, results in runs.items()}
        rows = []
        for step in ladder:
            seconds, error = mean["adaptive", *step]
            others = {name: error_at([mean[name, *s] for s in ladder], seconds)
                      for name in samplers[:-1]}
            best = min(others, key=others.get)
            if math.isfinite(others[best]):
                rows.append((error / others[best], step, best))
        table[scene.stem] = [{"ratio": r, "light_samples": step[0], "spp": step[1], "best": best}
                             for r, step, best in rows]
        ratio, step, best = max(rows)
        print(f"{scene.stem:10} {ratio:7.3f}  ({step[0]} light samples, {step[1]} spp; {best}); "
              f"median {statistics.median(r[0] for r in rows):.3f}", flush=True)
    return table


def few_lights(seeds, device):
    """All lights or 4 light samples, with anti-aliasing: relMSE x seconds of 8 pixel samples."""
    print("lights  exhaustive  adaptive   ratio")
    table = []
    for lights in (8, 16, 24, 32, 48):
        scene = FOLDER / "few.glb"
        subprocess.run([PROGRAM, "scene", "city", "--lights", str(lights), "-o", scene], check=True,
                       stdout=subprocess.DEVNULL)
        render(scene, "exhaustive", 1, 400, 0, "reference", device, ())
        products = {"exhaustive": [], "adaptive": []}
        for seed in range(seeds + 1):  # in turns; the first one compiles
            for sampler, results in products.items():
                seconds = render(scene, sampler, 4, 8, seed + 1, "image", device, ())[0]
                results.append(seconds * relmse("image", "reference"))
        row = {name: statistics.median(results[1:]) for name, results in products.items()}
        table.append({"lights": lights} | row)
        print(f"{lights:6} {row['exhaustive']:11.6f} {row['adaptive']:9.6f} "
              f"{row['exhaustive'] / row['adaptive']:7.2f}", flush=True)
    return table


def scale(seeds, device):
    """The time of a frame of city with more and more lights."""
    print("lights    tree s  frame s   ratio")
    table = []
    for lights in (1000, 10_000, 100_000, 1_000_000):
        scene = FOLDER / "scale.glb"
        subprocess.run([PROGRAM, "scene", "city", "--lights", str(lights), "-o", scene], check=True,
                       stdout=subprocess.DEVNULL)
        runs = [render(scene, "adaptive", 4, 1, seed, "image", device)[1]["seconds"]
                for seed in range(seeds + 1)][1:]  # the first one compiles
        tree = statistics.median(r["prepare"] for r in runs)
        frame = statistics.median(r["render"] for r in runs)
        table.append({"lights": lights, "tree": tree, "frame": frame})
        print(f"{lights:8} {tree:7.3f} {frame:8.3f} {frame / table[0]['frame']:7.2f}", flush=True)
    subprocess.run([PROGRAM, "render", scene, "--quiet", "--width", "1920", "--height", "1080",
                    "--memory", "2G", "--spp", "1", "-o", FOLDER / "image.exr", "--stats",
                    FOLDER / "stats.json", *device], check=True)
    stats = json.loads((FOLDER / "stats.json").read_text())
    peak = stats["memory_bytes"]["device_peak"] / 2**20
    print(f"1920 x 1080, {stats['lights']} lights, --memory 2G: {peak:.0f} MiB on the device, "
          f"{stats['batches']} batch(es), {stats['seconds']['total']:.1f} s")
    return table


def overhead(scenes, seeds, device):
    """The share of a frame with 16 light samples that is neither their shading nor their shadow
    rays."""
    print("share of a frame with 16 light samples")
    print("            lights   cuts  visibility  weights     sum")
    table = {}
    for scene in scenes:
        runs = [render(scene, "adaptive", 16, 1, seed, "image", device)[1]
                for seed in range(seeds + 1)][1:]  # the first one compiles
        row = {stage: statistics.median(r["stage_seconds"][stage] / r["seconds"]["render"]
                                        for r in runs)
               for stage in ("cuts", "visibility", "weights")}
        row["sum"] = sum(row.values())
        table[scene.stem] = row | {"lights": runs[0]["lights"]}
        print(f"{scene.stem:10} {runs[0]['lights']:7} {row['cuts']:6.1%} {row['visibility']:10.1%} "
              f"{row['weights']:8.1%} {row['sum']:8.1%}", flush=True)
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--table",
                        choices=("worth", "never-worse", "overhead", "few-lights", "scale"),
                        default="worth")
    parser.add_argument("--scenes", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--device")
    arguments = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    if arguments.scenes:
        scenes = sorted(arguments.scenes.glob("*.glb"))
    else:
        scenes = [FOLDER / f"{name}.glb" for name in BUILTIN]
        for scene in scenes:
            subprocess.run([PROGRAM, "scene", scene.stem, "-o", scene], check=True,
                           stdout=subprocess.DEVNULL)
    device = ["--device", arguments.device] if arguments.device else []
    if arguments.only:
        scenes = [s for s in scenes if s.stem in arguments.only.split(",")]
    if arguments.table in ("scale", "few-lights"):
        table = {"scale": scale, "few-lights": few_lights}[arguments.table](arguments.seeds, device)
    else:
        make = {"worth": worth, "never-worse": never_worse, "overhead": overhead}
        table = make[arguments.table](scenes, arguments.seeds, device)
    (FOLDER / f"{arguments.table}.json").write_text(json.dumps(table, indent=2) + "\n")


main()
