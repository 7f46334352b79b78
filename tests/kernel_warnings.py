# SPDX-License-Identifier: MIT
"""Compiles every kernel file with all warnings of a second front end, features on and off.

usage: kernel_warnings.py CLANG KERNELS
"""
import pathlib
import subprocess
import sys

clang, kernels = sys.argv[1], pathlib.Path(sys.argv[2])
files = sorted(p for p in kernels.rglob("*.cl"))
features = ["POINT", "SPOT", "DIRECTIONAL", "ORIENTED", "TRIANGLE", "QUAD", "GGX", "SMOOTH",
            "EMISSION", "REFLECTIONS", "REGIONS", "TEXTURES", "TANGENTS", "COLORS", "ALPHA",
            "REFLECTANCE", "INSTANCES", "SPECULAR_MAPS"]
failed = 0
for file in files:
    for width in (4, 8, 16):
        for on in (0, 1):
            command = [clang, "-x", "cl", "-cl-std=CL1.2", "-Xclang", "-finclude-default-header",
                       "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function",
                       "-Wno-unused-parameter", f"-I{kernels}", "-DLOCAL_SIZE=16",
                       f"-DBVH_WIDTH={width}", f"-DBVH_BLOCK={width}", "-DBVH_STACK=64"]
            command += [f"-DHAS_{name}={on}" for name in features]
            run = subprocess.run(command + [str(file)], capture_output=True, text=True)
            if run.returncode != 0:
                failed += 1
                print(f"{file} (width {width}, features {'on' if on else 'off'}):\n{run.stderr}")
print(f"{len(files) * 6 - failed} passed, {failed} failed")
sys.exit(failed != 0)
