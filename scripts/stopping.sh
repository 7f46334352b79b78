#!/usr/bin/env bash
# Is the estimated error the error? Renders the built-in scenes with many seeds and compares each
# image's estimate with its error against a long render (the table of docs/stopping.md). Slow: a
# quarter of an hour on two quiet cores.
#
# usage: scripts/stopping.sh [--only NAME,...] [--seeds N] [--spp N,...] [--height PIXELS]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
command -v python3 >/dev/null || scripts/install.sh --tests --no-intel
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec python3 scripts/stopping.py "$@"
