# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's USB device for host tools: a USB/IP server on this computer.

USB/IP is the protocol of Linux for devices that are plugged in elsewhere (kernel documentation,
usb/usbip_protocol; version 1.1.1, all numbers big endian). With `usbip attach` the virtual brick
becomes a device of this computer, under the identity that its program gives it: LEGO's, the boot
monitor's, or another. One host at a time; nothing here waits.
"""

from __future__ import annotations

import socket
import struct
from dataclasses import dataclass
from typing import Any

from ravenbrick.brick.links.byte_ports import listening_socket, waiting_client
from ravenbrick.brick.links.peers import DEVICE_DESCRIPTOR, UsbComputer
from ravenbrick.errors import PeerError

__all__ = ["UsbIpServer"]

_VERSION = 0x0111
_REQUEST_LIST, _REPLY_LIST = 0x8005, 0x0005
_REQUEST_IMPORT, _REPLY_IMPORT = 0x8003, 0x0003
_SUBMIT, _UNLINK, _SUBMITTED, _UNLINKED = 1, 2, 3, 4
_BUS_ID = b"1-1"
_HEADER = struct.Struct(">HHI")
_COMMAND = struct.Struct(">IIIIIIIIII8s")
_FULL_SPEED = 2
_SET_ADDRESS = bytes([0, 5])
_NO_ISOCHRONOUS_PACKETS = 0xFFFF_FFFF

_PENDING_MOST = 64
_TRANSFER_MOST = 65_536
_WAITING_MOST = 4 * _TRANSFER_MOST
_CHUNK = 65_536
_IN_MS = 500
_OUT_MS = 10_000

# Numbers of Linux's errors, as the protocol uses them.
_STALLED, _PROTOCOL_ERROR, _TIMED_OUT, _UNLINKED_IN_TIME = -32, -71, -110, -104
_FAILURES = {"stalled": _STALLED, "timed_out": _TIMED_OUT}


class _RefusedError(Exception):
    """The host breaks the protocol or asks for too much; it is let go."""


@dataclass
class _Request:
    """A transfer that the host has asked for."""

    sequence: int
    endpoint: int
    incoming: bool
    length: int
    unlinked: bool = False


class UsbIpServer:
    """A listening socket on 127.0.0.1 in front of a brick's USB."""

    def __init__(self, port: int) -> None:
        self._server = listening_socket(port, any_port="0")
        self.port: int = self._server.getsockname()[1]
        self._client: socket.socket | None = None
        self._received, self._unsent = bytearray(), bytearray()
        self._computer: UsbComputer | None = None
        self._attached = False
        self._pending: dict[int, _Request] = {}

    def exchange(self, brick: Any) -> None:
        """Pass on what has come from the host and from the brick."""
        if self._computer is None:
            self._computer = UsbComputer(brick)
        if not self._accept():
            self._computer.ended()
            return
        try:
            self._receive()
            self._serve(brick, self._computer)
            self._answer(self._computer)
            self._send()
        except (_RefusedError, OSError):
            self._drop()

    def close(self) -> None:
        """No more hosts."""
        self._drop()
        self._server.close()

    def _accept(self) -> bool:
        if self._client is None:
            self._client = waiting_client(self._server)
        return self._client is not None

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client, self._attached = None, False
        self._received.clear()
        self._unsent.clear()
        for request in self._pending.values():
            request.unlinked = True

    def _receive(self) -> None:
        if self._client is None or len(self._received) > _WAITING_MOST:
            return
        try:
            data = self._client.recv(_CHUNK)
        except BlockingIOError:
            return
        if not data:
            raise _RefusedError
        self._received += data

    def _send(self) -> None:
        if self._client is None or not self._unsent:
            return
        try:
            sent = self._client.send(self._unsent)
        except BlockingIOError:
            sent = 0
        del self._unsent[:sent]
        if len(self._unsent) > _WAITING_MOST:
            raise _RefusedError

    def _take(self, count: int) -> bytes:
        data = bytes(self._received[:count])
        del self._received[:count]
        return data

    def _serve(self, brick: Any, computer: UsbComputer) -> None:
        while self._client is not None:
            if self._attached:
                if not self._command(computer):
                    return
            elif len(self._received) < _HEADER.size or not self._request(brick, computer):
                return

    def _request(self, brick: Any, computer: UsbComputer) -> bool:
        """A request before a device is attached; false while it has not come whole."""
        version, code, _ = _HEADER.unpack_from(self._received)
        if version != _VERSION or code not in (_REQUEST_LIST, _REQUEST_IMPORT):
            raise _RefusedError
        length = _HEADER.size + (32 if code == _REQUEST_IMPORT else 0)
        if len(self._received) < length:
            return False
        wanted = self._take(length)[_HEADER.size :].rstrip(b"\0")
        device = _device(brick, computer)
        if code == _REQUEST_LIST:
            self._unsent += _HEADER.pack(_VERSION, _REPLY_LIST, 0)
            self._unsent += struct.pack(">I", 1 if device else 0)
            self._unsent += b"".join(device) if device else b""
            return True
        self._attached = device is not None and wanted == _BUS_ID
        self._unsent += _HEADER.pack(_VERSION, _REPLY_IMPORT, 0 if self._attached else 1)
        self._unsent += device[0] if device and self._attached else b""
        return True

    def _command(self, computer: UsbComputer) -> bool:
        """A command for the attached device; false while it has not come whole."""
        if len(self._received) < _COMMAND.size:
            return False
        fields = _COMMAND.unpack_from(self._received)
        command, sequence, _, direction, endpoint, _, length = fields[:7]
        if command == _UNLINK:
            self._take(_COMMAND.size)
            self._unlink(sequence, victim=fields[5])
            return True
        if command != _SUBMIT or length > _TRANSFER_MOST or endpoint > 15 or direction > 1:
            raise _RefusedError
        outgoing = 0 if direction else length
        if len(self._received) < _COMMAND.size + outgoing:
            return False
        self._take(_COMMAND.size)
        request = _Request(sequence, endpoint, bool(direction), length)
        self._submit(computer, request, fields[10], self._take(outgoing))
        return True

    def _submit(self, computer: UsbComputer, request: _Request, setup: bytes, data: bytes) -> None:
        if len(self._pending) >= _PENDING_MOST:
            raise _RefusedError
        if request.endpoint == 0 and setup[:2] == _SET_ADDRESS:
            # The cable's own host has given the device its address.
            return self._reply(request, 0, b"")
        if request.endpoint == 0:
            number = computer.begin("control", data=setup + data, timeout_ms=_OUT_MS)
        elif request.incoming:
            number = self._begin_in(computer, request)
        else:
            number = computer.begin("out", request.endpoint, data, timeout_ms=_OUT_MS)
        self._pending[number] = request
        return None

    @staticmethod
    def _begin_in(computer: UsbComputer, request: _Request) -> int:
        return computer.begin("in", request.endpoint, length=request.length, timeout_ms=_IN_MS)

    def _unlink(self, sequence: int, victim: int) -> None:
        found = [r for r in self._pending.values() if r.sequence == victim and not r.unlinked]
        for request in found:
            request.unlinked = True
        status = _UNLINKED_IN_TIME if found else 0
        self._unsent += struct.pack(">IIIIIi24x", _UNLINKED, sequence, 0, 0, 0, status)

    def _answer(self, computer: UsbComputer) -> None:
        for number, data, failure in computer.ended():
            request = self._pending.pop(number, None)
            if request is None or request.unlinked:
                continue
            if failure == "timed_out" and request.incoming and request.endpoint:
                # The host waits for as long as it likes.
                self._pending[self._begin_in(computer, request)] = request
            elif failure is not None:
                self._reply(request, _FAILURES.get(failure, _PROTOCOL_ERROR), b"")
            else:
                self._reply(request, 0, data or b"")

    def _reply(self, request: _Request, status: int, data: bytes) -> None:
        data = data[: request.length] if request.incoming else b""
        length = len(data) if request.incoming else (request.length if status == 0 else 0)
        self._unsent += struct.pack(
            ">IIIIIiIIII8x",
            _SUBMITTED,
            request.sequence,
            0,
            0,
            0,
            status,
            length,
            0,
            _NO_ISOCHRONOUS_PACKETS,
            0,
        )
        self._unsent += data


