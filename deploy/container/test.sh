#!/bin/sh
# Builds the image's root file system and starts it as a container would, on lavapipe: `test.sh [WORK_DIR]`, as root. Says what it
# finds; stops at the first thing that is not as it should be.
set -eu
cd "$(dirname "$0")/../.."
work="${1:-$(mktemp -d)}"
root="$work/rootfs"
port=18080
say() { echo "container test: $*"; }
fail() {
    say "FAILED: $*"
    tail -20 "$work/log" 2>/dev/null || true
    exit 1
}

[ -d "$root" ] || deploy/container/rootfs.sh "$root"
mkdir -p "$work/data"
token="$(head -c 24 /dev/urandom | od -An -tx1 | tr -d ' \n')"
printf %s "$token" >"$work/data/operator-token"
chmod 600 "$work/data/operator-token"
chown 10001 "$work/data/operator-token"
SKYGLOW_LISTEN="127.0.0.1:$port" SKYGLOW_DEVICE=lavapipe deploy/container/start.sh "$root" "$work/data" serve \
    --operator-token-file /var/lib/skyglow/operator-token >"$work/log" 2>&1 &
outer=$!
trap 'kill "$outer" 2>/dev/null || true' EXIT
base="http://127.0.0.1:$port"
waited=0
until curl -fs "$base/readyz" >"$work/ready" 2>/dev/null; do
    kill -0 "$outer" 2>/dev/null || fail "it ended"
    waited=$((waited + 1))
    # Making the demo takes minutes on a busy machine.
    [ "$waited" -lt 600 ] || fail "not ready after $waited s"
    sleep 1
done
say "ready after $waited s, the demo made on the way: $(cat "$work/ready")"
grep -q lavapipe "$work/ready" || fail "another executor than lavapipe"

# The first process of the new namespace.
pid="$(pgrep -P "$outer" | head -1)"
uid="$(awk '/^Uid:/ { print $2 }' "/proc/$pid/status")"
[ "$uid" = 10001 ] || fail "it runs as user $uid"
capabilities="$(awk '/^CapEff:/ { print $2 }' "/proc/$pid/status")"
[ "$capabilities" = 0000000000000000 ] || fail "it has capabilities: $capabilities"
awk '$5 == "/" { print $6 }' "/proc/$pid/mountinfo" | grep -q '^ro' || fail "its root can be written to"
say "user $uid, no capabilities, root read-only"

sky="$(curl -fs "$base/api/v1/scenes/demo/sky?lat=46.17&lon=8.79")" || fail "no sky"
echo "$sky" | grep -q '"executor":"lavapipe"' || fail "the sky was not rendered on lavapipe: $sky"
curl -fs "$base/api/v1/scenes/demo/panorama.png?lat=46.17&lon=8.79" -o "$work/panorama.png" || fail "no panorama"
curl -fs "$base/" | grep -qi '<!doctype html>' || fail "no viewer"
say "a sky and a panorama on lavapipe, and the viewer"

# An upload is read by a process of its own, inside as well.
put() { curl -s -o "$work/answer" -w '%{http_code}' -X PUT -H "Authorization: Bearer $token" -F "radiance=@$1" "$base/api/v1/scenes/uploaded"; }
code="$(put tests/fuzz/seeds/raster/smallest)"
[ "$code" = 201 ] || fail "an upload is answered with $code: $(cat "$work/answer")"
code="$(put README.md)"
[ "$code" = 422 ] || fail "an upload that is no raster is answered with $code: $(cat "$work/answer")"
curl -fs "$base/api/v1/scenes/uploaded" >/dev/null || fail "the uploaded scene is gone"
say "an upload is taken, one that is no raster refused"

started="$(date +%s)"
kill -TERM "$pid"
status=0
wait "$outer" || status=$?
trap - EXIT
[ "$status" -eq 0 ] || fail "ended with $status"
say "SIGTERM ends it with 0 within $(($(date +%s) - started)) s"
say "passed; $(du -sm "$root" | cut -f1) MB of root file system"
