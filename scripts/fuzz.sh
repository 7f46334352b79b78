#!/usr/bin/env bash
# Loads mutations of the scenes in tests/fuzz/corpus under ASan and UBSan until one crashes, takes
# longer than 2 s or asks for more memory than a file may. Needs clang-15.
#
# usage: scripts/fuzz.sh [RUNS]
#   RUNS  inputs to try (default: 1,000,000: about 40 minutes)
set -euo pipefail
cd "$(dirname "$0")/.."
runs=${1:-1000000}

scripts/install.sh --tests --no-intel
cmake -G Ninja -B build/fuzz -DMANYLIGHT_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++-15 \
    >/dev/null
cmake --build build/fuzz --target fuzz_scene
mkdir -p build/fuzz/found build/fuzz/corpus
cd build/fuzz
# Disks take longer to write a file than it takes to load.
[[ -w /dev/shm ]] && export TMPDIR=/dev/shm
export ASAN_OPTIONS=quarantine_size_mb=16:allocator_may_return_null=0
export LSAN_OPTIONS=suppressions=../../tests/leaks.supp:print_suppressions=0
exec ./fuzz_scene corpus ../../tests/fuzz/corpus -runs="$runs" -timeout=2 -malloc_limit_mb=260 \
    -rss_limit_mb=2048 -max_len=16384 -artifact_prefix=found/ -print_final_stats=1
