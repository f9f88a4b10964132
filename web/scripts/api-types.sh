#!/bin/sh
# Writes src/api/schema.ts from the server's OpenAPI document by openapi-typescript, so that the viewer spells no path, parameter
# or field by hand. The document is the snapshot that the server's own test holds it to: a header between two lines `---`, then
# the document. openapi-typescript needs the API of TypeScript 5, which is the package `typescript`; types are checked by
# TypeScript 7, the package `typescript-7`.
#   scripts/api-types.sh           writes
#   scripts/api-types.sh --check   fails when the written file is not what the document gives
set -eu
cd "$(dirname "$0")/.."

sed -e 1d -e '2,/^---$/d' ../server/http/tests/interface/snapshots/interface__document__openapi.snap |
    node node_modules/openapi-typescript/bin/cli.js --output src/api/schema.ts \
        --root-types --root-types-no-schema-prefix --empty-objects-unknown --array-length "$@"
