#!/bin/sh
# The QGIS plugin: `qgis_plugin.sh` tests it as it is installed, in QGIS with and without a window, against a running server with
# the demo; arguments go to unittest, such as `test_algorithms.Sky`. `qgis_plugin.sh zip` makes the file that people install.
set -eu
cd "$(dirname "$0")/.."
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
version="$(sed -n 's/^version=//p' qgis/skyglow/metadata.txt)"
archive="$target/skyglow-qgis-$version.zip"

# What git tracks alone, and the licences that the archive must have.
make_archive() {
    staged="$(mktemp -d)"
    git ls-files --cached --others --exclude-standard qgis/skyglow | while read -r file; do
        mkdir -p "$staged/$(dirname "${file#qgis/}")"
        cp "$file" "$staged/${file#qgis/}"
    done
    cp LICENSE-MIT LICENSE-APACHE "$staged/skyglow/"
    rm -f "$archive"
    (cd "$staged" && python3 -m zipfile -c "$archive" skyglow)
    rm -rf "$staged"
}

if [ "${1:-}" = zip ]; then
    make_archive
    echo "$archive"
    exit 0
fi

scripts/system_packages.sh qgis
. scripts/test_server.sh

lints="$target/qgis-lints"
if ! [ -e "$lints/complete" ]; then
    rm -rf "$lints"
    python3 -m venv "$lints"
    grep '^ruff==' python/requirements-test.txt >"$folder/lints.txt"
    "$lints/bin/pip" install --quiet --requirement "$folder/lints.txt" >&2
    touch "$lints/complete"
fi
"$lints/bin/ruff" format --no-cache --quiet --diff qgis
"$lints/bin/ruff" check --no-cache --quiet qgis

make_archive
python3 -m zipfile -e "$archive" "$folder/plugins"
start_server cpu
mkdir -m 700 "$folder/runtime"
export SKYGLOW_URL="$url" SKYGLOW_QGIS_PLUGINS="$folder/plugins" SKYGLOW_QGIS_PROFILE="$folder/profile"
export XDG_RUNTIME_DIR="$folder/runtime" PYTHONDONTWRITEBYTECODE=1
[ $# -gt 0 ] || set -- discover
# QGIS belongs to Debian's Python, which need not be the first on the path.
cd qgis/tests
/usr/bin/python3 -m unittest "$@"
