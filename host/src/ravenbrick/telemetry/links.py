# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Byte streams to a brick: a serial device or pseudo-terminal, a TCP socket, or its USB."""

from __future__ import annotations

import errno
import importlib
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import serial

from ravenbrick.errors import ToolMissingError, UsageError
from ravenbrick.hardware.usb_bricks import BrickMode
from ravenbrick.installation import advice_for_packages

__all__ = ["Link", "LinkLostError", "check_address", "open_link"]

_CONNECT_S = 2.0
_CHUNK = 4096
_FROM_HOST, _INTO_HOST = 0x01, 0x82
_PACKET = 64


class LinkLostError(Exception):
    """The other side is gone; the text says how it was noticed."""


class Link(Protocol):
    """A connection that carries bytes both ways."""

    def read(self, timeout_s: float) -> bytes:
        """What arrived, after at most so long; raises `LinkLostError`."""

    def write(self, data: bytes) -> None:
        """Send all; raises `LinkLostError`."""

    def close(self) -> None:
        """Let go."""


class SerialLink:
    """A serial device: of a Bluetooth serial port (rfcomm), or a pseudo-terminal."""

    def __init__(self, device: str) -> None:
        try:
            self._port = serial.Serial(device, timeout=0, write_timeout=_CONNECT_S)
        except (serial.SerialException, OSError, ValueError) as error:
            raise LinkLostError(f"{device} cannot be opened: {error}") from None

    def read(self, timeout_s: float) -> bytes:
        """What arrived, after at most so long."""
        try:
            self._port.timeout = timeout_s
            first: bytes = self._port.read(1)
            return first + self._port.read(min(self._port.in_waiting, _CHUNK)) if first else b""
        except (serial.SerialException, OSError) as error:
            raise LinkLostError(f"the serial device is gone: {error}") from None

    def write(self, data: bytes) -> None:
        """Send all."""
        try:
            self._port.write(data)
        except (serial.SerialException, OSError) as error:
            raise LinkLostError(f"nothing can be sent: {error}") from None

    def close(self) -> None:
        """Let go of the device."""
        self._port.close()


class SocketLink:
    """A TCP connection, as the virtual brick offers it on this computer."""

    def __init__(self, host: str, port: int) -> None:
        try:
            self._socket = socket.create_connection((host, port), timeout=_CONNECT_S)
        except OSError as error:
            raise LinkLostError(f"no connection to {host}:{port}: {error}") from None

    def read(self, timeout_s: float) -> bytes:
        """What arrived, after at most so long."""
        self._socket.settimeout(timeout_s)
        try:
            data = self._socket.recv(_CHUNK)
        except TimeoutError:
            return b""
        except OSError as error:
            raise LinkLostError(f"the connection broke: {error}") from None
        if not data:
            raise LinkLostError("the other side closed the connection")
        return data

    def write(self, data: bytes) -> None:
        """Send all."""
        self._socket.settimeout(_CONNECT_S)
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise LinkLostError(f"nothing can be sent: {error}") from None

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


def _find_on_usb(vendor: int, product: int) -> list[Any]:
    """Devices as pyusb sees them; raises `ToolMissingError` without libusb."""
    core = importlib.import_module("usb.core")
    try:
        return list(core.find(find_all=True, idVendor=vendor, idProduct=product))
    except core.NoBackendError:
        raise ToolMissingError(
            f"the library libusb is not installed; {advice_for_packages(['libusb-1.0-0'])}"
        ) from None


class UsbLink:
    """The bulk endpoints of a brick on the USB; `serial_number` may be empty for any brick."""

    def __init__(
        self, serial_number: str, find: Callable[[int, int], list[Any]] = _find_on_usb
    ) -> None:
        vendor, product = (int(part, 16) for part in BrickMode.FIRMWARE.identity.split(":"))
        try:
            bricks = find(vendor, product)
            fitting = [b for b in bricks if serial_number in ("", b.serial_number)]
            if not fitting:
                wanted = f" with the serial number {serial_number}" if serial_number else ""
                raise LinkLostError(f"no brick{wanted} on the USB")
            self._brick = fitting[0]
            self._brick.set_configuration()
        except (OSError, ValueError) as error:
            raise LinkLostError(
                f"the brick on the USB cannot be opened: {error}; see 'ravenbrick doctor'"
            ) from None

    def read(self, timeout_s: float) -> bytes:
        """The next packet, after at most so long."""
        try:
            return bytes(self._brick.read(_INTO_HOST, _PACKET, max(1, round(1000 * timeout_s))))
        except OSError as error:
            if error.errno == errno.ETIMEDOUT:
                return b""
            raise LinkLostError(f"the brick is no longer on the USB: {error}") from None

    def write(self, data: bytes) -> None:
        """Send all."""
        try:
            self._brick.write(_FROM_HOST, data, round(1000 * _CONNECT_S))
        except OSError as error:
            raise LinkLostError(f"nothing can be sent: {error}") from None

    def close(self) -> None:
        """Let go of the brick."""
        importlib.import_module("usb.util").dispose_resources(self._brick)


def _tcp_address(text: str) -> tuple[str, int]:
    host, _, port = text.removeprefix("tcp:").rpartition(":")
    if not port.isdigit() or not 0 < int(port) < 65_536:
        raise UsageError(f"'{text}': expected tcp:PORT or tcp:HOST:PORT, the port 1 to 65535")
    return host or "127.0.0.1", int(port)


def check_address(text: str) -> None:
    """Raise `UsageError` for what no link can be to; a device in /dev may still come."""
    if text.startswith("tcp:"):
        _tcp_address(text)
        return
    path = Path(text)
    if text == "usb" or text.startswith(("usb:", "/dev/")) or path.is_char_device():
        return
    kind = "a folder" if path.is_dir() else "a file" if path.exists() else "not a device"
    raise UsageError(
        f"'{text}' is {kind}: expected tcp:PORT, tcp:HOST:PORT, usb, usb:SERIAL, a serial device "
        "such as /dev/rfcomm0, or a record that ends in .rbt"
    )


def open_link(address: str) -> Link:
    """Connect to `tcp:PORT`, `tcp:HOST:PORT`, `usb`, `usb:SERIAL` or a device's path.

    Raises `LinkLostError`.
    """
    if address.startswith("tcp:"):
        return SocketLink(*_tcp_address(address))
    if address == "usb" or address.startswith("usb:"):
        return UsbLink(address.removeprefix("usb").removeprefix(":"))
    return SerialLink(address)
