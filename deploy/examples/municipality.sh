#!/bin/sh
# What a municipality asks, with curl: how dark is it, how much of the glow is ours, what should we dim, and what if the lamps
# were others. Usage: municipality.sh [SERVER] [FOLDER], against the demo scene unless SCENE says otherwise.
set -eu

server="${1:-http://127.0.0.1:8080}"
folder="${2:-.}"
scene="$server/api/v1/scenes/${SCENE:-demo}"
here="$(cd "$(dirname "$0")" && pwd)"
site="lat=46.30&lon=8.79"

# An answer that is no success stops the script with what the server said.
ask() {
    curl --silent --show-error --fail-with-body "$@"
}

# The value of a name in JSON on standard input: the first one.
value() {
    tr ',{}' '\n\n\n' | sed -n "s/^ *\"$1\" *: *\"\{0,1\}\([^\"]*\)\"\{0,1\} *\$/\1/p" | head -n 1
}

post() { # post PATH FILE
    ask --header 'content-type: application/json' --data-binary "@$2" "$1"
}

sky="$(ask "$scene/sky?$site")"
echo "zenith: $(echo "$sky" | value zenith_total_brightness_mag_arcsec2) mag/arcsec2"

# How much of the light at the zenith comes from inside our boundary?
printf '{"boundary": %s}' "$(cat "$here/municipality.geojson")" >"$folder/boundary.json"
ours="$(post "$scene/influence?$site&limit=0" "$folder/boundary.json")"
echo "ours: $(echo "$ours" | sed 's/.*"boundary"://' | value share) of the light at the zenith"

# Which lights are those? A raster for QGIS.
ask --output "$folder/influence.tif" "$scene/influence.tif?$site"

# What to dim: the least that makes both sites darker, without the protected quarter.
plan="$(post "$scene/plans?limit=0" "$here/plan.json")"
id="$(echo "$plan" | value id)"
echo "plan: $id takes away $(echo "$plan" | value flux_removed_share) of the light"
for format in tif geojson csv; do
    ask --output "$folder/plan.$format" "$server/api/v1/plans/$id.$format?limit=10000"
done

# What if: other lamps, and the plan upon them.
lamps="$(post "$scene/scenarios" "$here/lamps.json" | value id)"
echo "with the plan: $(ask "$scene/sky?$site&scenario=$id" | value zenith_total_brightness_mag_arcsec2) mag/arcsec2"
echo "with white lamps: $(ask "$scene/sky?$site&scenario=$lamps" | value zenith_total_brightness_mag_arcsec2) mag/arcsec2"
for scenario in "$id" "$lamps"; do
    ask --output "$folder/sky-$scenario.png" "$scene/panorama.png?$site&scenario=$scenario&projection=fisheye"
done
