#!/usr/bin/env bash
# Renders scenes with every sampler by two builds of the program, and compares the images bit for
# bit. Exits with 1 where one differs.
#
# usage: scripts/same_images.sh OLD NEW [SCENE ...]
#   OLD, NEW  programs
#   SCENE     glTF files (default: those in scenes/)
set -euo pipefail
cd "$(dirname "$0")/.."

old=$(realpath "${1:?which program was before}")
new=$(realpath "${2:?which program is to make the same images}")
shift 2
(($# > 0)) || set -- scenes/*.glb
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
differing=0
samplers=$("$new" samplers | cut -d' ' -f1)
hash_of() { oiiotool -v --hash "$1" | grep SHA-1; }

for scene in "$@"; do
    for sampler in $samplers; do
        for options in "" "--pixel-centre --light-samples 5" "--target-error 0.5 --memory 24M"; do
            common=(render "$scene" --height 40 --spp 6 --sampler "$sampler" --seed 3 -q)
            read -ra more <<<"$options"
            "$old" "${common[@]}" "${more[@]}" -o "$folder/old.exr" 2>"$folder/log" ||
                { cat "$folder/log" >&2; exit 2; }
            "$new" "${common[@]}" "${more[@]}" -o "$folder/new.exr" 2>"$folder/log" ||
                { cat "$folder/log" >&2; exit 2; }
            before=$(hash_of "$folder/old.exr")
            after=$(hash_of "$folder/new.exr")
            if [[ "$before" != "$after" ]]; then
                echo "$scene, $sampler $options: other pixels"
                differing=1
            fi
            rm "$folder"/*.exr
        done
    done
    echo "$scene: compared"
done
exit $differing
