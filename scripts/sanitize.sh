#!/usr/bin/env bash
# Builds all of the program under ASan and UBSan and runs every stage, output and malformed file
# with it; scripts/test.sh does so for what takes input alone.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --tests --no-intel
cmake -G Ninja -B build/sanitized -DMANYLIGHT_TESTS=ON -DMANYLIGHT_SANITIZE=ALL >/dev/null
cmake --build build/sanitized --target manylight_sanitized
ctest --test-dir build/sanitized --output-on-failure -R 'sanitized|malformed'
