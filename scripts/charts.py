# SPDX-License-Identifier: MIT
"""What charts.sh made, in one picture and one table: build/charts/errors.png, and on stdout for
each sampler its relMSE over adaptive's in the time of adaptive's 16 light samples.
"""
import json
import pathlib
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FOLDER = pathlib.Path("build/charts")
SETTING = (16, 1)  # light samples, pixel samples
EXACT = 1e-9  # an error below this is rounding
COLORS = {sampler["name"]: sampler["color"] for sampler in json.loads(
    subprocess.run(["build/manylight", "samplers", "--json"], check=True, capture_output=True,
                   text=True).stdout)}


def best_points(settings):
    """(seconds, relMSE) of the settings that no faster one is better than."""
    points = sorted((s["seconds"]["median"], s["relmse"]["median"]) for s in settings)
    best = []
    for point in points:
        if point[1] > EXACT and (not best or point[1] < best[-1][1]):
            best.append(point)
    return best


def draw(charts):
    figure, axes = plt.subplots(2, 3, figsize=(12, 7.2))
    for axis, (name, chart) in zip(axes.flat, charts.items()):
        for sampler, color in COLORS.items():
            settings = [s for s in chart["settings"] if s["sampler"] == sampler]
            points = best_points(settings)
            style = {"color": color, "linewidth": 2.4 if sampler == "adaptive" else 1.1}
            if points:
                axis.loglog(*zip(*points), "o-", markersize=3, **style)
            for s in settings:
                if sampler == "exhaustive" and s["relmse"]["median"] <= EXACT:
                    axis.axvline(s["seconds"]["median"], linestyle=":", **style)
        axis.set_title(f"{name}, {chart['scene']['lights']:,} lights", fontsize=10)
        axis.grid(alpha=0.3)
    for axis in axes[-1]:
        axis.set_xlabel("seconds")
    for axis in axes[:, 0]:
        axis.set_ylabel("relMSE")
    lines = [plt.Line2D([], [], color=color) for color in COLORS.values()]
    figure.legend(lines, COLORS, loc="lower center", ncol=8, fontsize=9, frameon=False)
    figure.tight_layout(rect=(0, 0.04, 1, 1))
    figure.savefig(FOLDER / "errors.png", dpi=80)
    print(f"wrote {FOLDER / 'errors.png'}")


def ratio(chart, sampler):
    for row in chart["ratios"]:
        if (row["sampler"], row["light_samples"], row["spp"]) == (sampler, *SETTING):
            found = row["equal_time"]["relmse"]
            return f"{float(format(found['ratio'], '.2g')):,g}" if found else "-"
    return "-"


def print_table(charts):
    print("| sampler | " + " | ".join(charts) + " |\n|---" + "|---" * len(charts) + "|")
    for sampler in COLORS:
        if sampler not in ("adaptive", "exhaustive"):
            print(f"| `{sampler}` | " + " | ".join(ratio(c, sampler) for c in charts.values())
                  + " |")


def main():
    names = ("cornell", "dragon", "rooms", "city", "glossy", "blinds")
    files = {name: FOLDER / name / "chart.json" for name in names}
    charts = {name: json.loads(file.read_text()) for name, file in files.items() if file.exists()}
    draw(charts)
    print_table(charts)


main()
