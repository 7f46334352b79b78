#!/usr/bin/env bash
# How much better is sampler adaptive than others? Tables over scenes:
#   worth        its error and a light tree's with the same 4 light samples, and in the time that
#                the light tree takes for 16
#   never-worse  the largest ratio of its error to that of the best other sampler in the same time
#   overhead     what part of a frame with 16 light samples is neither their shading nor their rays
#   few-lights   error x time of all lights at each pixel sample, and of 4 light samples
#   scale        the time of a frame with 1,000 to 1,000,000 lights, and the memory of the latter
#
# usage: scripts/samplers.sh [--table NAME] [--scenes FOLDER] [--only NAME,...] [--seeds N]
#                            [--device D]
#   --scenes FOLDER  glTF scenes (default: the six built-in ones of many lights)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
command -v python3 >/dev/null || scripts/install.sh --tests --no-intel
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec python3 scripts/samplers.py "$@"
