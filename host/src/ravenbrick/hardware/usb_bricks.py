# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bricks on the USB, as the Linux kernel lists them (/sys/bus/usb/devices, no library needed)."""

from __future__ import annotations

import os
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

__all__ = ["UDEV_RULE", "BrickMode", "UsbBrick", "find_bricks"]

_DEVICES = Path("/sys/bus/usb/devices")
_NODES = Path("/dev/bus/usb")

UDEV_RULE = "tools/udev/70-ravenbrick.rules"
"""Lets users at the computer open a brick."""


class BrickMode(Enum):
    """Who answers on the USB: vendor and product numbers, and what to call it."""

    FIRMWARE = "0694:0002", "running LEGO's or another firmware"
    BOOT_MONITOR = "03eb:6124", "waiting in its boot monitor"

    @property
    def identity(self) -> str:
        """Vendor and product in hexadecimal digits."""
        return self.value[0]

    @property
    def words(self) -> str:
        """How to say it."""
        return self.value[1]


@dataclass(frozen=True)
class UsbBrick:
    """A brick on the bus; `usable` when this user may open its device node."""

    mode: BrickMode
    node: Path
    serial: str
    usable: bool


def _read(folder: Path, name: str) -> str:
    try:
        return (folder / name).read_text("utf-8", "replace").strip()
    except OSError:
        return ""


def find_bricks(devices: Path = _DEVICES, nodes: Path = _NODES) -> list[UsbBrick]:
    """All bricks on the bus, in the order of their names; none where the kernel has no USB."""
    modes = {mode.identity: mode for mode in BrickMode}
    found = []
    for folder in sorted(devices.iterdir()) if devices.is_dir() else []:
        mode = modes.get(f"{_read(folder, 'idVendor')}:{_read(folder, 'idProduct')}")
        bus, number = _read(folder, "busnum"), _read(folder, "devnum")
        if mode is None or not (bus.isdigit() and number.isdigit()):
            continue
        node = nodes / f"{int(bus):03d}" / f"{int(number):03d}"
        usable = os.access(node, os.R_OK | os.W_OK)
        found.append(UsbBrick(mode, node, _read(folder, "serial"), usable))
    return found
