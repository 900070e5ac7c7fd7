# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2034
# What the project needs from outside. Python packages are pinned in tools/requirements/,
# Rust crates in virtual-brick/Cargo.lock.
DEBIAN_PACKAGES=(
    gnat-12-arm-linux-gnueabi
    gcc-arm-none-eabi
    libnewlib-arm-none-eabi
    gdb-multiarch
    gprbuild
    libnxt
    libusb-1.0-0
    python3-venv
    gcc
    libc6-dev
    make
    bubblewrap
)
# Only tests need these.
DEVELOP_PACKAGES=(
    chromium-headless-shell
    gappa
    git
    gtkwave
    nbc
    nxt-firmware
    openocd
)
RUST_MINIMUM=1.86.0
RUST_PACKAGES=(rustc-web cargo-web)
# Tests and style checks need these where the commands npm and cargo-clippy are missing.
NODE_PACKAGES=(nodejs npm)
CLIPPY_PACKAGES=(rust-web-clippy rustfmt-web)
PYTHON=/usr/bin/python3
# The page is built with this Rust alone, so that anyone gets the same bytes.
PAGE_RUST=1.95.0
