#!/usr/bin/env bash
# Installs what is missing, builds, and renders the Cornell box with all lights and with the paper's
# sampler, side by side.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
mkdir -p build/demo
for sampler in exhaustive contribution; do
    echo
    build/manylight render scenes/cornell.glb --sampler $sampler --exposure 0 \
        -o build/demo/$sampler.png -o build/demo/$sampler.exr
done
build/manylight compare build/demo/contribution.exr build/demo/exhaustive.exr
oiiotool build/demo/exhaustive.png build/demo/contribution.png --mosaic:pad=4 2x1 \
    -o build/demo/side-by-side.png
echo
echo "all lights:               build/demo/exhaustive.png"
echo "4 light samples:          build/demo/contribution.png"
echo "both:                     build/demo/side-by-side.png"
