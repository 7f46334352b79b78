# SPDX-License-Identifier: MIT
"""Compiles every kernel file with all warnings of a second front end, for many targets and options.

usage: kernel_warnings.py CLANG KERNELS

Options are varied as far as a file, with all that it includes, mentions them. Every target gets
every form that differs for it, with all features; every form without features, each feature alone,
all but each, and lanes that differ from the BVH's width take one target each.

No function may take or return a vector wider than the registers of a processor of that form: unless
the driver inlines it, how such a vector travels depends on the processor, and some refuse.
"""
import concurrent.futures
import itertools
import os
import pathlib
import re
import subprocess
import sys

# What a device may be given.
FORMS = {
    "gpu": {"LANES": 1, "BVH_WIDTH": 4, "BVH_BLOCK": 4, "LOCAL_SIZE": 64},
    "4": {"LANES": 4, "BVH_WIDTH": 4, "BVH_BLOCK": 4, "LOCAL_SIZE": 16},
    "8": {"LANES": 8, "BVH_WIDTH": 8, "BVH_BLOCK": 8, "LOCAL_SIZE": 16},
    "16": {"LANES": 16, "BVH_WIDTH": 16, "BVH_BLOCK": 16, "LOCAL_SIZE": 16},
}
# Processors of one architecture differ in the code for their own form only.
TARGETS = {
    "x86_64": ([], list(FORMS)),
    "nehalem": (["--target=x86_64", "-march=nehalem"], ["4"]),
    "haswell": (["--target=x86_64", "-march=haswell"], ["8"]),
    "znver3": (["--target=x86_64", "-march=znver3"], ["8"]),
    "skylake-avx512": (["--target=x86_64", "-march=skylake-avx512"], ["16"]),
    "aarch64": ([], list(FORMS)),
    "spir64": ([], list(FORMS)),
    "nvptx64": ([], list(FORMS)),
    "amdgcn": ([], list(FORMS)),
}
# Functions of libraries are used by some files only, and parameters by some features. Calls of
# built-in functions with wide vectors are the driver's affair; those of the kernels' own are judged
# below.
COMMAND = ["-x", "cl", "-cl-std=CL1.2", "-Xclang", "-finclude-default-header", "-Xclang",
           "-fdeclare-opencl-builtins", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function",
           "-Wno-unused-parameter", "-Wno-psabi", "-S", "-emit-llvm", "-Xclang",
           "-disable-llvm-passes", "-o", "-", "-DBVH_STACK=64"]
BITS = {"half": 16, "float": 32, "double": 64}  # of LLVM's types that do not say so


def closure(path, kernels, seen):
    """The text of a file and of all that it includes."""
    if path in seen:
        return ""
    seen.add(path)
    text = path.read_text()
    included = re.findall(r'^\s*#\s*include\s+"([^"]+)"', text, re.MULTILINE)
    return text + "".join(closure(kernels / name, kernels, seen) for name in included)


def choices(features):
    """All features and none; then each alone, and all but each."""
    plain = [dict.fromkeys(features, 1), dict.fromkeys(features, 0)]
    single = [{name: int((name == one) == alone) for name in features}
              for one in features for alone in (True, False)]
    return plain, single


def combinations(text):
    """Pairs of a target and the options that a text mentions and does not define, none twice."""
    words = set(re.findall(r"\w+", text)) - set(re.findall(r"#\s*define\s+(\w+)", text))
    plain, single = choices(sorted(w for w in words if re.fullmatch(r"HAS_[A-Z_]*[A-Z]", w)))
    every = [(target, FORMS[form]) for target, (_, forms) in TARGETS.items() for form in forms]
    wanted = [(*place, plain[0]) for place in every]
    wanted += [("x86_64", form, plain[1]) for form in FORMS.values()]
    wanted += [(*place, chosen) for place, chosen in zip(itertools.cycle(every), single)]
    mixed = ({**a, "LANES": b["LANES"]} for a, b in itertools.permutations(FORMS.values(), 2))
    wanted += [(target, form, plain[0]) for target, form in zip(itertools.cycle(TARGETS), mixed)]
    known = {}
    for target, form, chosen in wanted:
        options = {name: value for name, value in (form | chosen).items() if name in words}
        known[(target, *options.items())] = target, options
    return known.values()


def vector_bits(signature):
    """The widest vector that a signature of LLVM's holds by value."""
    return max((int(count) * (BITS.get(kind) or int(kind[1:])) for count, kind
                in re.findall(r"<(\d+) x (\w+)>(?! addrspace|\*)", signature)), default=0)


def wide_functions(text, register):
    """Functions that pass vectors wider than a register, in LLVM's code for SPIR, which keeps the
    source's signatures."""
    inlined = set(re.findall(r"^attributes (#\d+) = \{.*\balwaysinline\b", text, re.MULTILINE))
    for signature, name, attributes in re.findall(r"^define internal (.*?@(\w+)\(.*\)) (.*)\{$",
                                                  text, re.MULTILINE):
        bits = vector_bits(signature)
        if bits > register and inlined.isdisjoint(attributes.split()):
            yield (f"{name}() takes or returns a vector of {bits} bits by value, where a register "
                   f"has {register}\n")


def check(clang, kernels, file, target, options):
    """Compiles a file; returns what is wrong."""
    arguments = TARGETS[target][0] or [f"--target={target}"]
    run = subprocess.run([clang, *COMMAND, *arguments, f"-I{kernels}", str(file),
                          *(f"-D{name}={value}" for name, value in options.items())],
                         capture_output=True, text=True)
    problems = run.stderr
    if run.returncode == 0 and target == "spir64":
        lanes = max(4, options.get("LANES", 1), options.get("BVH_WIDTH", 1))
        problems += "".join(wide_functions(run.stdout, 32 * lanes))
    if run.returncode == 0 and not problems:
        return ""
    shown = " ".join(f"{name}={value}" for name, value in options.items())
    return f"{file} ({target}; {shown}):\n{problems}"


def main(clang, kernels):
    jobs = [(clang, kernels, file, target, options) for file in sorted(kernels.rglob("*.cl"))
            for target, options in combinations(closure(file, kernels, set()))]
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        failures = [text for text in pool.map(lambda job: check(*job), jobs) if text]
    print(*failures, sep="\n")
    print(f"{len(jobs) - len(failures)} passed, {len(failures)} failed")
    sys.exit(bool(failures) or not jobs)


main(sys.argv[1], pathlib.Path(sys.argv[2]))
