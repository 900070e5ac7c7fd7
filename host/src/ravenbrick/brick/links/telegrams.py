# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Connections of nxt-python to a brick, over the virtual air and the virtual cable.

They are what `nxt.brick.Brick` takes; nxt-python itself is not needed here.
"""

from __future__ import annotations

import struct

from ravenbrick.brick.links.peers import BluetoothComputer, UsbComputer

__all__ = ["BluetoothTelegrams", "UsbTelegrams"]


class BluetoothTelegrams:
    """Over the air: each telegram behind its length."""

    bsize = 118
    type = "bluetooth"

    def __init__(self, computer: BluetoothComputer) -> None:
        self._computer = computer
        computer.connect()

    def send(self, data: bytes) -> None:
        """Hand a telegram over."""
        self._computer.write(struct.pack("<H", len(data)) + data)

    def recv(self) -> bytes:
        """The brick's next telegram."""
        (length,) = struct.unpack("<H", self._computer.read(2))
        return self._computer.read(length)

    def close(self) -> None:
        """End the connection."""
        self._computer.close()


class UsbTelegrams:
    """Over the cable: a telegram is a transfer."""

    bsize = 60
    type = "usb"

    def __init__(self, computer: UsbComputer) -> None:
        self._computer = computer
        assert computer.enumerate() == (0x0694, 0x0002), "LEGO, NXT"

    def send(self, data: bytes) -> None:
        """Hand a telegram over."""
        self._computer.write(1, data)

    def recv(self) -> bytes:
        """The brick's next telegram."""
        return self._computer.read(2)

    def close(self) -> None:
        """End the connection."""
        pass
