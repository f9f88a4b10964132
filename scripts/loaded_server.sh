# For `.`: what the scripts share that put a server of their own under load, on loopback. Changes into the top folder, builds the
# program as it is now, installs wrk where it is missing, and makes $work, which goes with the script.
cd "$(dirname "$0")/.."
export NODEVICE_SELECT="${NODEVICE_SELECT:-1}" XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"
cargo build --quiet --release --package skyglow
program="${CARGO_TARGET_DIR:-target}/release/skyglow"
if ! command -v wrk >/dev/null 2>&1; then
    echo "installing wrk" >&2
    apt-get install -y -q --no-install-recommends wrk >/dev/null
fi
work="$(mktemp -d)"
server=""
load=""
tidy() {
    kill -9 $server $load 2>/dev/null || true
    umount "$work/small" 2>/dev/null || true
    rm -rf "$work"
}
trap tidy EXIT

# start DATA PACKS [ARGUMENTS]: a server that is ready, its log in $work/log; fails where it ends instead.
start() {
    data="$1"
    packs="$2"
    shift 2
    "$program" serve --listen 127.0.0.1:0 --data "$data" --packs "$packs" --requests-per-second 0 --kept-per-day 0 "$@" >"$work/log" 2>&1 &
    server=$!
    tries=0
    port=""
    # Its own port, which its log says: another server's would answer as readily.
    until [ -n "$port" ] && curl -fs "$base/readyz" >/dev/null 2>&1; do
        kill -0 "$server" 2>/dev/null || return 1
        tries=$((tries + 1))
        [ "$tries" -le 480 ] || return 1
        sleep 0.25
        port="$(sed -n 's/.*http:\/\/127\.0\.0\.1:\([0-9]*\).*/\1/p' "$work/log" | head -1)"
        base="http://127.0.0.1:$port"
        scenarios="$base/api/v1/scenes/demo/scenarios"
    done
}

# ask MIX CONNECTIONS SECONDS: a line of JSON.
ask() {
    MIX="$1" wrk --threads 2 --connections "$2" --duration "${3}s" --timeout 20s --script deploy/load/mix.lua "$base" | grep '^{'
}

# Fails where SIGTERM does not end it with 0.
stop() {
    kill -TERM "$server"
    status=0
    wait "$server" || status=$?
    server=""
    return "$status"
}
