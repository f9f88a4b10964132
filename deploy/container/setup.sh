#!/bin/sh
# What the image consists of beside the program: run as root inside a bare Debian 12, by the Containerfile and by
# rootfs.sh alike. Libraries for rasters, the Vulkan loader, Mesa's lavapipe, a user without rights, the folder of the data.
set -eu

export DEBIAN_FRONTEND=noninteractive
apt-get update -q
apt-get install -y -q --no-install-recommends libgdal32 libvulkan1 mesa-vulkan-drivers
# Drivers of graphics cards that a container without one never loads.
find /usr/share/vulkan/icd.d -name '*.json' ! -name 'lvp_icd*' -delete
find /usr/lib -name 'libvulkan_intel*.so' -delete -o -name 'libvulkan_radeon*.so' -delete
# What nothing here reads.
rm -rf /var/lib/apt/lists/* /var/cache/apt/* /usr/share/doc/* /usr/share/man/* /usr/share/locale/* /usr/share/info/*
find /var/log -type f -delete

groupadd --system --gid 10001 skyglow
useradd --system --uid 10001 --gid skyglow --home-dir /var/lib/skyglow --shell /usr/sbin/nologin skyglow
install -d -o skyglow -g skyglow /var/lib/skyglow
install -d /usr/local/share/skyglow/precomputed /etc/skyglow
