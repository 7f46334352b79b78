# SPDX-License-Identifier: MIT
"""The table of portability.sh, which builds the program first.

usage: portability.py PROGRAM [--only ROW,...] [--list] [--markdown] [--jobs N] [--width N]

Exits with 1 where a row fails, with 77 where all are skipped.
"""
import argparse
import concurrent.futures
import dataclasses
import functools
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FORMS = ("auto", "gpu", "4", "8", "16")
EMULATED = ("Haswell", "Nehalem")  # with AVX2; with SSE 4.2
# CL_CONFIG_CPU_TARGET_ARCH of Intel's runtime, and what a processor needs to run its code.
INTEL = {
    "corei7": {"sse4_2"},
    "core-avx2": {"avx2", "fma", "bmi2"},
    "skx": {"avx512f", "avx512dq", "avx512bw", "avx512vl", "avx512cd"},
}
LONGEST = 3600  # s; what takes longer hangs
HEADER = ("row", "driver", "version", "processor", "form", "scene", "verdict", "seconds")


@dataclasses.dataclass
class Device:
    """A device as `manylight devices` lists it."""
    number: int
    name: str
    platform: str
    version: str
    usable: bool


@dataclasses.dataclass
class Place:
    """Where kernels run: how the program is started there, and on which device."""
    name: str
    prefix: tuple = ()
    environment: dict = dataclasses.field(default_factory=dict)
    platform: str = ""   # part of the device's platform, where it is not known yet
    device: Device = None
    processor: str = ""  # where it is not the device's name
    slow: bool = False
    missing: str = ""    # why nothing can run there


@dataclasses.dataclass
class Row:
    place: Place
    form: str

    @property
    def name(self):
        return f"{self.place.name}-{self.form}"

    def result(self, scene, verdict, seconds=None):
        """A line of the table."""
        device = self.place.device
        return (self.name, device.platform if device else self.place.platform,
                device.version if device else "",
                self.place.processor or (device.name if device else ""), self.form, scene, verdict,
                "" if seconds is None else f"{seconds:.0f}")


