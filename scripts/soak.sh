#!/bin/sh
# A mixed load for a long while, and the server's memory beside it: `soak.sh [MINUTES]` (default 20). Prints a line every ten seconds:
# seconds, resident megabytes, requests so far. Fails where the server ends, answers 500, or holds more memory in the last tenth of the
# time than 1.25 times what it held after the first third.
set -eu
. "$(dirname "$0")/loaded_server.sh"
seconds=$((${1:-20} * 60))
start "$work/data" precomputed
(
    for mix in mixed clicks tiles cached panoramas mixed; do
        ask "$mix" 16 $((seconds / 6))
    done
) >"$work/load" 2>&1 &
load=$!
started="$(date +%s)"
while kill -0 "$load" 2>/dev/null; do
    kill -0 "$server" 2>/dev/null || { echo "soak: the server ended" >&2; tail -5 "$work/log" >&2; exit 1; }
    elapsed=$(($(date +%s) - started))
    resident="$(awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$server/status")"
    requests="$(curl -fs "$base/metrics" | awk '/^skyglow_http_requests_total/ { sum += $NF } END { print int(sum) }')"
    echo "$elapsed $resident $requests" | tee -a "$work/curve"
    sleep 10
done
load=""
cat "$work/load"
if curl -fs "$base/metrics" | grep -E '^skyglow_http_requests_total.*status="500"'; then
    echo "soak: FAILED, there were internal errors" >&2
    exit 1
fi
awk -v end="$seconds" '
    $1 >= end / 3 && $1 < end / 2 && $2 > early { early = $2 }
    $1 >= 0.9 * end && $2 > late { late = $2 }
    END {
        printf "soak: %d MB after a third, %d MB at the end\n", early, late
        exit !early || !late || late > 1.25 * early
    }' "$work/curve" || { echo "soak: FAILED, memory grows" >&2; exit 1; }
stop
echo "soak: passed"
