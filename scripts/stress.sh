#!/bin/sh
# The stress suite in release mode: see tests/stress/main.rs. Arguments go to it.
set -eu
cd "$(dirname "$0")/.."
# Mesa's layer that chooses among GPUs for a desktop looks for one, and complains on a server that has none.
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}"

scripts/system_packages.sh test
# Of the whole workspace, as the tests are: of one package alone dependencies would be built anew with other features.
cargo build --release --workspace --bin stress
exec "${CARGO_TARGET_DIR:-target}/release/stress" "$@"
