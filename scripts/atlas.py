# SPDX-License-Identifier: MIT
"""The failure atlas of atlas.sh, which builds the program first.

Each point of a sweep is a chart (manylight chart) in build/atlas/SWEEP/VALUE, with its own report.
Errors are means over seeds. What a sampler's error is worth in equal time is judged by error times
seconds: the errors of samplers without bias fall as the inverse of their time.
"""
import argparse
import json
import math
import pathlib
import shlex
import statistics
import subprocess
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.colors
import matplotlib.pyplot as plt

PROGRAM = "build/manylight"
FOLDER = pathlib.Path("build/atlas")
HEIGHT = 72
OPTIONS = {"--light-samples": "4", "--spp": "4", "--seeds": "3", "--most-seconds": "40",
           "--reference-time": "25"}
# Difficulties that are not the scene's.
OTHER = (
    {"name": "light-samples", "scene": "blinds", "option": "--light-samples",
     "summary": "light samples per pixel sample", "values": [1, 4, 16, 64, 256]},
    {"name": "shift", "scene": "range", "option": "--shift",
     "summary": "shift of the image against the tiles, pixels to the right and down",
     "values": ["0,0", "1,1", "4,4", "8,8", "16,16", "31,31", "32,32"]},
    {"name": "size", "scene": "range", "option": "--width --height",
     "summary": "width and height of the image, pixels",
     "values": ["1x1", "2x3", "17x9", "33x31", "97x61"]})
EXACT = 1e-9  # an error below this is rounding
BREAKS = {"adaptive": 1.2}  # error over the best sampler's from which a sampler is shown to fail
BREAKS_OTHERWISE = 10
MOST_PICTURES = 4  # of a sampler


def list_sweeps():
    """Sweeps of the built-in scenes, by the program's own list, and the others."""
    run = subprocess.run([PROGRAM, "scene", "--list"], check=True, capture_output=True, text=True)
    return [{"name": f"{scene['name']}-{p['name']}", "scene": scene["name"],
             "option": f"--{p['name']}", "of_scene": True, "summary": p["summary"],
             "usual": p["usual"], "values": p["sweep"]}
            for scene in json.loads(run.stdout) for p in scene["parameters"]] + list(OTHER)


def text(value):
    return value if isinstance(value, str) else f"{value:.6g}"


def chart(sweep, value, extra, again):
    """Charts one point unless it is there; returns its chart.json, or None where it cannot be."""
    folder = FOLDER / sweep["name"] / text(value)
    if (folder / "chart.json").exists() and not again:
        return json.loads((folder / "chart.json").read_text())
    folder.parent.mkdir(parents=True, exist_ok=True)
    scene = folder.parent / f"{text(value) if sweep.get('of_scene') else sweep['scene']}.glb"
    own = [sweep["option"], text(value)] if sweep.get("of_scene") else []
    subprocess.run([PROGRAM, "scene", sweep["scene"], *own, "-o", scene], check=True,
                   stdout=subprocess.DEVNULL)
    options = OPTIONS | {"--height": str(HEIGHT)}
    if not own:
        names = sweep["option"].split()
        options |= dict(zip(names, text(value).split("x") if len(names) > 1 else [text(value)]))
    for name, given in zip(extra[::2], extra[1::2]):
        options[name] = given
    run = subprocess.run([PROGRAM, "chart", scene, "--quiet", "-o", folder,
                          *(word for option in options.items() for word in option)],
                         stderr=subprocess.PIPE, text=True)
    print(run.stderr, end="", flush=True)
    if run.returncode == 2 and "no light reaches" in run.stderr:
        return None
    run.check_returncode()
    return json.loads((folder / "chart.json").read_text())


def results_of(chart_json):
    """By sampler: its error and what it took, or None where it was left out."""
    out = {}
    for sampler in chart_json["samplers"]:
        name = sampler["name"]
        setting = [s for s in chart_json["settings"] if s["sampler"] == name]
        runs = [r for r in chart_json["runs"] if r["sampler"] == name]
        if not setting:
            out[name] = None
            continue
        out[name] = {"relmse": statistics.fmean(r["relmse"] for r in runs),
                     "seconds": setting[0]["seconds"]["median"], "bias": setting[0]["bias"],
                     "z": setting[0]["z"],
                     "worst_1_percent": setting[0]["worst_1_percent"]["median"]}
    return out


