#!/usr/bin/env bash
# Verifies all kernels on every processor and driver that can be had here, and prints one table: the
# machine's own devices; PoCL on processors that QEMU emulates; Intel's CPU runtime compiling for
# older processors; Oclgrind; each with the code that a GPU gets and with vectors of 4, 8, 16 lanes.
# The first run compiles under emulation and takes about an hour on 2 cores; progress is printed.
#
# usage: scripts/portability.sh [--only ROW,...] [--list] [--markdown] [--jobs N] [--width N]
#   --only ROW,...  rows, or beginnings of their names: haswell, intel-corei7-8, ...
#   --list          list the rows
#   --markdown      print the table for docs/portability.md
#   --jobs N        rows at a time (default: 1)
#   --width N       of the images (default: 40; 16 where the processor is emulated)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --portability >&2
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight >&2
exec python3 scripts/portability.py build/manylight "$@"
