# SPDX-License-Identifier: MIT
"""The paper's experiment; see paper.sh, which builds the program first.

Times are prepare + render of --stats: without loading, building the BVH and compiling. Every figure
is the median over rounds in which the methods take turns; errors are relMSE against the all-lights
image of the same seed, whose pixel samples are the same. The paper does not say how many light
samples it took: N is chosen so that uniform takes the paper's share of the all-lights time.
"""
import argparse
import json
import pathlib
import statistics
import subprocess

PROGRAM = "build/manylight"
FOLDER = pathlib.Path("build/paper")
SIZE = ["--width", "512", "--height", "512", "--spp", "2"]
# Share of the all-lights time that uniform took in the paper's table 1.
SCENES = {"cornell": 1161.3 / 2641.7, "dragon": 1203.7 / 3046.0}


def render(scene, sampler, samples, seed, name, *extra):
    """Renders to FOLDER/name.exr; returns prepare + render seconds and all statistics."""
    subprocess.run([PROGRAM, "render", FOLDER / f"{scene}.glb", "--quiet", "--sampler", sampler,
                    "--light-samples", str(samples), "--seed", str(seed), *SIZE,
                    "-o", FOLDER / f"{name}.exr", "--stats", FOLDER / "stats.json", *extra],
                   check=True)
    stats = json.loads((FOLDER / "stats.json").read_text())
    return stats["seconds"]["prepare"] + stats["seconds"]["render"], stats


def relmse(name, reference):
    run = subprocess.run([PROGRAM, "compare", FOLDER / f"{name}.exr", FOLDER / f"{reference}.exr",
                          "--json"], check=True, capture_output=True, text=True)
    return json.loads(run.stdout)["relmse"]


def choose_samples(scene, share, device):
    """N at which uniform takes the share of the all-lights time, by the secant method."""
    def ratio(samples):
        pairs = []
        for _ in range(5):
            uniform = render(scene, "uniform", samples, 0, "scratch", *device)[0]
            pairs.append(uniform / render(scene, "exhaustive", 1, 0, "scratch", *device)[0])
        return statistics.median(pairs)

    low, guess = 8, 56
    at_low = ratio(low)
    for _ in range(2):
        guess = round(low + (share - at_low) * (guess - low) / (ratio(guess) - at_low))
    return guess


def measure(scene, share, rounds, device):
    render(scene, "exhaustive", 1, 0, "scratch", *device)  # compiles
    samples = choose_samples(scene, share, device)
    methods = {"all_lights": ("exhaustive", 1), "uniform": ("uniform", samples),
               "contribution": ("contribution", samples), "uniform_4": ("uniform", 4),
               "contribution_4": ("contribution", 4)}
    seconds = {key: [] for key in methods}
    errors = {key: [] for key in methods}
    for seed in range(rounds):
        for key, (sampler, n) in methods.items():
            time, stats = render(scene, sampler, n, seed, f"{scene}_{key}", *device)
            seconds[key].append(time)
            errors[key].append(relmse(f"{scene}_{key}", f"{scene}_all_lights"))

    def paired(a, b):
        return statistics.median(x / y for x, y in zip(seconds[a], seconds[b]))

    median = {key: statistics.median(values) for key, values in seconds.items()}
    error = {key: statistics.median(values) for key, values in errors.items()}
    return {
        "name": scene, "device": stats["device"], "light_samples": samples,
        "lights": stats["lights"], "triangles": stats["triangles"], "clusters": stats["clusters"],
        "all_lights_s": median["all_lights"], "uniform_s": median["uniform"],
        "contribution_s": median["contribution"],
        "uniform_relmse": error["uniform"], "contribution_relmse": error["contribution"],
        "uniform_relmse_4": error["uniform_4"], "contribution_relmse_4": error["contribution_4"],
        "uniform_over_all_lights": paired("uniform", "all_lights"),
        "contribution_over_uniform": paired("contribution", "uniform"),
        "all_lights_over_contribution": paired("all_lights", "contribution"),
        "relmse_ratio_4": error["contribution_4"] / error["uniform_4"],
    }


