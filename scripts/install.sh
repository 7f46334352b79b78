#!/usr/bin/env bash
# Installs what building and running manylight needs on Debian 12; does nothing where all is there.
#
# usage: scripts/install.sh [--tests] [--portability] [--no-intel] [--plots] [--cases] [--corpus]
#   --tests        also what the tests need: GoogleTest, Embree (for manylight bench), Python, Clang
#                  (to lint kernels), clang-format, Oclgrind (which sees accesses out of bounds),
#                  Chromium and Selenium (to click through reports), and Intel's OpenCL runtime for
#                  CPUs, where the processor is x86-64 (830 MB, into ~/.cache/manylight), so that
#                  two vendors' compilers run every kernel
#   --portability  also what scripts/portability.sh needs: QEMU, which runs programs as on other
#                  processors, Oclgrind, Python and Intel's runtime
#   --no-intel     without Intel's runtime
#   --plots        also Matplotlib, which draws the failure atlas and the picture of charts
#   --cases        also what scripts/cases.sh needs: NumPy and OpenImageIO for Python
#   --corpus       also what scripts/corpus.sh needs: these and pip
set -euo pipefail

tests=false
intel=true
portability=false
plots=false
cases=false
corpus=false
for argument in "$@"; do
    case $argument in
        --tests) tests=true ;;
        --no-intel) intel=false ;;
        --portability) portability=true ;;
        --plots) plots=true ;;
        --cases) cases=true ;;
        --corpus) cases=true corpus=true ;;
        *) echo "install.sh: unknown option $argument" >&2; exit 2 ;;
    esac
done

packages=(
    g++ cmake ninja-build
    ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers pocl-opencl-icd
    libopenimageio-dev openimageio-tools libglm-dev libtinygltf-dev nlohmann-json3-dev
    libcli11-dev libfmt-dev libmeshoptimizer-dev libdraco-dev libboost-dev libjs-chart.js
    fonts-dejavu-core
)
if $tests; then
    packages+=(libgtest-dev libembree-dev python3 python3-venv clang-15 clang-format-14
        oclgrind chromium chromium-driver python3-selenium)
fi
if $portability; then
    packages+=(python3 python3-venv oclgrind qemu-user)
fi
if $plots; then
    packages+=(python3 python3-matplotlib)
fi
if $cases; then
    packages+=(python3 python3-numpy python3-openimageio)
fi
if $corpus; then
    packages+=(python3-venv)
fi

missing=()
for package in "${packages[@]}"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
        missing+=("$package")
done
if ((${#missing[@]} > 0)); then
    as_root=()
    if (($(id -u) != 0)); then
        as_root=(sudo)
    fi
    echo "installing: ${missing[*]}"
    "${as_root[@]}" apt-get update -qq
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends \
        "${missing[@]}" >/dev/null
fi

if { $tests || $portability; } && $intel && [[ $(uname -m) == x86_64 ]]; then
    venv=${XDG_CACHE_HOME:-$HOME/.cache}/manylight/intel-opencl
    if [[ ! -e $venv/lib/libintelocl.so ]]; then
        echo "installing Intel's OpenCL runtime into $venv"
        rm -rf "$venv"
        python3 -m venv "$venv"
        "$venv/bin/pip" install --quiet --disable-pip-version-check \
            intel-opencl-rt intel-cmplr-lib-rt
    fi
fi
