#!/bin/sh
# A client generated from the server's OpenAPI document by openapi-python-client (installed into the build folder) calls every
# operation of a running server: what generators make of the document must work.
set -eu
cd "$(dirname "$0")/.."
. scripts/test_server.sh

version=0.29.1
target="$(mkdir -p "${CARGO_TARGET_DIR:-target}" && cd "${CARGO_TARGET_DIR:-target}" && pwd)"
tools="$target/openapi-python-client-$version"
generator="$tools/bin/openapi-python-client"
if ! "$generator" --version >/dev/null 2>&1; then
    rm -rf "$tools"
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet "openapi-python-client==$version" >&2
fi

start_server cpu
"$tools/bin/python" - "$url" <<'END'
import sys, time, urllib.error, urllib.request

for _ in range(600):
    try:
        sys.exit(0 if urllib.request.urlopen(sys.argv[1] + "/readyz") else 1)
    except urllib.error.HTTPError:
        time.sleep(0.2)
sys.exit("the server does not become ready")
END

"$tools/bin/python" -c "import urllib.request as r; open('$folder/openapi.json', 'wb').write(r.urlopen('$url/api/v1/openapi.json').read())"
"$generator" generate --path "$folder/openapi.json" --output-path "$folder/skyglow_client" --meta none \
    --config tests/client/generator.yaml --fail-on-warning
"$tools/bin/python" tests/client/every_operation.py "$url" "$folder/openapi.json" "$folder"
