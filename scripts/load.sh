#!/bin/sh
# Load on a server of its own, on loopback, with the demo scene: `load.sh [SECONDS]` a mix and an executor (default 10). wrk runs
# beside the server on the same cores. Prints a line of JSON a mix; the last ones ask for more than there is room for, and then
# how the server recovers.
set -eu
. "$(dirname "$0")/loaded_server.sh"
seconds="${1:-10}"

for device in cpu lavapipe; do
    start "$work/data" precomputed --device "$device"
    run() { # run MIX CONNECTIONS
        ask "$1" "$2" "$seconds" | sed "s/^{/{\"executor\": \"$device\", \"connections\": $2, /"
    }
    # Terrain is looked over for the first horizon, tables come into memory: not what is measured.
    ask panoramas 4 2 >/dev/null
    for mix in panoramas numbers clicks cached tiles mixed; do
        run "$mix" 16
    done
    # Twice the room that there is: the rest is shed.
    run panoramas 256
    run mixed 256
    run panoramas 16
    curl -fs "$base/metrics" | grep -E '^skyglow_(http_refused|cache_lookups|http_panics|engine_refused)' | sed "s/^/$device: /"
    echo "$device: $(awk '/^VmHWM|^VmRSS/ { printf "%s %d MB  ", $1, $2 / 1024 }' "/proc/$server/status")"
    stop || echo "$device: SIGTERM did not end it with 0"
done
