#!/bin/sh
# Tests in tiers, each part in order: `test.sh check` (format, lints, unit tests), `test.sh browser` (the viewer in a browser), or all
# that a change must pass. Stops at the first failure and says how long each part took.
set -eu
cd "$(dirname "$0")/.."
# Mesa's layer that chooses among GPUs for a desktop looks for one, and complains on a server that has none.
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}"

export CARGO_TERM_COLOR="${CARGO_TERM_COLOR:-auto}"
started_all="$(date +%s)"
report=""

part() { # part NAME COMMAND...
    name="$1"
    shift
    echo "== $name: $*" >&2
    started="$(date +%s)"
    if ! "$@"; then
        echo "== $name FAILED after $(($(date +%s) - started)) s: $*" >&2
        exit 1
    fi
    report="$report
$(printf '%5d s  %s' "$(($(date +%s) - started))" "$name")"
}

in_web() { (cd web && ../scripts/with_node.sh "$@"); }

# One profile throughout: what is built once serves the lints' build scripts, the tests and the server.
# Examples are held to the lints, which compile them; nothing here runs them.
viewer_packages() { part "viewer: packages" in_web npm ci --no-audit --no-fund; }

viewer_checks() {
    part "viewer: format and lints" in_web npm run lint
    part "viewer: types, and those of the API fit its document" in_web npm run typecheck
    part "viewer: unit tests" in_web npm run test:unit
}

case "${1:-all}" in
check)
    part "format" cargo fmt --all --check
    part "lints" cargo clippy --release --workspace --all-targets -- -D warnings
    part "unit tests" cargo test --release --workspace --lib --bins
    [ -d web/node_modules ] || viewer_packages
    viewer_checks
    ;;
browser)
    part "system packages" scripts/system_packages.sh test
    part "build" cargo build --release --package skyglow
    part "packs that are missing" scripts/make_packs.sh missing
    part "viewer: in the browser" scripts/browser_tests.sh
    ;;
all)
    part "system packages" scripts/system_packages.sh test
    part "format" cargo fmt --all --check
    part "build" cargo test --release --workspace --lib --bins --tests --no-run
    part "lints" cargo clippy --release --workspace --all-targets -- -D warnings
    part "packs that are missing" scripts/make_packs.sh missing
    part "tests" cargo test --release --workspace --lib --bins --tests
    # Rasters of real products are not in the repository: those tests run where the folder of them is.
    real_rasters="${SKYGLOW_TEST_DATA:-../shared/data}"
    if [ -d "$real_rasters" ]; then
        part "tests of real rasters" cargo test --release -p skyglow-scene --test real_rasters -- --ignored
    else
        echo "== NOT RUN: tests of real rasters, $real_rasters is missing (SKYGLOW_TEST_DATA names the folder)" >&2
    fi
    part "examples in the documentation" cargo test --release --workspace --doc
    viewer_packages
    viewer_checks
    part "viewer: built form matches its sources" in_web npm run test:dist
    part "viewer: in the browser" scripts/browser_tests.sh
    ;;
*)
    echo "usage: $0 [check|browser|all]" >&2
    exit 2
    ;;
esac

echo "== all passed$report
$(printf '%5d s  in all' "$(($(date +%s) - started_all))")" >&2
