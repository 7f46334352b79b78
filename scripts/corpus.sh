#!/usr/bin/env bash
# Renders the glTF files that packages of Debian 12 and PyPI ship, of many exporters: downloads the
# packages into a folder (250 MB, unpacked 700 MB; once), and tells what is refused, crashes, takes
# too long or is black. Exits nonzero where that is not expected. Takes about 5 minutes.
#
# usage: scripts/corpus.sh FOLDER [--only TEXT]
set -euo pipefail
folder=$(realpath -m "${1:?usage: scripts/corpus.sh FOLDER [--only TEXT]}")
shift
cd "$(dirname "$0")/.."

# A list of its own: most machines have none of sources.
apt() {
    apt-get -qq -o Dir::Etc::sourcelist="$folder/apt/sources.list" -o Dir::Etc::sourceparts=- \
        -o Dir::State::lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache" \
        -o APT::Sandbox::User="$(id -un)" "$@"
}

list_packages() {
    [[ -e $folder/apt/listed ]] && return
    mkdir -p "$folder"/apt/{lists,cache/archives}/partial
    local mirror
    mirror=$(apt-get indextargets --format '$(CREATED_BY) $(RELEASE) $(COMPONENT) $(REPO_URI)' |
        awk '/^Packages bookworm main / { print $4; exit }')
    for kind in deb deb-src; do
        echo "$kind [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
            "$mirror bookworm main"
    done >"$folder/apt/sources.list"
    apt update
    touch "$folder/apt/listed"
}

# KIND NAME VERSION: unpacks the package to NAME in the folder.
get() {
    local kind=$1 name=$2 version=$3
    [[ -e $folder/$name ]] && return
    echo "downloading $name $version"
    rm -rf "$folder/new"
    mkdir -p "$folder"/new/{archives,files}
    (
        cd "$folder/new/archives"
        case $kind in
            debian)
                list_packages
                apt download "$name=$version"
                dpkg-deb -x ./*.deb ../files
                ;;
            source)
                list_packages
                apt source --download-only "$name=$version"
                tar -xf ./*.orig.tar.* -C ../files
                ;;
            pypi)
                [[ -e $folder/venv ]] || /usr/bin/python3 -m venv "$folder/venv"
                "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps \
                    --only-binary=:all: "$name==$version"
                /usr/bin/python3 -m zipfile -e ./*.whl ../files
                ;;
        esac
    )
    mv "$folder/new/files" "$folder/$name"
    rm -rf "$folder/new"
}

scripts/install.sh --corpus
get debian assimp-testmodels 5.2.5~ds0-1
get source draco 1.5.5+dfsg-2
get source tinygltf 2.7.0+dfsg-2
get pypi genesis-world 1.4.5
get pypi gradio 6.31.0
get pypi mani-skill 3.0.1
get pypi smarts 2.0.1
cmake -G Ninja -B build >/dev/null
cmake --build build --target manylight
exec /usr/bin/python3 scripts/corpus.py build/manylight "$folder" "$@"