def run(place, command, **options):
    """Runs the program in a place; PoCL keeps what it compiles for a place to itself."""
    cache = ROOT / "build/portability/pocl" / place.name
    cache.mkdir(parents=True, exist_ok=True)
    # The machine's own drivers, but for what the place says.
    own = {name: value for name, value in os.environ.items() if name != "OCL_ICD_FILENAMES"}
    return subprocess.run([*place.prefix, *map(str, command)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=LONGEST, cwd=ROOT,
                          env=own | {"POCL_CACHE_DIR": str(cache)} | place.environment, **options)


def list_devices(place, program):
    listed = run(place, [program, "devices"]).stdout
    devices = []
    for block in re.finditer(r"^(\d+): (.*)\n((?:[ \t].*\n?)*)", listed, re.MULTILINE):
        # Type, platform, OpenCL's version, that of OpenCL C, driver.
        facts = [fact.strip() for fact in block[3].split("\n")[0].split(",")]
        devices.append(Device(int(block[1]), block[2].removesuffix("  (default)"), facts[1],
                              facts[-1].removeprefix("driver "), "cannot render" not in block[3]))
    return devices


def own_places(program):
    """One for every device of the machine by itself."""
    names = []
    for device in list_devices(Place("own"), program):
        short = "pocl" if device.platform.startswith("Portable") else device.platform.split()[0]
        names.append("own-" + re.sub(r"[^a-z0-9]+", "", short.lower()))
        number = names.count(names[-1])
        yield Place(names[-1] + (str(number) if number > 1 else ""), device=device,
                    missing="" if device.usable else "the program says that it cannot render")


def emulated_places():
    for processor in EMULATED:
        missing = ""
        if platform.machine() != "x86_64":
            missing = "QEMU runs x86-64 programs here, but this one is not"
        elif not shutil.which("qemu-x86_64"):
            missing = "QEMU is not installed (scripts/install.sh --portability)"
        yield Place(processor.lower(), ("qemu-x86_64", "-cpu", processor), platform="Portable",
                    processor=f"{processor}, emulated", slow=True, missing=missing)


def own_processor():
    """Its model and its features."""
    text = pathlib.Path("/proc/cpuinfo").read_text()
    model = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    features = re.search(r"^flags\s*:(.*)$", text, re.MULTILINE)
    return model[1] if model else platform.machine(), set(features[1].split() if features else ())


def intel_places():
    cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    runtime = pathlib.Path(cache) / "manylight/intel-opencl/lib/libintelocl.so"
    model, features = own_processor()
    for architecture, needed in INTEL.items():
        missing = ""
        if not runtime.exists():
            missing = "Intel's runtime is not installed (scripts/install.sh --tests)"
        elif not needed <= features:
            missing = f"the processor has no {', '.join(sorted(needed - features))}"
        yield Place(f"intel-{architecture}", ("scripts/with-intel.sh",),
                    {"CL_CONFIG_CPU_TARGET_ARCH": architecture}, "Intel",
                    processor=f"{architecture} code on {model}", missing=missing)


def oclgrind_place():
    missing = "" if shutil.which("oclgrind") else "not installed (scripts/install.sh --portability)"
    return Place("oclgrind", ("oclgrind",), platform="Oclgrind", processor="interpreted", slow=True,
                 missing=missing)


def find_device(place, program):
    """The place's device; the first one of its platform where it is not known yet."""
    if not place.device:
        found = [d for d in list_devices(place, program) if place.platform in d.platform]
        place.device = found[0] if found else None
    return place.device


def verify(row, program, scene, width):
    """Verifies on a row's device; returns whether all is right, and what was printed."""
    form = [] if row.form == "auto" else ["--device-form", row.form]
    options = [*form, "--width", width, *scene]
    if row.place.name == "oclgrind":
        # It starts oclgrind itself.
        place = dataclasses.replace(row.place, prefix=())
        done = run(place, ["scripts/oclgrind.sh", "--program", program, *options])
    else:
        done = run(row.place, [program, "verify", "--device", row.place.device.number, *options])
    return done.returncode == 0, done.stdout


def run_row(row, program, scenes, width):
    """The row's lines of the table."""
    place = row.place
    if place.missing:
        return [row.result("", f"skipped: {place.missing}")]
    if not find_device(place, program):
        return [row.result("", "FAIL: no such device is listed")]
    results = []
    for scene in scenes:
        name = scene[0].stem if scene else "built-in"
        start = time.monotonic()
        try:
            passed, text = verify(row, program, scene, width or (16 if place.slow else 40))
            verdict = "pass" if passed else "FAIL"
        except subprocess.TimeoutExpired as late:
            verdict, text = f"FAIL: over {LONGEST} s", (late.stdout or b"").decode()
        log = ROOT / "build/portability" / f"{row.name}-{name}.log"
        log.write_text(text)
        results.append(row.result(name, verdict, time.monotonic() - start))
        print(f"{row.name}, {name}: {verdict} in {results[-1][-1]} s", file=sys.stderr, flush=True)
        if verdict != "pass":
            print(f"see {log}:", *text.splitlines()[-25:], sep="\n", file=sys.stderr, flush=True)
    return results


def print_table(results, markdown):
    lines = [HEADER, *results]
    if markdown:
        lines.insert(1, ("---",) * len(HEADER))
        for line in lines:
            print("|", " | ".join(line), "|")
        return
    widths = [max(map(len, column)) for column in zip(*lines)]
    for line in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def chosen_rows(program, only):
    places = [*own_places(program), *emulated_places(), *intel_places()]
    rows = [Row(place, form) for place in places for form in FORMS]
    rows += [Row(oclgrind_place(), form) for form in FORMS[1:]]  # which says that it is a GPU
    wanted = only.split(",") if only else [""]
    for name in wanted:
        if not any(f"{row.name}-".startswith(name and f"{name}-") for row in rows):
            sys.exit(f"portability: no row is called {name}; --list lists them")
    return [row for row in rows
            if any(f"{row.name}-".startswith(name and f"{name}-") for name in wanted)]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--width", type=int)
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    rows = chosen_rows(program, arguments.only)
    if arguments.list:
        for row in rows:
            print(row.name, f"(skipped: {row.place.missing})" if row.place.missing else "")
        return
    # Where `verify` has no scenes of its own, its help says that a file is required.
    help_text = run(Place("own"), [program, "verify", "--help"]).stdout
    needs_file = re.search(r"^ *file .*REQUIRED", help_text, re.MULTILINE)
    scenes = [(path,) for path in sorted((ROOT / "scenes").glob("*.glb"))] if needs_file else [()]
    job = functools.partial(run_row, program=program, scenes=scenes, width=arguments.width)
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = [line for lines in pool.map(job, rows) for line in lines]
    print_table(results, arguments.markdown)
    verdicts = [line[HEADER.index("verdict")] for line in results]
    if any(verdict.startswith("FAIL") for verdict in verdicts):
        sys.exit(1)
    if "pass" not in verdicts:
        sys.exit(77)


main()
