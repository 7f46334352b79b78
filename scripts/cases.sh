#!/usr/bin/env bash
# Renders small scenes that brought out faults and compares each with its expected value: a folder
# of cases, which is not part of the project. Prints a line each; exits nonzero where one is wrong.
#
# usage: scripts/cases.sh FOLDER [--only TEXT]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --cases
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec /usr/bin/python3 scripts/cases.py build/manylight "$@"
