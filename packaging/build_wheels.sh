#!/bin/sh
# Builds the source distribution and the wheels of what is committed here, and tries each in a bare system:
#
#     packaging/build_wheels.sh [FOLDER]          default: dist; docs/releasing.md has the whole way to a release
#
# Every step runs in a Debian of its own, unpacked afresh: one with a compiler, and for each wheel one that
# has Python and nothing else. The packed systems are kept in DOSEKI_ROOTS (default: .tools/roots), a compiler's
# cache in DOSEKI_CCACHE if that is set. DOSEKI_MIRROR is where Debian comes from. Needs root, git and mmdebstrap.
set -eu

root=$(dirname "$(dirname "$(readlink -f "$0")")")
packaging=$root/packaging
output=$(readlink -m "${1:-$root/dist}")
roots=$(readlink -m "${DOSEKI_ROOTS:-$root/.tools/roots}")

builder_suite=bookworm # g++ 12
old_suite=bullseye     # its C library and libgomp are what modules are linked against
python_suite=trixie    # its Python is built for the wheel of Python 3.12 and later, and tries that wheel

. "$packaging/systems.sh"

make_systems() {
    make_system builder "$builder_suite" apt \
        g++ make ccache git python3-dev python3-venv zlib1g-dev xz-utils dpkg-dev ca-certificates
    make_system old "$old_suite" extract libc6-dev libgomp1
    make_system "bare-$builder_suite" "$builder_suite" apt python3-venv ca-certificates
    make_system "bare-$python_suite" "$python_suite" apt python3-venv ca-certificates
    [ -f "$roots/python.tar" ] || make_python
}

# A Python of 3.12 or later in /opt/python of the builder, from Debian's sources: Debian 12 has none.
make_python() {
    say "compiling the Python of $python_suite ..."
    unpack builder
    DOSEKI_SUITE=$python_suite run_inside "$packaging/inside/python.sh"
    tar -C "$system" -cf "$roots/python.tar.new" opt/python
    mv "$roots/python.tar.new" "$roots/python.tar"
    discard
}

# Makes the source distribution and the wheels.
build() {
    say "building ..."
    unpack builder
    tar -xf "$roots/python.tar" -C "$system"
    mkdir -p "$system/old" "$system/out"
    tar -xf "$roots/old.tar" -C "$system/old"
    keep_links_within "$system/old"
    printf '[safe]\n\tdirectory = *\n' >"$system/gitconfig" # the clone may be another user's, and git asks
    GIT_CONFIG_GLOBAL=$system/gitconfig git clone -q --no-local "$root" "$system/source"
    cp -r "$packaging" "$system/packaging"
    [ -z "${DOSEKI_CCACHE:-}" ] || share "$DOSEKI_CCACHE" /ccache
    run_inside "$packaging/inside/build.sh"
    mkdir -p "$made"
    cp "$system"/out/doseki-* "$made"
    discard
}

# check SUITE TAG: the wheel with that tag is installed and used in a system without a compiler.
check() {
    say "trying the wheel $2 in $1 without a compiler ..."
    unpack "bare-$1"
    mkdir "$system/dist"
    cp "$made"/doseki-*.tar.gz "$made"/doseki-*-"$2"-*.whl "$packaging/start_up.py" "$system/dist"
    run_inside "$packaging/inside/check.sh"
    discard
}

# The recipes for containers, in a system of their own: no daemon is needed.
check_image() {
    say "trying the recipe of the images ..."
    unpack "bare-$builder_suite"
    mkdir "$system/dist"
    cp "$made"/doseki-*-cp311-*.whl "$packaging/image/install.sh" "$system/dist"
    run_inside "$packaging/inside/check_image.sh"
    discard
}

[ "$(id -u)" = 0 ] || fail "this needs root, which makes systems of their own"
command -v mmdebstrap >/dev/null || fail "mmdebstrap is missing; on Debian: apt-get install mmdebstrap"
[ ! -d "$output" ] || [ -z "$(ls -A "$output")" ] || fail "$output is not empty"
mkdir -p "$roots"
made=$(mktemp -d "$roots/made.XXXXXX")
trap 'discard; rm -rf "$made"' EXIT
trap 'exit 1' HUP INT TERM
make_systems
build
check "$builder_suite" cp311
check "$python_suite" abi3
check_image
mkdir -p "$output"
mv "$made"/* "$output"
say "all is well; in $output:"
ls -l "$output" >&2
