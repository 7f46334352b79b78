#!/usr/bin/env bash
# The failure atlas: sweeps one difficulty at a time, from harmless to hopeless, and charts every
# sampler at each value: build/atlas/atlas.json, heat maps, and pictures of where each sampler
# breaks. On 2 cores it takes about 16 minutes. What is charted is kept: an interrupted atlas goes
# on where it was.
#
# usage: scripts/atlas.sh [--only NAME,...] [--again] [--draw] [--list] [--table] [OPTION...]
#   --only NAME,...  some of the sweeps; the heat maps show all that are charted
#   --again          chart them again
#   --draw           chart nothing: draw what is charted
#   --list           list the sweeps
#   --table          print the sweeps of the built-in scenes as a table for docs/scenes.md
#   OPTION...        of manylight chart, for all: --device D, --seeds N, --most-seconds N, ...
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --plots
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec /usr/bin/python3 scripts/atlas.py "$@"
