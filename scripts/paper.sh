#!/usr/bin/env bash
# The paper's experiment: all lights, uniform and the paper's sampler on its two scenes; a table in
# the form of its table 1, and the pictures of its figures 3 to 5, in build/paper/.
#
# usage: scripts/paper.sh [--mesh FILE] [--device D] [--rounds N]
#   --mesh FILE  glTF mesh for the dragon's room (default: the procedural object)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
command -v python3 >/dev/null || scripts/install.sh --tests --no-intel
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec python3 scripts/paper.py "$@"
