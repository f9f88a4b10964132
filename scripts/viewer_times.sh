#!/bin/sh
# All that the viewer is measured by, as one table (tests/browser/viewer-times.mjs), against the demo on the processor.
# With QUICK=1 fewer frames and clicks. SKYGLOW_TIMES names a folder for what each measurement said and for pictures. Fetches Lighthouse from npm at the first run.
set -eu
cd "$(dirname "$0")/.."
. scripts/test_server.sh

(cd tests/browser && ../../scripts/with_node.sh npm ci --no-audit --no-fund >&2)
start_server cpu
(cd tests/browser && SKYGLOW_URL="$url" ../../scripts/with_node.sh node viewer-times.mjs)
