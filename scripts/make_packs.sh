#!/bin/sh
# Makes table packs and celestial tables in precomputed/ for the turbidities of precomputed/turbidities.txt:
# `make_packs.sh missing` those that are not there, `make_packs.sh all` every one anew. Packs of another scattering
# than the one below do not count, and stay where they are.
set -eu
cd "$(dirname "$0")/.."

skyglow="${CARGO_TARGET_DIR:-target}/release/skyglow"
which="${1:-missing}"
# What comes with the project.
scattering=multiple

# Turbidity, scattering and the ground's albedo stand side by side in a pack's manifest (clouds would come before bands),
# turbidity and albedo in that of a celestial table.
listed="$("$skyglow" packs --packs precomputed --json | tr -d ' \n' || true)"
lamps="$(echo "$listed" |
    grep -o "\"turbidity\":[0-9.]*,\"scattering\":\"$scattering\",\"ground_albedo\":[0-9.]*,\"bands_nm\"" |
    sed 's/"turbidity":\([0-9.]*\).*/\1/' || true)"
celestial="$(echo "$listed" |
    grep -o '"turbidity":[0-9.]*,"ground_albedo":[0-9.]*,"bands_nm"' |
    sed 's/"turbidity":\([0-9.]*\).*/\1/' || true)"

have() { # have TURBIDITY TURBIDITIES
    for other in $2; do
        awk "BEGIN { exit !($1 == $other) }" && return 0
    done
    return 1
}

make_part() { # make_part PART TURBIDITIES_ON_DISK
    wanted=""
    for turbidity in $(grep -v '^ *\(#\|$\)' precomputed/turbidities.txt); do
        if [ "$which" = missing ] && have "$turbidity" "$2"; then
            continue
        fi
        wanted="${wanted:+$wanted,}$turbidity"
    done
    [ -n "$wanted" ] || return 0
    echo "precomputed/: making the $1 part of $scattering scattering for turbidity $wanted" >&2
    "$skyglow" precompute --turbidity "$wanted" --scattering "$scattering" --part "$1" --out precomputed
}

make_part celestial "$celestial"
make_part lamps "$lamps"

# The overcast skies that come with the project.
for base_m in 800 1500 3000; do
    overcast="precomputed/turbidity-2.50-multiple-clouds-$base_m.skyglow"
    if [ "$which" = all ] || [ ! -f "$overcast" ]; then
        echo "precomputed/: making the overcast sky under clouds at $base_m m" >&2
        rm -f "$overcast"
        "$skyglow" precompute --turbidity 2.5 --cloud-base "$base_m" --out precomputed
    fi
done
