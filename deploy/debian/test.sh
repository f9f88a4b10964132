#!/bin/sh
# Installs the package into a bare Debian 12 (mmdebstrap, as root), and asks the program that is then there for a sky.
set -eu
cd "$(dirname "$0")/../.."
work="$(mktemp -d)"
server=""
finish() {
    [ -n "$server" ] && kill "$server" 2>/dev/null && wait "$server" || true
    umount "$work/root/proc" 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM
chmod 755 "$work"
deploy/debian/package.sh "$work/package"
command -v mmdebstrap >/dev/null 2>&1 || apt-get install -y -q --no-install-recommends mmdebstrap >/dev/null
root="$work/root"
mmdebstrap --quiet --variant=minbase bookworm "$root"
cp "$work"/package/*.deb "$root/skyglow.deb"
cp /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || true
cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
chroot "$root" sh -c 'apt-get update -q && apt-get install -y -q --no-install-recommends /skyglow.deb' >"$work/log" 2>&1 || {
    tail -20 "$work/log" >&2
    exit 1
}
# The program finds its packs by its own path.
mount -t proc proc "$root/proc"
chroot "$root" skyglow --version
chroot "$root" skyglow config check --config /etc/skyglow/skyglow.toml
grep -q '^listen = "127.0.0.1:8080"' "$root/etc/skyglow/skyglow.toml"
# The service's own command makes the demo.
chroot "$root" env SKYGLOW_DEVICE=cpu skyglow serve --listen 127.0.0.1:18931 --data /tmp/data >"$work/log" 2>&1 &
server=$!
tries=0
until curl -fsS http://127.0.0.1:18931/readyz >/dev/null 2>&1; do
    tries=$((tries + 1))
    # Making the demo takes minutes on a busy machine.
    kill -0 "$server" 2>/dev/null && [ "$tries" -lt 1500 ] || { cat "$work/log" >&2; exit 1; }
    sleep 0.2
done
curl -fsS http://127.0.0.1:18931/ | grep -q '<title>Skyglow'
sky() { chroot "$root" env SKYGLOW_DEVICE=cpu "$@" sky --scene demo --lat 46.17 --lon 8.79 --data /tmp/data; }
sky skyglow | tee "$work/sky"
grep -q "zenith" "$work/sky"
# The tarball holds the same program, wherever it is unpacked.
mkdir "$root/opt/there"
tar -C "$root/opt/there" --strip-components=1 -xf "$work"/package/*.tar.gz
sky /opt/there/bin/skyglow | cmp - "$work/sky"
chroot "$root" apt-get remove -y -q skyglow >/dev/null 2>&1
[ ! -e "$root/usr/bin/skyglow" ]
echo "package: installed, asked and removed" >&2
