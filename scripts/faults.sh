#!/bin/sh
# Faults under load, on loopback: what is lost, what answers 500. Stops at the first thing that is not as it should be.
set -eu
cd "$(dirname "$0")/.."
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}" XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
[ -x "$program" ] || cargo build --release --package skyglow
command -v wrk >/dev/null 2>&1 || apt-get install -y -q --no-install-recommends wrk >/dev/null
work="$(mktemp -d)"
server=""
trap 'kill -9 $server 2>/dev/null || true; umount "$work/small" 2>/dev/null || true; rm -rf "$work"' EXIT
port=18092
base="http://127.0.0.1:$port"
say() { echo "faults: $*"; }
fail() {
    say "FAILED: $*"
    tail -5 "$work/log" 2>/dev/null || true
    exit 1
}
start() { # start DATA PACKS [ARGUMENTS]
    data="$1"
    packs="$2"
    shift 2
    "$program" serve --listen "127.0.0.1:$port" --data "$data" --packs "$packs" --requests-per-second 0 "$@" >"$work/log" 2>&1 &
    server=$!
    for _ in $(seq 240); do
        curl -fs "$base/readyz" >/dev/null 2>&1 && return 0
        kill -0 "$server" 2>/dev/null || return 1
        sleep 0.25
    done
    return 1
}
stop() {
    kill -TERM "$server"
    wait "$server" || fail "SIGTERM ends it with $?"
}
internal() { curl -fs "$base/metrics" | grep -E '^skyglow_http_requests_total.*status="500"' || true; }
paint='{"title": "dim", "edits": [{"brush": {"points": [[8.79, 46.17]], "radius_m": 6000}, "factor": 0.5}]}'
scenarios="$base/api/v1/scenes/demo/scenarios"

# Killed under load.
start "$work/data" precomputed || fail "no start"
before="$(curl -fs "$base/api/v1/scenes")"
id="$(curl -fs -X POST "$scenarios" -d "$paint" | sed 's/.*"id":"\(s-[0-9a-f]*\)".*/\1/')"
MIX=mixed wrk --threads 2 --connections 16 --duration 5s --script deploy/load/mix.lua "$base" >/dev/null 2>&1 &
load=$!
sleep 2
kill -9 "$server"
wait "$load" || true
wait "$server" 2>/dev/null || true
start "$work/data" precomputed || fail "no start after a kill"
[ "$(curl -fs "$base/api/v1/scenes")" = "$before" ] || fail "scenes differ after a kill"
curl -fs "$base/api/v1/scenarios/$id" >/dev/null || fail "scenario $id is lost"
say "killed under load: starts again, scenes and scenario are there"

# Clients that send nothing, half a request, or read nothing.
python3 - "$port" <<'PYTHON' &
import socket, sys, time
sockets = []
for number in range(300):
    s = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
    if number % 3 == 1:
        s.sendall(b"GET /api/v1/scenes/demo/sky?lat=46.17&lon=8.79 HTTP/1.1\r\nhost: a\r\nx-slow: ")
    elif number % 3 == 2:
        s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        s.sendall(b"GET /api/v1/scenes/demo/panorama.json?lat=46.17&lon=8.79 HTTP/1.1\r\nhost: a\r\n\r\n")
    sockets.append(s)
time.sleep(8)
PYTHON
slow=$!
sleep 2
for _ in 1 2 3 4 5; do
    curl -fs -m 3 "$base/api/v1/scenes/demo/sky?lat=46.1&lon=8.7" >/dev/null || fail "no answer beside slow clients"
done
wait "$slow"
[ -z "$(internal)" ] || fail "internal errors: $(internal)"
say "300 silent, half-open and unread connections: answers in time beside them"
stop

# A full disk.
mkdir "$work/small"
if mount -t tmpfs -o size=40m tmpfs "$work/small" 2>/dev/null; then
    start "$work/small" precomputed || fail "no start on a small disk"
    head -c 100m /dev/zero >"$work/small/fill" 2>/dev/null || true
    code="$(curl -s -o "$work/answer" -w '%{http_code}' -X POST "$scenarios" -d "$paint")"
    [ "$code" = 503 ] || fail "a full disk is answered with $code: $(cat "$work/answer")"
    curl -fs "$base/api/v1/scenes/demo/sky?lat=46.17&lon=8.79" >/dev/null || fail "no sky on a full disk"
    rm "$work/small/fill"
    curl -fs -X POST "$scenarios" -d "$paint" >/dev/null || fail "nothing is kept once there is room"
    [ -z "$(internal)" ] || fail "internal errors: $(internal)"
    stop
    say "full disk: 503 for what is to be kept, skies go on, and it is kept once there is room"
else
    say "SKIPPED the full disk: nothing can be mounted here"
fi

# A damaged pack, a damaged scene.
cp -r precomputed "$work/packs"
pack="$(ls "$work"/packs/*.skyglow | head -1)"
printf 'x' | dd of="$pack" bs=1 seek=100000 conv=notrunc 2>/dev/null
if start "$work/data" "$work/packs"; then fail "a damaged pack is taken"; fi
grep -q "$(basename "$pack")" "$work/log" || fail "the damaged pack is not named"
say "damaged pack: refused by its name ($(tail -1 "$work/log" | cut -c1-120))"
printf 'x' | dd of="$work/data/scenes/demo/light.bin" bs=1 seek=5000 conv=notrunc 2>/dev/null
start "$work/data" precomputed --no-demo || fail "one damaged scene keeps the server from starting"
code="$(curl -s -o "$work/answer" -w '%{http_code}' "$base/api/v1/scenes/demo/sky?lat=46.17&lon=8.79")"
[ "$code" = 500 ] || fail "a damaged scene is answered with $code"
grep -q light.bin "$work/log" || fail "the damaged file is not named in the log"
curl -fs "$base/readyz" >/dev/null || fail "not ready beside a damaged scene"
say "damaged scene: the server starts, says in its log which file, and answers its skies with 500"
stop
say "passed"
