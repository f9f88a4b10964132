#!/bin/sh
# The viewer in Chromium against a real server with the demo scene on lavapipe. Another command than all tests may be given, to be
# run in tests/browser: scripts/browser_tests.sh node --test plan.test.mjs
set -eu
cd "$(dirname "$0")/.."
. scripts/test_server.sh

[ $# -gt 0 ] || set -- npm test

(cd tests/browser && ../../scripts/with_node.sh npm ci --no-audit --no-fund)
start_server lavapipe

if ! (cd tests/browser && SKYGLOW_URL="$url" ../../scripts/with_node.sh "$@"); then
    echo "browser tests: what the server warned of" >&2
    grep -v ' INFO ' "$folder/log" | tail -n 50 >&2 || true
    exit 1
fi
