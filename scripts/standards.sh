#!/bin/sh
# Validates a running server with the demo by the standards that it claims: OGC APIs by their official JSON schemas and abstract tests,
# STAC, Cloud-Optimized GeoTIFF, CoverageJSON and CF. Schemas stay under their own licences: they are fetched once into the build
# folder, at fixed versions, from where SKYGLOW_STANDARDS_GIT says. Arguments are further GeoTIFFs to judge.
set -eu
cd "$(dirname "$0")/.."
. scripts/test_server.sh

from="${SKYGLOW_STANDARDS_GIT:-https://github.com}"
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
schemas="$target/standards"

take() { # take REPOSITORY VERSION FOLDER NAME
    clones="$target/standards-git"
    clone="$clones/$1"
    [ -d "$clone" ] || git clone --quiet --bare "$from/$1" "$clone" >&2
    mkdir -p "$schemas.unfinished/$4"
    git -C "$clone" archive "$2:$3" | tar -x -C "$schemas.unfinished/$4"
}

if ! [ -d "$schemas" ]; then
    rm -rf "$schemas.unfinished"
    take opengeospatial/ogcapi-common 3828187 19-072/openapi/schemas common
    take opengeospatial/ogcapi-common 3828187 collections/openapi/schemas common-geodata
    take opengeospatial/ogcapi-environmental-data-retrieval 1.1.0-final standard/openapi/schemas edr
    take opengeospatial/ogcapi-tiles 1.0.0 openapi/schemas tiles/schemas
    take opengeospatial/ogcapi-processes 52a53a4 core/openapi/schemas processes
    take opengeospatial/2D-Tile-Matrix-Set 7cee2f8 schemas/tms/2.0/json tms
    take opengeospatial/CoverageJSON bcfe98f standard/schema covjson
    take stac-extensions/projection v2.0.0 json-schema projection
    take stac-extensions/raster v2.0.0 json-schema raster
    mv "$schemas.unfinished" "$schemas"
fi

requirements="python/requirements-test.txt tests/standards/requirements.txt"
environment="$target/standards-$(cat $requirements | cksum | cut -d ' ' -f 1)"
if ! [ -e "$environment/complete" ]; then
    rm -rf "$environment"
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet --no-deps --requirement python/requirements-test.txt >&2
    "$environment/bin/pip" install --quiet --constraint python/requirements-test.txt --requirement tests/standards/requirements.txt >&2
    touch "$environment/complete"
fi
"$environment/bin/ruff" format --no-cache --quiet --diff --config python/pyproject.toml tests/standards
"$environment/bin/ruff" check --no-cache --quiet --config python/pyproject.toml --ignore D,PT018 tests/standards

start_server cpu
PYTHONPATH=python/src PYTHONDONTWRITEBYTECODE=1 "$environment/bin/python" tests/standards "$url" "$schemas" "$folder/files" "$@"
