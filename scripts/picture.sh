#!/usr/bin/env bash
# README's picture: the built-in rooms by three samplers, in docs/images/rooms.jpg.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
mkdir -p build/picture
build/manylight scene rooms -o build/picture/rooms.glb
for sampler in power lighttree adaptive; do
    build/manylight render build/picture/rooms.glb --height 270 --exposure 1.2 --sampler $sampler \
        -o build/picture/$sampler.png
done
oiiotool build/picture/power.png build/picture/lighttree.png build/picture/adaptive.png \
    --mosaic:pad=4 3x1 --compression jpeg:88 -o docs/images/rooms.jpg