def measure(sweep, extra, again):
    print(f"{sweep['name']}: {sweep['summary']}", flush=True)
    points = []
    for value in sweep["values"]:
        start = time.time()
        found = chart(sweep, value, extra, again)
        if not found:
            print(f"  {text(value):>8}  no light reaches the image")
            continue
        results = results_of(found)
        add_ratios(results)
        points.append({"value": value, "command": found["command"],
                       "seconds": found["seconds"]["total"], "reference": found["reference"],
                       "results": results})
        shown = {n: f"{r['ratio']:.3g}" for n, r in results.items() if r and "ratio" in r}
        print(f"  {text(value):>8}  {time.time() - start:5.0f} s  {shown}", flush=True)
    return {k: v for k, v in sweep.items() if k != "values"} | {"points": points}


def add_ratios(results):
    """The error over the best sampler's, at equal light samples and in equal time."""
    drawing = [r for name, r in results.items() if r and name != "exhaustive"]
    for key, cost, rivals in (("ratio", lambda r: max(r["relmse"], EXACT), drawing),
                              ("time_ratio", lambda r: max(r["relmse"], EXACT) * r["seconds"],
                               [r for r in results.values() if r and r["relmse"] > EXACT])):
        best = min(map(cost, rivals), default=None)
        for r in rivals:
            r[key] = cost(r) / best


def cell_text(ratio):
    if ratio < 9.95:
        return f"{ratio:.1f}"
    return f"{ratio:.0f}" if ratio < 9999 else f"$10^{{{math.log10(ratio):.0f}}}$"


def draw_heat_maps(sweeps, key, title, path):
    """One panel for each sweep: samplers down, difficulty to the right."""
    columns = 3
    rows = math.ceil(len(sweeps) / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(15, 2.55 * rows), squeeze=False)
    scale = matplotlib.colors.LogNorm(1, 1000)
    colors = plt.get_cmap("YlOrRd").copy()
    colors.set_bad("0.85")
    for ax in axes.flat[len(sweeps):]:
        ax.axis("off")
    for ax, sweep in zip(axes.flat, sweeps):
        points = sweep["points"]
        names = [n for n in points[0]["results"] if key == "time_ratio" or n != "exhaustive"]
        cells = [[(p["results"][n] or {}).get(key, math.nan) for p in points] for n in names]
        picture = ax.imshow(cells, norm=scale, cmap=colors, aspect="auto")
        for y, name in enumerate(names):
            for x, ratio in enumerate(cells[y]):
                result = points[x]["results"][name]
                label = "–" if not result else "exact" if math.isnan(ratio) else cell_text(ratio)
                ax.text(x, y, label, ha="center", va="center", fontsize=8,
                        color="white" if ratio > 60 else "black")
        ax.set_xticks(range(len(points)), [text(p["value"]) for p in points], fontsize=8)
        ax.set_yticks(range(len(names)), names, fontsize=8)
        ax.set_title(f"{sweep['scene']} {sweep['option']}", fontsize=9)
    figure.suptitle(title, fontsize=12)
    figure.tight_layout(rect=(0, 0, 0.93, 0.99))
    bar = figure.colorbar(picture, cax=figure.add_axes((0.945, 0.3, 0.012, 0.4)))
    bar.set_label("over the best sampler's")
    figure.savefig(path, dpi=80)
    plt.close(figure)


def breaks_of(sweeps, sampler):
    """Where the sampler fails: the worst point of each sweep, the worst sweep first."""
    limit = BREAKS.get(sampler, BREAKS_OTHERWISE)
    worst = []
    for sweep in sweeps:
        points = [p for p in sweep["points"]
                  if (p["results"][sampler] or {}).get("ratio", 0) > limit]
        if points:
            point = max(points, key=lambda p: p["results"][sampler]["ratio"])
            worst.append((sweep, point))
    return sorted(worst, key=lambda w: -w[1]["results"][sampler]["ratio"])


