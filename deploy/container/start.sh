#!/bin/sh
# Starts a root file system as a container would: `start.sh ROOTFS DATA_DIR [arguments of skyglow]`, as root. Namespaces of its own
# for mounts, processes and host name; the root read-only, /tmp in memory, the data folder on /var/lib/skyglow; user 10001 without
# capabilities. The network is the host's.
set -eu
root="$(realpath "${1:?usage: start.sh ROOTFS DATA_DIR [ARGUMENTS]}")"
data="$(realpath "${2:?usage: start.sh ROOTFS DATA_DIR [ARGUMENTS]}")"
shift 2
[ "$#" -gt 0 ] || set -- serve
chown 10001:10001 "$data"
export SKYGLOW_ROOT="$root" SKYGLOW_VOLUME="$data"
exec unshare --mount --pid --fork --uts --ipc --kill-child=TERM sh -eu -c '
    root="$SKYGLOW_ROOT"
    mount --make-rprivate /
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    mount -t tmpfs -o size=256m,mode=1777 tmpfs "$root/tmp"
    mount --rbind /dev "$root/dev"
    mount --bind "$SKYGLOW_VOLUME" "$root/var/lib/skyglow"
    mount -o remount,bind,ro "$root"
    cd "$root"
    exec chroot "$root" /usr/bin/setpriv --reuid=10001 --regid=10001 --clear-groups --no-new-privs --bounding-set=-all \
        --inh-caps=-all env -i PATH=/usr/local/bin:/usr/bin:/bin SKYGLOW_CONFIG=/etc/skyglow/skyglow.toml \
        XDG_RUNTIME_DIR=/tmp NODEVICE_SELECT=1 SKYGLOW_LISTEN="${SKYGLOW_LISTEN:-0.0.0.0:8080}" \
        SKYGLOW_DEVICE="${SKYGLOW_DEVICE:-auto}" /usr/local/bin/skyglow "$@"
' sh "$@"