def _device(brick: Any, computer: UsbComputer) -> tuple[bytes, bytes] | None:
    """The record of the device and those of its interfaces; none while there is no device."""
    if not brick.usb_attached:
        return None
    try:
        computer.enumerate()
        device = computer.control(DEVICE_DESCRIPTOR)
        configuration = computer.control(bytes([0x80, 6, 0, 2, 0, 0, 255, 0]))
    except PeerError:
        return None
    if len(device) < 18 or len(configuration) < 9:
        return None
    vendor, product, release = struct.unpack_from("<HHH", device, 8)
    interfaces = _interfaces(configuration)
    record = b"/virtual-brick/1-1".ljust(256, b"\0") + _BUS_ID.ljust(32, b"\0")
    record += struct.pack(">IIIHHH", 1, 1, _FULL_SPEED, vendor, product, release)
    record += device[4:7] + bytes([configuration[5], device[17], len(interfaces)])
    return record, b"".join(kind + b"\0" for kind in interfaces)


def _interfaces(configuration: bytes) -> list[bytes]:
    """Class, subclass and protocol of each interface of a configuration descriptor."""
    found, at = [], 0
    while at + 9 <= len(configuration) and configuration[at]:
        if configuration[at + 1] == 4 and configuration[at + 3] == 0:
            found.append(configuration[at + 5 : at + 8])
        at += configuration[at]
    return found
