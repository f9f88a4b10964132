#!/bin/sh
# A client generated from the server's OpenAPI document by openapi-python-client (from PyPI, into the build folder) calls every
# operation of a running server: what generators make of the document must work.
set -eu
cd "$(dirname "$0")/.."

version=0.29.1
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
tools="$target/openapi-python-client-$version"
generator="$tools/bin/openapi-python-client"
if ! "$generator" --version >/dev/null 2>&1; then
    rm -rf "$tools"
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet "openapi-python-client==$version" >&2
fi

folder="$(mktemp -d)"
server=""
finish() {
    [ -n "$server" ] && kill "$server" 2>/dev/null && wait "$server" || true
    rm -rf "$folder"
}
trap finish EXIT
trap 'exit 1' INT TERM

"$target/release/skyglow" serve --listen 127.0.0.1:0 --data "$folder/data" --device cpu 2>"$folder/log" &
server=$!
url=""
tries=0
while [ -z "$url" ] || ! "$tools/bin/python" -c "import urllib.request as r; r.urlopen('$url/readyz')" 2>/dev/null; do
    url="$(grep -o 'http://127\.0\.0\.1:[0-9]*' "$folder/log" | head -n 1 || true)"
    if ! kill -0 "$server" 2>/dev/null || [ "$tries" -ge 600 ]; then
        cat "$folder/log" >&2
        echo "generated client: the server did not start (its log is above)" >&2
        exit 1
    fi
    tries=$((tries + 1))
    sleep 0.2
done

"$tools/bin/python" -c "import urllib.request as r; open('$folder/openapi.json', 'wb').write(r.urlopen('$url/api/v1/openapi.json').read())"
"$generator" generate --path "$folder/openapi.json" --output-path "$folder/skyglow_client" --meta none \
    --config tests/client/generator.yaml --fail-on-warning
"$tools/bin/python" tests/client/every_operation.py "$url" "$folder/openapi.json" "$folder"
