#!/usr/bin/env bash
# Installs what is missing, builds, and renders the Cornell box with all lights, with the paper's
# sampler and with the default one, side by side.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
mkdir -p build/demo
for sampler in exhaustive contribution adaptive; do
    echo
    build/manylight render scenes/cornell.glb --sampler $sampler --exposure 0 \
        -o build/demo/$sampler.png -o build/demo/$sampler.exr
done
for sampler in contribution adaptive; do
    echo "$sampler: $(build/manylight compare build/demo/$sampler.exr build/demo/exhaustive.exr)"
done
oiiotool build/demo/exhaustive.png build/demo/contribution.png build/demo/adaptive.png \
    --mosaic:pad=4 3x1 \
    -o build/demo/side-by-side.png
echo
echo "all lights:               build/demo/exhaustive.png"
echo "the paper's sampler:      build/demo/contribution.png"
echo "the default:              build/demo/adaptive.png"
echo "side by side:             build/demo/side-by-side.png"
