#!/usr/bin/env bash
# Runs every kernel under Oclgrind, which interprets them and sees each access out of bounds and
# each data race between work-items, whatever the hardware. Takes minutes.
#
# usage: scripts/oclgrind.sh [--program FILE] [OPTION ...] [SCENE ...]
#   --program FILE  the program (default: builds build/manylight)
#   OPTION ...      of manylight verify: --device-form F, --width N (default: 16), ...
#   SCENE ...       glTF files (default: the built-in scenes of manylight verify)
set -euo pipefail
cd "$(dirname "$0")/.."

program=
options=()
scenes=()
while (($# > 0)); do
    case $1 in
        --program) program=${2:?--program needs a file}; shift 2 ;;
        --*) options+=("$1" "${2:?$1 needs a value}"); shift 2 ;;
        *) scenes+=("$1"); shift ;;
    esac
done
if [[ -z $program ]]; then
    scripts/install.sh --portability --no-intel
    cmake -G Ninja -B build >/dev/null
    cmake --build build --target manylight
    program=build/manylight
fi
[[ " ${options[*]} " == *" --width "* ]] || options+=(--width 16)
((${#scenes[@]} > 0)) || scenes=("")

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
for scene in "${scenes[@]}"; do
    echo "oclgrind: ${scene:-built-in scenes}, ${options[*]}"
    # Oclgrind exits with 0 whatever it finds. It does not know llvm.bitreverse, which optimizing
    # makes of random.h; and unoptimized code hides no access.
    oclgrind --log "$folder/log" --data-races --build-options -cl-opt-disable \
        "$program" verify ${scene:+"$scene"} "${options[@]}" >"$folder/out" 2>&1 || {
        failed=1
        cat "$folder/out"
    }
    grep -q "Oclgrind Simulator" "$folder/out" || { failed=1; echo "Oclgrind was not the device"; }
    if [[ -s $folder/log ]]; then
        failed=1
        head -60 "$folder/log"
    fi
done
((failed == 0)) && echo "no access out of bounds, no race"
exit $failed
