#!/usr/bin/env bash
# How much better is sampler adaptive than a light tree? A table over scenes: the error of both with
# the same 4 light samples, and in the time that the light tree takes for 16.
#
# usage: scripts/samplers.sh [--scenes FOLDER] [--only NAME,...] [--seeds N] [--device D]
#   --scenes FOLDER  glTF scenes (default: the six built-in ones of many lights)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
command -v python3 >/dev/null || scripts/install.sh --tests --no-intel
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec python3 scripts/samplers.py "$@"
