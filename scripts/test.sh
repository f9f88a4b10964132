#!/bin/sh
# Tests in tiers, each part in order: `test.sh check` (format, lints, unit tests), `test.sh browser` (the viewer in a browser), or
# `test.sh all`, which a change must pass. Stops at the first failure and says how long each part took.
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

# What npm installed last came from this list of packages, or it installs anew.
viewer_packages() {
    installed=web/node_modules/.package-lock.json
    [ -f "$installed" ] && ! [ web/package-lock.json -nt "$installed" ] || in_web npm ci --no-audit --no-fund
}

viewer_checks() {
    part "viewer: packages" viewer_packages
    part "viewer: format and lints" in_web npm run lint
    part "viewer: types, and those of the API fit its document" in_web npm run typecheck
    part "viewer: unit tests" in_web npm run test:unit
}

# One profile and all packages throughout, so that what is built once serves every part: cargo builds dependencies with the
# features that the named packages want. Examples are held to the lints, which compile them; nothing here runs them.
cargo_test() { cargo test --release --workspace "$@"; }
# Unit tests that take seconds each are marked as ignored: `check` leaves them out.
lints() { part "lints" cargo clippy --release --workspace --all-targets -- -D warnings; }

# Rasters of real products are not in the repository: SKYGLOW_TEST_DATA names the folder that has them, and must exist then. Where
# it is not set and none lies beside the checkout, their tests are left out, and the report says so.
real_rasters="${SKYGLOW_TEST_DATA:-../shared/data}"
has_real_rasters() { [ -n "${SKYGLOW_TEST_DATA:-}" ] || [ -d "$real_rasters" ]; }

case "${1:-all}" in
check)
    part "format" cargo fmt --all --check
    lints
    part "unit tests" cargo_test --lib --bins
    viewer_checks
    ;;
browser)
    part "system packages" scripts/system_packages.sh test
    # With this test cargo builds the program that it starts.
    part "build" cargo_test --test command_line --no-run
    part "packs that are missing" scripts/make_packs.sh missing
    part "viewer: in the browser" scripts/browser_tests.sh
    ;;
all)
    part "system packages" scripts/system_packages.sh test
    part "format" cargo fmt --all --check
    part "build" cargo_test --lib --bins --tests --no-run
    lints
    part "packs that are missing" scripts/make_packs.sh missing
    part "unit tests" cargo_test --lib --bins -- --include-ignored
    part "tests of whole crates" cargo_test --test '*'
    if has_real_rasters; then
        part "tests of real rasters" cargo_test --test real_rasters -- --ignored
    else
        report="$report
 not run  tests of real rasters: SKYGLOW_TEST_DATA=FOLDER runs them"
    fi
    part "examples in the documentation" cargo_test --doc
    viewer_checks
    part "viewer: built form matches its sources" in_web npm run test:dist
    part "viewer: in the browser" scripts/browser_tests.sh
    part "generated client" scripts/generated_client.sh
    part "Python package" scripts/python_package.sh
    ;;
*)
    echo "usage: $0 [check|browser|all]" >&2
    exit 2
    ;;
esac

echo "== all passed$report
$(printf '%5d s  in all' "$(($(date +%s) - started_all))")" >&2
