#!/usr/bin/env bash
# What the parameters of sampler adaptive (kernels/shared/adaptive.h) are worth: the error and the
# seconds of renders with other values of one, over those with its own, geometric means over the
# built-in scenes. A copy of the project is built anew for every value.
#
# usage: scripts/parameters.sh [NAME ...]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh >/dev/null
folder=build/parameters
names=("$@")
declare -A values=(
    [PROBE_RAYS]="2 8" [INHERITED]="0.25f 1.0f" [PRIOR_SHARE]="0.5f 0.9f" [SLOT_GROUP]="4 16"
    [PARENT_RAYS]="4.0f 16.0f" [SIGHT_RAYS]="0.5f 2.0f" [MOST_LENT]="4.0f 64.0f"
    [LEAST_VISIBILITY]="0.0001f 0.0025f" [SEEN_RAYS]="0.2f 1.0f"
    [HIDDEN_VISIBILITY]="0.002f 0.03f" [HIDDEN_SHARE]="0.1f 0.5f" [GROUP_VARIANCE]="0.25f 1.0f"
    [PIXEL_VARIANCE]="0.001f 0.016f" [REFINED_SHARE]="0.125f 0.5f" [MOST_SPLITS]="32 128"
    [CONTROL]="0.7f 0.9f" [FEWEST_DRAWS]="0.125f 0.5f" [MOST_DRAWS]="4.0f 16.0f")
for name in "${names[@]}"; do
    [[ -n "${values[$name]:-}" ]] || { echo "$name is none of: ${!values[*]}" >&2; exit 2; }
done
[[ ${#names[@]} -gt 0 ]] || mapfile -t names < <(printf '%s\n' "${!values[@]}" | sort)

rm -rf $folder/source
mkdir -p $folder/source
git ls-files -z | xargs -0 cp --parents -t $folder/source
header=$folder/source/kernels/shared/adaptive.h
cp $header $folder/adaptive.h
build() {
    cmake -G Ninja -S $folder/source -B $folder/build >/dev/null
    cmake --build $folder/build --target manylight >/dev/null
}

build
scenes=(cornell blinds glossy rooms)
options=(--quiet --height 96 --hide-emitters --pixel-centre)
for scene in "${scenes[@]}"; do
    [[ -e $folder/$scene.glb ]] || $folder/build/manylight scene "$scene" -o $folder/"$scene".glb
    [[ -e $folder/$scene.exr ]] || $folder/build/manylight render $folder/"$scene".glb \
        "${options[@]}" --sampler exhaustive --spp 64 --seed 999 -o $folder/"$scene".exr
done
# relMSE and seconds of a scene, means of three seeds.
measure() {
    for seed in 1 2 3; do
        $folder/build/manylight render $folder/"$1".glb "${options[@]}" --sampler adaptive \
            --light-samples 4 --spp 4 --seed $seed -o $folder/image.exr --stats $folder/stats.json
        $folder/build/manylight compare --json $folder/image.exr $folder/"$1".exr \
            >$folder/error.json
        python3 -c "import json
error = json.load(open('$folder/error.json'))
print(error['relmse'], json.load(open('$folder/stats.json'))['seconds']['render'])"
    done | awk '{ error += $1; time += $2 } END { print error / NR, time / NR }'
}
for scene in "${scenes[@]}"; do
    measure "$scene" >/dev/null  # compiles the kernels
    measure "$scene" >$folder/"$scene".own
done
echo "parameter          value    error   time"
for name in "${names[@]}"; do
    for value in ${values[$name]}; do
        sed "s/^#define $name .*/#define $name $value/" $folder/adaptive.h >$header
        build
        for scene in "${scenes[@]}"; do
            measure "$scene" >/dev/null
            measure "$scene" | paste - $folder/"$scene".own
        done | awk -v name="$name" -v value="$value" \
            '{ error += log($1 / $3); time += log($2 / $4) }
             END { printf "%-18s %-8s %.3f  %.3f\n", name, value, exp(error / NR), exp(time / NR) }'
    done
done
