#!/bin/sh
# The viewer in Chromium against a real server: own port, own data folder, the demo scene, lavapipe. Another command than
# all tests may be given, to be run in tests/browser: scripts/browser_tests.sh node --test plan.test.mjs
set -eu
cd "$(dirname "$0")/.."

skyglow="$(cd "$(dirname "${CARGO_TARGET_DIR:-target}")" && pwd)/$(basename "${CARGO_TARGET_DIR:-target}")/release/skyglow"
folder="$(mktemp -d)"
server=""
finish() {
    [ -n "$server" ] && kill "$server" 2>/dev/null && wait "$server" || true
    rm -rf "$folder"
}
trap finish EXIT
trap 'exit 1' INT TERM

[ $# -gt 0 ] || set -- npm test

(cd tests/browser && ../../scripts/with_node.sh npm ci --no-audit --no-fund)

"$skyglow" serve --listen 127.0.0.1:0 --data "$folder/data" --device lavapipe 2>"$folder/log" &
server=$!

url=""
tries=0
while [ -z "$url" ]; do
    url="$(grep -o 'http://127\.0\.0\.1:[0-9]*' "$folder/log" | head -n 1 || true)"
    if ! kill -0 "$server" 2>/dev/null || [ "$tries" -ge 600 ]; then
        cat "$folder/log" >&2
        echo "browser tests: the server did not start (its log is above)" >&2
        exit 1
    fi
    tries=$((tries + 1))
    sleep 0.2
done

if ! (cd tests/browser && SKYGLOW_URL="$url" ../../scripts/with_node.sh "$@"); then
    echo "browser tests: what the server warned of" >&2
    grep -v ' INFO ' "$folder/log" | tail -n 50 >&2 || true
    exit 1
fi
