#!/bin/sh
# Faults under load, on loopback: what is lost, what answers 500. Stops at the first thing that is not as it should be.
set -eu
. "$(dirname "$0")/loaded_server.sh"
say() { echo "faults: $*"; }
fail() {
    say "FAILED: $*"
    tail -5 "$work/log" 2>/dev/null || true
    exit 1
}
internal() { curl -fs "$base/metrics" | grep -E '^skyglow_http_requests_total.*status="500"' || true; }
# stall CLIENTS SECONDS: clients that send nothing, half a request, or read nothing of the answer.
stall() {
    python3 - "$port" "$1" "$2" <<'PYTHON' >/dev/null
import socket, sys, time
port, clients, seconds = map(int, sys.argv[1:])
sockets = []
for number in range(clients):
    try:
        s = socket.create_connection(("127.0.0.1", port), timeout=2)
        if number % 3 == 1:
            s.sendall(b"GET /api/v1/scenes/demo/sky?lat=46.17&lon=8.79 HTTP/1.1\r\nhost: a\r\nx-slow: ")
        elif number % 3 == 2:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
            s.sendall(b"GET /api/v1/scenes/demo/panorama.json?lat=46.17&lon=8.79 HTTP/1.1\r\nhost: a\r\n\r\n")
        sockets.append(s)
    except OSError:
        pass
time.sleep(seconds)
sys.exit(not sockets)
PYTHON
}
paint='{"title": "dim", "edits": [{"brush": {"points": [[8.79, 46.17]], "radius_m": 6000}, "factor": 0.5}]}'

# Killed under load.
start "$work/data" precomputed || fail "no start"
before="$(curl -fs "$base/api/v1/scenes")"
id="$(curl -fs -X POST "$scenarios" -d "$paint" | sed 's/.*"id":"\(s-[0-9a-f]*\)".*/\1/')"
ask mixed 16 5 >/dev/null 2>&1 &
load=$!
sleep 2
kill -9 "$server"
wait "$load" || true
load=""
wait "$server" 2>/dev/null || true
start "$work/data" precomputed || fail "no start after a kill"
[ "$(curl -fs "$base/api/v1/scenes")" = "$before" ] || fail "scenes differ after a kill"
curl -fs "$base/api/v1/scenarios/$id" >/dev/null || fail "scenario $id is lost"
curl -fs "$scenarios" | grep -q "$id" || fail "scenario $id is in no list after a kill"
say "killed under load: starts again, scenes and scenario are there"

# Clients that stall.
stall 300 8 &
slow=$!
sleep 2
for _ in 1 2 3 4 5; do
    curl -fs -m 3 "$base/api/v1/scenes/demo/sky?lat=46.1&lon=8.7" >/dev/null || fail "no answer beside slow clients"
done
wait "$slow"
[ -z "$(internal)" ] || fail "internal errors: $(internal)"
say "300 silent, half-open and unread connections: answers in time beside them"
stop || fail "SIGTERM does not end it with 0"

# The same where there is less room and patience: they are let go, and so is what they held.
start "$work/data" precomputed --connections 512 --idle-timeout-s 2 || fail "no start"
before="$(ls "/proc/$server/fd" | wc -l)"
stall 600 12 &
slow=$!
sleep 8
curl -fs -m 5 "$base/api/v1/scenes/demo/sky?lat=46.1&lon=8.7" >/dev/null || fail "no answer after slow clients were let go"
held="$(ls "/proc/$server/fd" | wc -l)"
[ "$held" -le $((before + 30)) ] || fail "$held files held beside clients that stall, $before before"
wait "$slow"
[ -z "$(internal)" ] || fail "internal errors: $(internal)"
say "600 of them with 512 places and two seconds' patience: let go, $held files held where $before were, answers in time"
stop || fail "SIGTERM does not end it with 0"

