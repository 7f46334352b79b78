#!/usr/bin/env bash
# What reflected rays are worth: the error of the built-in plates with and without them, and
# docs/images/plates.jpg, without on the left.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
folder=build/reflections
mkdir -p $folder
build/manylight scene plates -o $folder/plates.glb
render() {
    build/manylight render $folder/plates.glb --quiet --height 270 --hide-emitters \
        --pixel-centre "$@"
}
render --sampler exhaustive --spp 400 --seed 999 -o $folder/reference.exr
for sampler in uniform power lighttree contribution-defensive adaptive; do
    for option in --no-reflections ""; do
        for seed in 1 2 3; do
            render --sampler $sampler --light-samples 4 --spp 4 --seed $seed $option \
                -o $folder/image.exr
            echo "$sampler ${option:-with reflected rays}, seed $seed: $(build/manylight compare \
                $folder/image.exr $folder/reference.exr)"
        done
    done
done
for option in --no-reflections ""; do
    build/manylight render $folder/plates.glb --quiet --height 270 --exposure 1.5 $option \
        -o $folder/plates$option.png
done
oiiotool $folder/plates--no-reflections.png $folder/plates.png --mosaic:pad=4 2x1 \
    --compression jpeg:88 -o docs/images/plates.jpg
