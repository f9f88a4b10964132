#!/bin/sh
# The image's root file system without a container engine: `rootfs.sh DIR`, as root. A bare Debian 12 by mmdebstrap, then what the
# Containerfile does, by the same setup.sh. Takes minutes; DIR must not exist.
set -eu
root="${1:?usage: rootfs.sh DIR}"
cd "$(dirname "$0")/../.."
if [ -e "$root" ]; then
    echo "rootfs: $root is there already" >&2
    exit 1
fi
if ! command -v mmdebstrap >/dev/null 2>&1; then
    echo "rootfs: installing mmdebstrap" >&2
    apt-get install -y -q --no-install-recommends mmdebstrap >/dev/null
fi
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
[ -x "$program" ] || cargo build --release --package skyglow

mkdir -p "$(dirname "$root")"
echo "rootfs: a bare Debian in $root" >&2
mmdebstrap --quiet --variant=minbase bookworm "$root"
# Inside, the same sources as here: mirrors and proxies of the host.
cp deploy/container/setup.sh "$root/setup.sh"
cp /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || true
cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
chroot "$root" sh /setup.sh >"$root/setup.log" 2>&1 || {
    tail -20 "$root/setup.log" >&2
    exit 1
}
rm "$root/setup.sh" "$root/setup.log"
install -m 755 "$program" "$root/usr/local/bin/skyglow"
strip "$root/usr/local/bin/skyglow" 2>/dev/null || true
cp precomputed/*.json precomputed/*.skyglow "$root/usr/local/share/skyglow/precomputed/"
install -m 644 deploy/skyglow.toml "$root/etc/skyglow/skyglow.toml"
echo "rootfs: $(du -sm "$root" | cut -f1) MB in $root" >&2
