#!/bin/sh
# Builds the wheels of the Python package and of its engine into target/wheels, installs both into an empty environment, asks there
# for a sky in three lines, and runs the tests that compare the engine with a server, and maps by several processes with the program's.
# Needs a Rust tool chain, not Python's headers.
set -eu
cd "$(dirname "$0")/.."

maturin=1.16.0
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
wheels="$target/wheels"
tools="$target/maturin-$maturin"
if ! "$tools/bin/maturin" --version >/dev/null 2>&1; then
    rm -rf "$tools"
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet "maturin==$maturin" >&2
fi

rm -rf "$wheels"
# GDAL stays that of the system, as it is for the program: the wheel is of this machine's kind of Linux.
CARGO_TARGET_DIR="$target" "$tools/bin/maturin" build --release --locked --compatibility linux --auditwheel skip \
    --manifest-path python/engine/Cargo.toml --out "$wheels" >&2
sources="$(mktemp -d)"
trap 'rm -rf "$sources"' EXIT
trap 'exit 1' INT TERM
# In the sources nothing is left behind.
cp -R python "$sources/python"
"$tools/bin/pip" wheel --quiet --no-deps --wheel-dir "$wheels" "$sources/python" >&2
ls -l "$wheels" >&2

# An environment that has nothing else, with the versions that the tests know.
python3 -m venv "$sources/environment"
"$sources/environment/bin/pip" install --quiet --constraint python/requirements-test.txt "$wheels"/*.whl >&2
(
    cd "$sources"
    environment/bin/python - "$OLDPWD/precomputed" <<'END'
import sys, skyglow
engine = skyglow.Engine(packs=sys.argv[1], data="data", device="cpu", demo=True)
sky = engine.sky(46.17, 8.79).sky
print(f"zenith {sky.zenith_total_brightness_mag_arcsec2:.2f} mag/arcsec2, Bortle class {sky.bortle_class}, by {engine.device}")
END
)

scripts/python_package.sh python/tests/test_engine.py python/tests/test_distributed.py python/tests/test_export.py "$@"
