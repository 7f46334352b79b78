#!/usr/bin/env bash
# Kills checkpointed renders at 100 random moments and compares what goes on from there with renders
# without a break. Takes about 5 minutes.
#
# usage: scripts/kills.sh [--kills N] [--seed S]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --tests --no-intel
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec python3 tests/kills.py build/manylight scenes --kills 100 "$@"