# A full store of 864 MB: copies of one large scenario, as the names of documents are not checked against what they hold.
# seconds COMMAND: runs it, and prints how long it took; fails with it.
seconds() {
    began="$(date +%s%N)"
    "$@" >/dev/null || return 1
    echo "$(($(date +%s%N) - began))" | awk '{printf "%.3f", $1 / 1e9}'
}
# within LIMIT SECONDS WORDS
within() { awk -v limit="$1" -v took="$2" 'BEGIN {exit !(took != "" && took <= limit)}' || fail "$3 took ${2:-too long}, not $1 s"; }
lists() { until curl -fs -m 5 "$scenarios?limit=1000" -o "$work/list"; do sleep 0.05; done; }
start "$work/full" precomputed || fail "no start"
python3 -c "import json
points = [[8.5 + 1e-4 * i + 0.123456789012, 46.2] for i in range(985)]
print(json.dumps({'edits': [{'brush': {'points': points, 'radius_m': 300 + e}, 'factor': 0.5} for e in range(8)]}))" >"$work/large"
curl -fs -X POST "$scenarios" -d @"$work/large" >/dev/null || fail "a large scenario is not kept"
stop || fail "SIGTERM does not end it with 0"
python3 - "$work/full/scenarios" <<'PYTHON' || fail "the store cannot be filled"
import pathlib, sys
folder = pathlib.Path(sys.argv[1])
text = next(folder.glob("s-*.json")).read_bytes()
for number in range(min(4990, 864_000_000 // len(text))):
    (folder / f"s-{number:020x}.json").write_bytes(text)
PYTHON
rm "$work/full/scenarios/outlines.jsonl"
start "$work/full" precomputed || fail "no start with a full store"
first="$(seconds lists)"
[ "$(grep -o '"id"' "$work/list" | wc -l)" = 1000 ] || fail "a part of a list has not 1000 entries"
stop || fail "SIGTERM does not end it with 0"
start "$work/full" precomputed || fail "no start with a full store"
again="$(seconds lists)"
within 2 "$again" "the first list after a start"
listed="$(seconds curl -fs "$scenarios?limit=1000")"
within 0.5 "$listed" "a list"
kept="$(seconds curl -fs -X POST "$scenarios" -d "$paint")"
within 2 "$kept" "keeping a scenario"
for _ in 1 2 3 4 5 6 7 8; do curl -fs "$scenarios?limit=1000" >/dev/null & done
beside="$(seconds curl -fs -m 10 "$base/api/v1/scenes/demo/panorama.png?lat=46.19&lon=8.8")"
within 5 "$beside" "a picture beside eight lists"
stop || fail "SIGTERM does not end it with 0"
say "$(du -sm "$work/full/scenarios" | cut -f1) MB kept: first list $first s after the first start, $again s after the next; a list $listed s, keeping $kept s, a picture beside eight lists $beside s"
rm -r "$work/full"

# A clock that jumps by days and back, under load. (Not the one that never jumps, as no system's does.)
faketime="$(ls /usr/lib/*/faketime/libfaketime.so.1 2>/dev/null | head -1)"
if [ -n "$faketime" ]; then
    echo "+0" >"$work/clock"
    export LD_PRELOAD="$faketime" FAKETIME_TIMESTAMP_FILE="$work/clock" FAKETIME_NO_CACHE=1 FAKETIME_DONT_FAKE_MONOTONIC=1
    start "$work/data" precomputed || fail "no start with a false clock"
    unset LD_PRELOAD FAKETIME_TIMESTAMP_FILE FAKETIME_NO_CACHE FAKETIME_DONT_FAKE_MONOTONIC
    id="$(curl -fs -X POST "$scenarios" -d "$paint" | sed 's/.*"id":"\(s-[0-9a-f]*\)".*/\1/')"
    today="$(curl -fsI "$base/healthz" | sed -n 's/^date: //p')"
    ask mixed 16 12 >"$work/answers" &
    load=$!
    for jump in +3d -3d +30d +0; do
        sleep 2
        echo "$jump" >"$work/clock"
        sleep 0.2
        curl -fs "$base/api/v1/scenes/demo/sky?lat=46.2&lon=8.7" >/dev/null || fail "no sky after the clock went $jump"
        curl -fs "$base/api/v1/scenarios/$id" >/dev/null || fail "scenario $id is lost after the clock went $jump"
        [ "$jump" != +3d ] || [ "$(curl -fsI "$base/healthz" | sed -n 's/^date: //p')" != "$today" ] || fail "the clock did not jump"
    done
    wait "$load" || fail "the load broke off"
    load=""
    grep -q '"not_2xx": 0, "broken": 0' "$work/answers" || fail "refused or broken: $(cat "$work/answers")"
    [ -z "$(internal)" ] || fail "internal errors: $(internal)"
    stop || fail "SIGTERM does not end it with 0"
    say "clock three and thirty days off and back, under load: every answer good, the scenario is there"
else
    say "SKIPPED the clock: libfaketime is not there (apt-get install libfaketime)"
fi

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
    stop || fail "SIGTERM does not end it with 0"
    say "full disk: 503 for what is to be kept, skies go on, and it is kept once there is room"
else
    say "SKIPPED the full disk: nothing can be mounted here"
fi

# A damaged pack, a damaged scene.
cp -r precomputed "$work/packs"
pack="$(ls "$work"/packs/*.skyglow | head -2 | tail -1)"
printf 'x' | dd of="$pack" bs=1 seek=100000 conv=notrunc 2>/dev/null
"$program" ingest tests/fuzz/seeds/raster/smallest --id two --data "$work/data" >/dev/null
printf 'x' | dd of="$work/data/scenes/demo/light.bin" bs=1 seek=5000 conv=notrunc 2>/dev/null
start "$work/data" "$work/packs" --no-demo || fail "one damaged pack or scene keeps the server from starting"
grep -q "WARN.*$(basename "$pack")" "$work/log" || fail "the damaged pack is not named in the log"
code="$(curl -s -o "$work/answer" -w '%{http_code}' "$base/api/v1/scenes/demo/sky?lat=46.17&lon=8.79")"
[ "$code" = 503 ] || fail "a damaged scene is answered with $code"
grep -q "WARN.*light.bin" "$work/log" || fail "the damaged file is not named in the log"
curl -fs "$base/readyz" >"$work/answer" || fail "not ready beside a damaged scene"
grep -q "$(basename "$pack").*demo" "$work/answer" || fail "not named by /readyz: $(cat "$work/answer")"
curl -fs "$base/metrics" >"$work/answer"
grep -q "^skyglow_pack_left_out.*$(basename "$pack")" "$work/answer" || fail "the pack is not among the metrics"
grep -q '^skyglow_scene_left_out.*demo' "$work/answer" || fail "the scene is not among the metrics"
curl -fs "$base/api/v1/scenes" | grep -q '"id":"two"' || fail "the other scene is not served"
[ -z "$(internal)" ] || fail "internal errors: $(internal)"
rm -r "$work/data/scenes/two"
tries=0
until [ "$(curl -s -o "$work/answer" -w '%{http_code}' "$base/readyz")" = 503 ]; do
    tries=$((tries + 1))
    [ "$tries" -le 70 ] || fail "ready with its only scene damaged: $(cat "$work/answer")"
    sleep 1
done
say "damaged pack and scene: left out and named in log, /readyz and metrics; with the last scene gone it is not ready"
stop || fail "SIGTERM does not end it with 0"
say "passed"
