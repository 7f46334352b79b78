#!/usr/bin/env bash
# Runs a command with Intel's OpenCL runtime, as scripts/install.sh --tests installed it, beside the
# machine's own drivers. Where it is not installed, the command runs without it.
#
# usage: scripts/with-intel.sh COMMAND [ARGUMENT ...]
set -euo pipefail

library=${XDG_CACHE_HOME:-$HOME/.cache}/manylight/intel-opencl/lib
if [[ -e $library/libintelocl.so ]]; then
    export LD_LIBRARY_PATH=$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
    export OCL_ICD_FILENAMES=$library/libintelocl.so
fi
exec "$@"
