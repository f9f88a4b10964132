#!/bin/sh
# Licences, bans, duplicate versions and sources of every dependency, by cargo-deny (deny.toml), which is installed where it is
# missing. Known weaknesses too, where their database can be reached.
set -eu
cd "$(dirname "$0")/.."
version=0.20.2
if ! cargo deny --version >/dev/null 2>&1; then
    echo "== installing cargo-deny $version (minutes)" >&2
    cargo install --quiet --locked "cargo-deny@$version"
fi
cargo deny --log-level error check licenses bans sources
# A database that cannot be had is no fault of the dependencies; what it says of them is.
if cargo deny --log-level error fetch db >/dev/null 2>&1; then
    cargo deny --log-level error check advisories
else
    echo "== advisories NOT CHECKED: their database cannot be reached from here" >&2
fi
