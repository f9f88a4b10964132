#!/bin/sh
# Installs the Debian packages that Skyglow needs: `system_packages.sh serve` those to build and run,
# `system_packages.sh test` also those of the browser tests and the worked examples, `system_packages.sh qgis` those of the QGIS
# plugin's tests. What is there already is left alone.
set -eu

purpose="${1:-}"
case "$purpose" in
serve | test | qgis) ;;
*)
    echo "usage: $0 serve|test|qgis" >&2
    exit 2
    ;;
esac

say() { echo "system packages: $*" >&2; }

has_command() { command -v "$1" >/dev/null 2>&1; }

has_vulkan_loader() {
    PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep -q 'libvulkan\.so\.1'
}

has_lavapipe() {
    for folder in /usr/share/vulkan/icd.d /etc/vulkan/icd.d /usr/local/share/vulkan/icd.d; do
        for driver in "$folder"/lvp_icd*.json; do
            [ -e "$driver" ] && return 0
        done
    done
    return 1
}

# Debian's packages belong to Debian's Python, which need not be the first on the path.
has_python_modules() {
    for python in python3 /usr/bin/python3; do
        "$python" -c "import requests, rasterio" >/dev/null 2>&1 && return 0
    done
    return 1
}

has_qgis_module() { /usr/bin/python3 -c "import qgis.core" >/dev/null 2>&1; }

# A package is asked for only when what it provides is missing, so that another Node or compiler will do.
missing=""
need() { # need PACKAGE PROBE...
    package="$1"
    shift
    "$@" || missing="$missing $package"
}

need build-essential has_command cc
need pkg-config has_command pkg-config
if has_command pkg-config; then
    need libgdal-dev pkg-config --exists gdal
else
    missing="$missing libgdal-dev"
fi
need libvulkan1 has_vulkan_loader
need mesa-vulkan-drivers has_lavapipe
if [ "$purpose" = test ]; then
    need nodejs has_command node
    need npm has_command npm
    need chromium has_command chromium
    # The worked examples of deploy/examples use them.
    need curl has_command curl
    need python3-requests has_python_modules
    need python3-rasterio has_python_modules
    # The generator of a client is installed into an environment of its own.
    need python3-venv python3 -c "import ensurepip"
fi
if [ "$purpose" = qgis ]; then
    need qgis has_command qgis_process
    need qgis-providers test -e /usr/lib/qgis/plugins/libprovider_gpx.so
    need python3-qgis has_qgis_module
    need xvfb has_command xvfb-run
    need xauth has_command xauth
    need python3-venv python3 -c "import ensurepip"
fi

if [ -n "$missing" ]; then
    command_line="apt-get install -y --no-install-recommends$missing"
    if ! has_command apt-get; then
        say "missing:$missing. These are Debian's names, and there is no apt-get here: install them your way."
        exit 1
    fi
    as_root=""
    if [ "$(id -u)" -ne 0 ]; then
        if ! has_command sudo; then
            say "missing:$missing. Neither root nor sudo here; as root run: apt-get update && $command_line"
            exit 1
        fi
        as_root="sudo"
    fi
    say "installing$missing (${as_root:+$as_root }$command_line)"
    # apt-get says hundreds of lines when all is well: they are shown only when it fails.
    log="$(mktemp)"
    trap 'rm -f "$log"' EXIT
    if ! $as_root apt-get update >"$log" 2>&1; then
        cat "$log" >&2
        say "apt-get update failed (above)"
        exit 1
    fi
    # shellcheck disable=SC2086
    if ! $as_root env DEBIAN_FRONTEND=noninteractive $command_line >"$log" 2>&1; then
        cat "$log" >&2
        say "$command_line failed (above)"
        exit 1
    fi
    say "installed$missing"
fi

if ! has_command cargo; then
    say "Rust is not installed (no cargo on the PATH): see https://rustup.rs"
    exit 1
fi
