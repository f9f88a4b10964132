#!/bin/sh
# Makes table packs in precomputed/ for the turbidities of precomputed/turbidities.txt:
# `make_packs.sh missing` those that are not there, `make_packs.sh all` every one anew.
set -eu
cd "$(dirname "$0")/.."

skyglow="${CARGO_TARGET_DIR:-target}/release/skyglow"
which="${1:-missing}"

on_disk="$("$skyglow" packs --packs precomputed --json | tr -d ' \n' | grep -o '"turbidity":[0-9.]*' | cut -d: -f2 || true)"

have() { # have TURBIDITY
    for other in $on_disk; do
        awk "BEGIN { exit !($1 == $other) }" && return 0
    done
    return 1
}

wanted=""
for turbidity in $(grep -v '^ *\(#\|$\)' precomputed/turbidities.txt); do
    if [ "$which" = missing ] && have "$turbidity"; then
        continue
    fi
    wanted="${wanted:+$wanted,}$turbidity"
done
[ -n "$wanted" ] || exit 0
echo "precomputed/: making the packs for turbidity $wanted" >&2
"$skyglow" precompute --turbidity "$wanted" --out precomputed
