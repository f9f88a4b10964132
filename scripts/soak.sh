#!/bin/sh
# A mixed load for a long while, and the server's memory beside it: `soak.sh [MINUTES]` (default 20). Prints a line every ten seconds:
# seconds, resident megabytes, requests so far. Fails where the server ends, answers 500, or holds more memory in the last tenth of the
# time than 1.25 times what it held after the first third.
set -eu
cd "$(dirname "$0")/.."
minutes="${1:-20}"
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}" XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
[ -x "$program" ] || cargo build --release --package skyglow
command -v wrk >/dev/null 2>&1 || apt-get install -y -q --no-install-recommends wrk >/dev/null
data="$(mktemp -d)"
server=""
load=""
trap 'kill $server $load 2>/dev/null || true; rm -rf "$data"' EXIT
base="http://127.0.0.1:18091"
"$program" serve --listen 127.0.0.1:18091 --data "$data" --packs precomputed --requests-per-second 0 >"$data/log" 2>&1 &
server=$!
until curl -fs "$base/readyz" >/dev/null 2>&1; do
    kill -0 "$server" 2>/dev/null || { cat "$data/log" >&2; exit 1; }
    sleep 0.5
done
seconds=$((minutes * 60))
(
    half=$((seconds / 6))
    for mix in mixed clicks tiles cached panoramas mixed; do
        MIX="$mix" wrk --threads 2 --connections 16 --duration "${half}s" --timeout 20s --script deploy/load/mix.lua "$base" | grep '^{'
    done
) >"$data/load" 2>&1 &
load=$!
started="$(date +%s)"
while kill -0 "$load" 2>/dev/null; do
    kill -0 "$server" 2>/dev/null || { echo "soak: the server ended" >&2; tail -5 "$data/log" >&2; exit 1; }
    elapsed=$(($(date +%s) - started))
    resident="$(awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$server/status")"
    requests="$(curl -fs "$base/metrics" | awk '/^skyglow_http_requests_total/ { sum += $NF } END { print int(sum) }')"
    echo "$elapsed $resident $requests" | tee -a "$data/curve"
    sleep 10
done
cat "$data/load"
curl -fs "$base/metrics" >"$data/metrics"
if grep -E '^skyglow_http_requests_total.*status="500"' "$data/metrics"; then
    echo "soak: FAILED, there were internal errors" >&2
    exit 1
fi
awk -v end="$seconds" '
    $1 >= end / 3 && $1 < end / 2 && $2 > early { early = $2 }
    $1 >= 0.9 * end && $2 > late { late = $2 }
    END {
        printf "soak: %d MB after a third, %d MB at the end\n", early, late
        exit late > 1.25 * early
    }' "$data/curve" || { echo "soak: FAILED, memory grows" >&2; exit 1; }
kill -TERM "$server"
wait "$server"
echo "soak: passed"
