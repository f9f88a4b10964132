#!/bin/sh
# Tests the Python package as it is installed: lints, types, and its tests against a running server with the demo. What these need
# goes into an environment in the build folder. Arguments go to pytest, such as `python/tests/test_plot.py -k map`. The tests of the
# engine need its wheel: scripts/python_wheel.sh builds it and names them here.
set -eu
cd "$(dirname "$0")/.."
. scripts/test_server.sh

requirements=python/requirements-test.txt
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
environment="$target/python-$(cksum <$requirements | cut -d ' ' -f 1)"
if ! [ -e "$environment/complete" ]; then
    rm -rf "$environment"
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet --no-deps --requirement $requirements >&2
    touch "$environment/complete"
fi

cp -R python "$folder/sources"
"$environment/bin/pip" install --quiet --no-deps --no-build-isolation --no-index --target "$folder/installed" "$folder/sources" >&2

for wheel in "$target"/wheels/skyglow_engine-*.whl; do
    ! [ -e "$wheel" ] || "$environment/bin/pip" install --quiet --no-deps --no-index --target "$folder/installed" "$wheel" >&2
done

"$environment/bin/ruff" format --no-cache --quiet --diff python
"$environment/bin/ruff" check --no-cache --quiet python
MYPYPATH=python/src "$environment/bin/mypy" --config-file python/pyproject.toml --cache-dir "$target/mypy" -p skyglow >&2

start_server cpu
[ $# -gt 0 ] || set -- python/tests --ignore python/tests/test_engine.py --ignore python/tests/test_distributed.py \
    --ignore python/tests/test_export.py
export SKYGLOW_PROGRAM="$target/release/skyglow" SKYGLOW_ENGINE_DATA="$folder/data" SKYGLOW_ENGINE_PACKS="$PWD/precomputed"
export SKYGLOW_URL="$url" PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$folder/installed" MPLCONFIGDIR="$target/matplotlib"
"$environment/bin/python" -m pytest --config-file python/pyproject.toml -p no:cacheprovider "$@"