def sweep(scene, device):
    """relMSE as the number of light samples grows: the bias of the paper's sampler stays."""
    render(scene, "exhaustive", 1, 0, "sweep_reference", *device)
    rows = []
    for samples in (1, 2, 4, 8, 16, 32, 64, 128):
        row = {"light_samples": samples}
        for sampler in ("uniform", "contribution", "contribution-defensive"):
            render(scene, sampler, samples, 0, "scratch", *device)
            row[sampler] = relmse("scratch", "sweep_reference")
        rows.append(row)
    return rows


def draw_figures(scene, device):
    """Figure 3: clusters by normals alone, and with visibility. Figures 4 and 5: three methods."""
    maps = []
    for threshold in ("0", "0.7"):
        maps.append(FOLDER / f"{scene}_clusters_{threshold}.png")
        render(scene, "contribution", 4, 0, "scratch", "--visibility-threshold", threshold,
               "--cluster-map", maps[-1], *device)
    subprocess.run(["oiiotool", *maps, "--mosaic:pad=4", "2x1",
                    "-o", FOLDER / f"figure3_{scene}.png"], check=True)
    pictures = []
    for sampler in ("exhaustive", "uniform", "contribution"):
        pictures.append(FOLDER / f"{scene}_{sampler}.png")
        render(scene, sampler, 4, 0, "scratch", "-o", pictures[-1], "--exposure", "0", *device)
    figure = FOLDER / ("figure4_cornell.png" if scene == "cornell" else "figure5_dragon.png")
    subprocess.run(["oiiotool", *pictures, "--mosaic:pad=4", "3x1", "-o", figure], check=True)


def print_table(results):
    print("\nTable 1: seconds (prepare + render), 512 x 512, 2 pixel samples")
    head = ("scene", "N", "all lights", "uniform", "paper's", "relMSE uniform", "relMSE paper's")
    print("{:<9}{:>4}{:>12}{:>10}{:>10}{:>16}{:>16}".format(*head))
    for r in results:
        print("{name:<9}{light_samples:>4}{all_lights_s:>12.3f}{uniform_s:>10.3f}"
              "{contribution_s:>10.3f}{uniform_relmse:>16.5f}{contribution_relmse:>16.5f}"
              .format(**r))
        print("{:<9}{:>4}{:>12}{:>10}{:>10}{uniform_relmse_4:>16.5f}{contribution_relmse_4:>16.5f}"
              .format("", 4, "", "", "", **r))
    print("\nPaired ratios (medians)")
    for r in results:
        print("{name:<9}uniform / all lights {uniform_over_all_lights:.3f}, paper's / uniform "
              "{contribution_over_uniform:.3f}, all lights / paper's "
              "{all_lights_over_contribution:.2f}, relMSE at N = 4 paper's / uniform "
              "{relmse_ratio_4:.3f}".format(**r))
    print("\nrelMSE against the number of light samples: the paper's sampler stops at its bias")
    for r in results:
        for row in r["sweep"]:
            print("{:<9}N {light_samples:>4}  uniform {uniform:.5f}  "
                  "contribution {contribution:.5f}  contribution-defensive {defensive:.5f}".format(
                      r["name"], defensive=row["contribution-defensive"], **row))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", help="glTF mesh for the dragon's room")
    parser.add_argument("--device", help="OpenCL device, as for manylight render")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    device = ["--device", arguments.device] if arguments.device else []
    FOLDER.mkdir(parents=True, exist_ok=True)
    results = []
    for scene, share in SCENES.items():
        mesh = ["--mesh", arguments.mesh] if arguments.mesh and scene == "dragon" else []
        subprocess.run([PROGRAM, "scene", scene, "-o", FOLDER / f"{scene}.glb", *mesh], check=True)
        results.append(measure(scene, share, arguments.rounds, device))
        results[-1]["sweep"] = sweep(scene, device)
        draw_figures(scene, device)
    for scratch in (*FOLDER.glob("scratch.*"), FOLDER / "stats.json"):
        scratch.unlink()
    (FOLDER / "paper.json").write_text(json.dumps({"scenes": results}, indent=2) + "\n")
    print_table(results)
    print(f"\nwrote {FOLDER}/paper.json and figures 3 to 5 beside it")


main()
