#!/bin/sh
# Starts the server behind nginx as deploy/nginx/skyglow.conf has it, with a certificate made for this, and follows what it
# links to: the viewer, its scripts, tiles, the document, what is stored, parts of files. Needs nginx, openssl, curl and
# python3 (apt-get install nginx-light); gdalinfo is asked too where it is installed.
#   deploy/nginx/test.sh [PROGRAM]
set -eu
here="$(cd "$(dirname "$0")" && pwd)"
skyglow="${1:-$here/../../target/release/skyglow}"
folder="$(mktemp -d)"
chmod 755 "$folder"
server=""
proxy=""
finish() {
    for process in $server $proxy; do
        kill "$process" 2>/dev/null && wait "$process" || true
    done
    rm -rf "$folder"
}
trap finish EXIT
trap 'exit 1' INT TERM
fail() {
    echo "behind nginx: $*" >&2
    exit 1
}

free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }
port="$(free_port)"
front="$(free_port)"
"$skyglow" serve --listen "127.0.0.1:$port" --data "$folder/data" --device cpu --trusted-proxies 127.0.0.1/32 2>"$folder/log" &
server=$!
tries=0
until curl -fsS "http://127.0.0.1:$port/readyz" >/dev/null 2>&1; do
    kill -0 "$server" 2>/dev/null && [ "$tries" -lt 600 ] || { cat "$folder/log" >&2; fail "the server did not start"; }
    tries=$((tries + 1))
    sleep 0.2
done

openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=sky.example.org -addext subjectAltName=DNS:sky.example.org \
    -keyout "$folder/key.pem" -out "$folder/certificate.pem" 2>/dev/null
sed -e "s#listen 443 ssl#listen 127.0.0.1:$front ssl#" -e "s#127.0.0.1:8080#127.0.0.1:$port#" \
    -e "s#/etc/ssl/sky.example.org.pem#$folder/certificate.pem#" -e "s#/etc/ssl/sky.example.org.key#$folder/key.pem#" \
    "$here/skyglow.conf" >"$folder/site.conf"
{
    echo "pid $folder/nginx.pid; error_log $folder/nginx.log; daemon off;"
    echo "events {} http { access_log off; client_body_temp_path $folder/body; proxy_temp_path $folder/proxy;"
    echo "fastcgi_temp_path $folder/fastcgi; uwsgi_temp_path $folder/uwsgi; scgi_temp_path $folder/scgi;"
    echo "include $folder/site.conf; }"
} >"$folder/nginx.conf"
PATH="$PATH:/usr/sbin" nginx -c "$folder/nginx.conf" &
proxy=$!
base="https://sky.example.org:$front/skyglow"
ask() { curl -fsS --cacert "$folder/certificate.pem" --resolve "sky.example.org:$front:127.0.0.1" "$@"; }
tries=0
until ask -o /dev/null "$base/"; do
    [ "$tries" -lt 50 ] || { cat "$folder/nginx.log" >&2; fail "nginx does not answer"; }
    tries=$((tries + 1))
    sleep 0.2
done

field() { python3 -c "import json, sys; print(json.load(sys.stdin)$1)"; }
for asset in $(ask "$base/" | grep -o 'assets/[^"]*\.\(js\|css\)'); do
    ask -o /dev/null "$base/$asset" || fail "$asset of the viewer"
done
ask -o /dev/null "$base/api/docs"
ask -o /dev/null "$base/api/docs/page.js"
for layer in radiance elevation; do
    tile="$(ask "$base/api/v1/scenes/demo/tiles/$layer/tilejson.json" | field "['tiles'][0]")"
    case "$tile" in "$base/api/v1/"*) ;; *) fail "the tiles of $layer are at $tile" ;; esac
    ask -D "$folder/head" -o /dev/null "$(echo "$tile" | sed -e 's/{z}/7/' -e 's/{x}/67/' -e 's/{y}/45/')"
    grep -qi '^cache-control:.*immutable' "$folder/head" || fail "tiles of $layer may not be kept"
done
[ "$(ask "$base/api/v1/openapi.json" | field "['servers'][0]['url']")" = "$base/" ] || fail "servers of the document"
place="$(ask "$base/api/v1/scenes/demo/places")"
longitude="$(echo "$place" | field "[0]['longitude_deg']")"
latitude="$(echo "$place" | field "[0]['latitude_deg']")"
ask -D "$folder/head" -o /dev/null -H "Origin: https://sky.example.org:$front" -H 'Content-Type: application/json' \
    -d "{\"edits\": [{\"brush\": {\"points\": [[$longitude, $latitude]], \"radius_m\": 5000}, \"factor\": 0.5}]}" \
    "$base/api/v1/scenes/demo/scenarios"
location="$(tr -d '\r' <"$folder/head" | sed -n 's/^[Ll]ocation: //p')"
case "$location" in /skyglow/api/v1/scenarios/s-*) ;; *) fail "a scenario is at $location" ;; esac
ask -o /dev/null "https://sky.example.org:$front$location"
ask -r 0-99 -D "$folder/head" -o "$folder/part" "$base/api/v1/scenes/demo/layers/radiance.tif"
[ "$(wc -c <"$folder/part")" = 100 ] && grep -q '^HTTP.* 206' "$folder/head" || fail "parts of files"
if ask -o /dev/null "$base/metrics" 2>/dev/null; then fail "metrics are public"; fi
if command -v gdalinfo >/dev/null; then
    for layer in layers/radiance layers/elevation layers/brightness "influence"; do
        query=""
        [ "$layer" != influence ] || query="?lat=$latitude&lon=$longitude"
        # The map of brightness is made when it is first asked for, which GDAL can wait for.
        GDAL_HTTP_MAX_RETRY=60 GDAL_HTTP_RETRY_DELAY=5 gdalinfo "/vsicurl/http://127.0.0.1:$port/api/v1/scenes/demo/$layer.tif$query" >"$folder/info" || fail "gdalinfo of $layer"
        echo "behind nginx: $layer: $(grep '^Size is' "$folder/info")"
    done
fi
echo "behind nginx: $base and all that it links to are answered"
[ -z "${KEEP:-}" ] || { echo "kept until the return key, certificate in $folder"; read -r _; }