def render(sweep, point, sampler):
    """The image of the chart's first seed as pixels, exposed as the reference is."""
    folder = FOLDER / sweep["name"] / text(point["value"])
    found = json.loads((folder / "chart.json").read_text())
    image = folder / "reference.exr"
    if sampler:
        image = FOLDER / "image.exr"
        command = next(i["command"] for i in found["images"] if i["sampler"] == sampler)
        words = shlex.split(command)
        subprocess.run([PROGRAM, *words[1:words.index("-o")], "--quiet", "-o", image], check=True)
    exposure = 0.2 / found["reference"]["luminance"]
    subprocess.run(["oiiotool", image, "--ch", "R,G,B", "--mulc", str(exposure), "--colorconvert",
                    "linear", "sRGB", "-d", "uint8", "-o", FOLDER / "image.png"], check=True)
    return plt.imread(FOLDER / "image.png")


def draw_breaks(sweeps, sampler):
    worst = breaks_of(sweeps, sampler)
    path = FOLDER / f"atlas-{sampler}.jpg"
    path.unlink(missing_ok=True)
    shown = [w for w in worst if w[0]["name"] != "size"][:MOST_PICTURES]
    if shown:
        figure, axes = plt.subplots(len(shown), 3, figsize=(9, 2.05 * len(shown)), squeeze=False)
        for row, (sweep, point) in zip(axes, shown):
            results = point["results"]
            best = min((n for n, r in results.items() if r and "ratio" in r),
                       key=lambda n: results[n]["relmse"])
            for ax, name in zip(row, (None, sampler, best)):
                ax.imshow(render(sweep, point, name), interpolation="nearest")
                ax.axis("off")
                setting = f"{sweep['scene']} {sweep['option']} {text(point['value'])}"
                ax.set_title(f"{name}, relMSE {results[name]['relmse']:.2g}" if name else
                             f"{setting}: reference", fontsize=8)
        figure.tight_layout(pad=0.4)
        figure.savefig(path, dpi=100, pil_kwargs={"quality": 80})
        plt.close(figure)
    return [{"sweep": s["name"], "value": p["value"], "ratio": p["results"][sampler]["ratio"],
             "relmse": p["results"][sampler]["relmse"]} for s, p in worst]


def print_table(sweeps):
    print("| Sweep | Values | What it is |\n|---|---|---|")
    for sweep in sweeps:
        if not sweep.get("of_scene"):
            continue
        values = ", ".join(map(text, sweep["values"]))
        print(f"| `{sweep['scene']} {sweep['option']}` | {values} (usually "
              f"{text(sweep['usual'])}) | {sweep['summary']} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--draw", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--table", action="store_true")
    arguments, extra = parser.parse_known_args()
    sweeps = list_sweeps()
    names = [s["name"] for s in sweeps]
    if arguments.list:
        return print("\n".join(names))
    if arguments.table:
        return print_table(sweeps)
    only = [n for n in arguments.only.split(",") if n]
    for name in only:
        if name not in names:
            parser.error(f"--only {name}: no such sweep (there are: {', '.join(names)})")
    if len(extra) % 2:
        parser.error(f"{' '.join(extra)}: options of manylight chart come with their values")
    FOLDER.mkdir(parents=True, exist_ok=True)
    start = time.time()
    charted = []
    for sweep in sweeps:
        wanted = not arguments.draw and (not only or sweep["name"] in only)
        there = [v for v in sweep["values"]
                 if (FOLDER / sweep["name"] / text(v) / "chart.json").exists()]
        values = sweep["values"] if wanted else there
        if values:
            charted.append(measure(sweep | {"values": values}, extra, wanted and arguments.again))
    samplers = [s for s in charted[0]["points"][0]["results"] if s != "exhaustive"]
    atlas = {"options": OPTIONS | {"--height": str(HEIGHT)}, "sweeps": charted,
             "seconds": sum(p["seconds"] for s in charted for p in s["points"]),
             "breaks": {name: draw_breaks(charted, name) for name in samplers}}
    draw_heat_maps(charted, "ratio", "relMSE over the best sampler's at equal light samples",
                   FOLDER / "atlas-equal-samples.png")
    draw_heat_maps(charted, "time_ratio", "relMSE × seconds over the best sampler's",
                   FOLDER / "atlas-equal-time.png")
    (FOLDER / "atlas.json").write_text(json.dumps(atlas, indent=1) + "\n")
    print(f"{time.time() - start:.0f} s ({atlas['seconds']:.0f} s of charts); wrote "
          f"{FOLDER / 'atlas.json'}")


main()
