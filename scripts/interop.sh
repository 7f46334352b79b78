#!/usr/bin/env bash
# Renders scenes that Blender made and exported in Blender's Cycles and in manylight, and compares
# the images. Installs Blender as a Python module (520 MB, into ~/.cache/manylight). Takes about
# 10 minutes.
#
# usage: scripts/interop.sh [--only NAME,...] [--samples N]
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install.sh
venv=${XDG_CACHE_HOME:-$HOME/.cache}/manylight/blender
if [[ ! -e $venv/installed ]]; then
    # Blender 4.2 is built for Python 3.11, which is Debian 12's; and it links to these.
    packages=(python3-venv libxrender1 libxxf86vm1 libxi6 libxfixes3 libxkbcommon0 libsm6 libgl1
        libegl1)
    as_root=()
    (($(id -u) == 0)) || as_root=(sudo)
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends \
        "${packages[@]}" >/dev/null
    echo "installing Blender into $venv"
    rm -rf "$venv"
    /usr/bin/python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check bpy==4.2.0
    touch "$venv/installed"
fi
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec "$venv/bin/python" scripts/interop.py "$@"
