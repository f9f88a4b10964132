#!/bin/sh
# Fuzzes every parser of bytes from outside for so many seconds each: `fuzz.sh [SECONDS] [TARGET]...` (default 60, all). Needs the
# nightly compiler and cargo-fuzz, which are installed where they are missing. What is found lies in tests/fuzz/artifacts; put it
# among tests/fuzz/seeds once it is mended, where `make test` keeps it.
set -eu
cd "$(dirname "$0")/.."
seconds="${1:-60}"
[ "$#" -gt 0 ] && shift
[ "$#" -gt 0 ] || set -- parameters body boundary pack celestial raster places
scripts/system_packages.sh serve
rustup toolchain list | grep -q '^nightly' || rustup toolchain install nightly --profile minimal
cargo fuzz --version >/dev/null 2>&1 || cargo install --quiet --locked cargo-fuzz@0.13.2
# A build that fails is no find.
cargo +nightly fuzz build --fuzz-dir tests/fuzz
status=0
for target in "$@"; do
    mkdir -p "tests/fuzz/corpus/$target"
    # GDAL keeps what it has made until the end, which is no leak.
    if ! cargo +nightly fuzz run --fuzz-dir tests/fuzz "$target" "tests/fuzz/corpus/$target" "tests/fuzz/seeds/$target" -- \
        -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -malloc_limit_mb=2048 -detect_leaks=0 -print_final_stats=1 \
        >"tests/fuzz/corpus/$target.log" 2>&1; then
        status=1
        echo "$target: FOUND something:"
        grep -E "panicked|ERROR|SUMMARY|Test unit written" "tests/fuzz/corpus/$target.log" | head -5
    fi
    echo "$target: $(awk -F': *' '/stat::number_of_executed_units/ { n = $NF } END { print n + 0 }' "tests/fuzz/corpus/$target.log") inputs, $(grep -oE 'cov: [0-9]+' "tests/fuzz/corpus/$target.log" | tail -1)"
done
exit "$status"
