#!/bin/sh
# What one installs: `package.sh [FOLDER]` writes a Debian package and a tarball of the program with its packs into FOLDER (target/package
# without one). Builds the program if it is not built. Needs dpkg-dev, which build-essential has.
set -eu
cd "$(dirname "$0")/../.."
folder="${1:-target/package}"
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
[ -x "$program" ] || cargo build --release --package skyglow
version="$("$program" -V | cut -d' ' -f2)"
architecture="$(dpkg --print-architecture)"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"

# PREFIX/bin and PREFIX/share/skyglow/precomputed: the program looks for its packs there.
prefix() { # prefix ROOT
    install -D -m 755 "$program" "$1/bin/skyglow"
    strip "$1/bin/skyglow"
    install -d "$1/share/skyglow/precomputed"
    install -m 644 precomputed/*.json precomputed/*.skyglow "$1/share/skyglow/precomputed/"
    install -d "$1/share/doc/skyglow"
    install -m 644 README.md CHANGELOG.md "$1/share/doc/skyglow/"
    cat LICENSE-MIT LICENSE-APACHE >"$1/share/doc/skyglow/copyright"
}

# Most of it is packs, which are compressed already.
name="skyglow-$version-linux-$architecture"
prefix "$work/$name"
tar -C "$work" --owner=0 --group=0 -cf - "$name" | gzip -1 >"$folder/$name.tar.gz"

root="$work/deb"
prefix "$root/usr"
install -D -m 644 deploy/debian/skyglow.service "$root/lib/systemd/system/skyglow.service"
# A service listens for this machine alone until its operator says otherwise.
install -d "$root/etc/skyglow"
sed -e 's|^listen = .*|listen = "127.0.0.1:8080"|' -e 's|/usr/local/share|/usr/share|' deploy/skyglow.toml >"$root/etc/skyglow/skyglow.toml"
install -d "$root/DEBIAN"
echo /etc/skyglow/skyglow.toml >"$root/DEBIAN/conffiles"
# Libraries by the packages that have them here.
mkdir "$work/debian"
printf 'Source: skyglow\n\nPackage: skyglow\nArchitecture: any\n' >"$work/debian/control"
libraries="$(cd "$work" && dpkg-shlibdeps -O "$root/usr/bin/skyglow" 2>/dev/null | sed -n 's/^shlibs:Depends=//p')"
[ -n "$libraries" ] || { echo "package: dpkg-shlibdeps found no libraries" >&2; exit 1; }
cat >"$root/DEBIAN/control" <<CONTROL
Package: skyglow
Version: $version
Architecture: $architecture
Maintainer: Skyglow <skyglow@localhost>
Installed-Size: $(du -sk "$root/usr" | cut -f1)
Depends: $libraries, libvulkan1
Recommends: mesa-vulkan-drivers
Section: science
Priority: optional
Description: light pollution of the night sky from satellite pictures
 A server and a command that compute what the night sky looks like over any
 place, whose light it is, and what to switch off. Comes with its tables.
 .
 The service is not enabled: systemctl enable --now skyglow starts it on
 http://127.0.0.1:8080 with its demo.
CONTROL
dpkg-deb --root-owner-group -Zgzip -z1 --build "$root" "$folder/skyglow_${version}_$architecture.deb" >/dev/null
ls -l "$folder" >&2
