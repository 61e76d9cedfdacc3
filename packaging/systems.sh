# Systems of their own, for build_wheels.sh: packed in $roots, unpacked into $system, one at a time.

system=

say() { printf 'wheels: %s\n' "$*" >&2; }

fail() {
    say "$@"
    exit 1
}

# make_system NAME SUITE VARIANT PACKAGE...: packs a Debian, unless it is there.
make_system() {
    name=$1 suite=$2 variant=$3
    shift 3
    [ ! -f "$roots/$name.tar" ] || return 0
    say "making the system $name of $suite ..."
    mkdir -p "$roots"
    packages=$(printf '%s,' "$@")
    mmdebstrap --quiet --variant="$variant" --components=main --include="${packages%,}" \
        "$suite" "$roots/$name.new.tar" ${DOSEKI_MIRROR:+"$DOSEKI_MIRROR"}
    mv "$roots/$name.new.tar" "$roots/$name.tar"
}

# keep_links_within FOLDER: links of an unpacked system that begin at the root lead to its own files.
keep_links_within() (
    cd "$1"
    find . -lname '/*' | while read -r link; do
        ln -sfn "$(realpath -ms --relative-to="$(dirname "$link")" ".$(readlink "$link")")" "$link"
    done
)

# unpack NAME: a fresh copy of a packed system, with the network settings of this one.
unpack() {
    system=$(mktemp -d "$roots/$1.XXXXXX")
    chmod 755 "$system"
    tar -xf "$roots/$1.tar" -C "$system"
    mkdir -p -m 1777 "$system/dev/shm"
    cp -L /etc/resolv.conf "$system/etc/resolv.conf"
    certificates=/etc/ssl/certs/ca-certificates.crt
    [ ! -f "$certificates" ] || cp -L "$certificates" "$system$certificates"
    mount -t proc proc "$system/proc"
    # Its own terminals: a test closes one.
    mkdir -p "$system/dev/pts"
    mount -t devpts -o newinstance,ptmxmode=0666,mode=0620 devpts "$system/dev/pts"
    ln -sfn pts/ptmx "$system/dev/ptmx"
}

# share FOLDER PLACE: FOLDER of this machine at PLACE of the system.
share() {
    mkdir -p "$1" "$system$2"
    mount --bind "$1" "$system$2"
}

# run_inside SCRIPT: runs SCRIPT in the system, without the environment of this one but for where packages come from.
run_inside() {
    cp "$1" "$system/step.sh"
    env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        SSL_CERT_FILE=/etc/ssl/certs/ca-certificates.crt PIP_CERT=/etc/ssl/certs/ca-certificates.crt \
        UV_SYSTEM_CERTS=1 DOSEKI_SUITE="${DOSEKI_SUITE:-}" \
        ${PIP_INDEX_URL:+PIP_INDEX_URL="$PIP_INDEX_URL" UV_DEFAULT_INDEX="$PIP_INDEX_URL"} \
        ${HTTPS_PROXY:+HTTPS_PROXY="$HTTPS_PROXY"} \
        chroot "$system" /bin/sh -eu /step.sh
}

# Removes the system; nothing of this machine may be mounted in it then.
discard() {
    [ -n "$system" ] || return 0
    for place in proc dev/pts ccache; do
        ! mountpoint -q "$system/$place" || umount "$system/$place" || fail "$system/$place stays mounted"
    done
    rm -rf --one-file-system "$system"
    system=
}
