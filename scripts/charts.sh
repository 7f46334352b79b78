#!/usr/bin/env bash
# Charts of the six built-in scenes of many lights, every sampler: build/charts/NAME/report.html.
#
# usage: scripts/charts.sh [--only NAME,...] [OPTION...]
#   --only NAME,...  some of the scenes (default: cornell,dragon,rooms,city,glossy,blinds)
#   OPTION...        of manylight chart, for all scenes: --device D, --seeds N, ...
# Then build/charts/errors.png, error against time of all, and a table (scripts/charts.py).
# Images have half the scene's usual size; city, of which exhaustive draws all 100,000 lights, a
# quarter. On 2 cores it takes less than an hour. References get two minutes each and are kept
# between runs, which makes them better; --most-seconds is 120, see manylight chart --help.
set -euo pipefail
cd "$(dirname "$0")/.."

names=cornell,dragon,rooms,city,glossy,blinds
if [[ ${1:-} == --only ]]; then
    names=${2:?--only needs names}
    shift 2
fi
[[ " $* " == *" --seeds "* ]] || set -- "$@" --seeds 3
[[ " $* " == *" --reference-time "* ]] || set -- "$@" --reference-time 120
[[ " $* " == *" --most-seconds "* ]] || set -- "$@" --most-seconds 120
scripts/install.sh --plots
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
mkdir -p build/charts
for name in ${names//,/ }; do
    height=180
    case $name in
        cornell | dragon) height=256 ;;
        city) height=90 ;;
    esac
    build/manylight scene "$name" -o "build/charts/$name.glb"
    build/manylight chart "build/charts/$name.glb" --height $height \
        -o "build/charts/$name" "$@"
done
/usr/bin/python3 scripts/charts.py
