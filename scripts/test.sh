#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests.
#
# usage: scripts/test.sh [--no-intel]
#   --no-intel  only on the machine's own OpenCL drivers, without Intel's runtime (830 MB)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh --tests "$@"
cmake -G Ninja -B build -DMANYLIGHT_TESTS=ON -DMANYLIGHT_SANITIZE=ON \
    -DMANYLIGHT_WERROR="${CI:-OFF}" >/dev/null
cmake --build build
run=(scripts/with-intel.sh)
if [[ " $* " == *" --no-intel "* ]]; then
    run=()
fi
"${run[@]}" ctest --test-dir build --parallel 2 --output-on-failure
