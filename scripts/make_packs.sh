#!/bin/sh
# Makes table packs in precomputed/ for the turbidities of precomputed/turbidities.txt:
# `make_packs.sh missing` those that are not there, `make_packs.sh all` every one anew. Packs of another scattering
# than the one below do not count, and stay where they are.
set -eu
cd "$(dirname "$0")/.."

skyglow="${CARGO_TARGET_DIR:-target}/release/skyglow"
which="${1:-missing}"
# What comes with the project.
scattering=multiple

# Turbidity, scattering and the ground's albedo stand side by side in a pack's manifest; clouds would come before bands.
on_disk="$("$skyglow" packs --packs precomputed --json | tr -d ' \n' |
    grep -o "\"turbidity\":[0-9.]*,\"scattering\":\"$scattering\",\"ground_albedo\":[0-9.]*,\"bands_nm\"" |
    sed 's/"turbidity":\([0-9.]*\).*/\1/' || true)"

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
echo "precomputed/: making the packs of $scattering scattering for turbidity $wanted" >&2
"$skyglow" precompute --turbidity "$wanted" --scattering "$scattering" --out precomputed
