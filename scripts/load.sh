#!/bin/sh
# Load on a server of its own, on loopback, with the demo scene: `load.sh [SECONDS]` a mix and an executor (default 10). wrk runs
# beside the server on the same cores. Prints a line of JSON a mix; the last ones ask for more than there is room for, and then
# how the server recovers.
set -eu
cd "$(dirname "$0")/.."
seconds="${1:-10}"
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}" XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"
if ! command -v wrk >/dev/null 2>&1; then
    echo "load: installing wrk" >&2
    apt-get install -y -q --no-install-recommends wrk >/dev/null
fi
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
[ -x "$program" ] || cargo build --release --package skyglow
data="$(mktemp -d)"
server=""
trap '[ -z "$server" ] || kill "$server" 2>/dev/null; rm -rf "$data"' EXIT
port=18090
base="http://127.0.0.1:$port"

run() { # run MIX CONNECTIONS
    MIX="$1" wrk --threads 2 --connections "$2" --duration "${seconds}s" --timeout 20s --script deploy/load/mix.lua "$base" |
        grep '^{' | sed "s/^{/{\"executor\": \"$device\", \"connections\": $2, /"
}

for device in cpu lavapipe; do
    "$program" serve --listen "127.0.0.1:$port" --data "$data" --packs precomputed --device "$device" \
        --requests-per-second 0 >"$data/log-$device" 2>&1 &
    server=$!
    until curl -fs "$base/readyz" >/dev/null 2>&1; do
        kill -0 "$server" 2>/dev/null || { cat "$data/log-$device" >&2; exit 1; }
        sleep 0.5
    done
    for mix in panoramas numbers clicks cached tiles mixed; do
        run "$mix" 16
    done
    # Twice the room that there is: the rest is shed.
    run panoramas 256
    run mixed 256
    run panoramas 16
    curl -fs "$base/metrics" | grep -E '^skyglow_(http_refused|cache_lookups|http_panics|engine_refused)' | sed "s/^/$device: /"
    echo "$device: $(awk '/^VmHWM|^VmRSS/ { printf "%s %d MB  ", $1, $2 / 1024 }' "/proc/$server/status")"
    kill -TERM "$server"
    wait "$server" || echo "$device: ended with $?"
    server=""
done
