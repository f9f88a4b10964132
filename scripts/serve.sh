#!/bin/sh
# From a fresh checkout to a running server: system packages, build, missing packs, serve.
# Arguments go to `skyglow serve`.
set -eu
cd "$(dirname "$0")/.."
# Mesa's layer that chooses among GPUs for a desktop looks for one, and complains on a server that has none.
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}"

scripts/system_packages.sh serve
cargo build --release --package skyglow
scripts/make_packs.sh missing
exec "${CARGO_TARGET_DIR:-target}/release/skyglow" serve "$@"
