# Sourced by scripts that test against a running server: `start_server DEVICE` starts the built program with the demo scene on a
# port of its own and a data folder of its own, waits until it listens, and sets `url`, `folder` and `server`. It ends with the
# script.

folder="$(mktemp -d)"
server=""
finish() {
    [ -n "$server" ] && kill "$server" 2>/dev/null && wait "$server" || true
    rm -rf "$folder"
}
trap finish EXIT
trap 'exit 1' INT TERM

start_server() { # start_server DEVICE
    "${CARGO_TARGET_DIR:-target}/release/skyglow" serve --listen 127.0.0.1:0 --data "$folder/data" --device "$1" 2>"$folder/log" &
    server=$!
    url=""
    tries=0
    while [ -z "$url" ]; do
        url="$(grep -o 'http://127\.0\.0\.1:[0-9]*' "$folder/log" | head -n 1 || true)"
        if ! kill -0 "$server" 2>/dev/null || [ "$tries" -ge 1500 ]; then
            cat "$folder/log" >&2
            echo "$0: the server did not start (its log is above)" >&2
            exit 1
        fi
        tries=$((tries + 1))
        sleep 0.2
    done
}
