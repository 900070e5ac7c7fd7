# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A brick on the USB as a link; pyusb's devices are played, since there is no brick here."""

from __future__ import annotations

import errno
import socket
from collections.abc import Sequence

import pytest

from ravenbrick.errors import ToolMissingError
from ravenbrick.telemetry.links import LinkLostError, SocketLink, UsbLink, open_link

BRICK, OTHER = "00165300ABCD", "001653000001"


class Device:
    """What pyusb offers of a device, with packets that wait and errors that come."""

    def __init__(self, serial: str, packets: Sequence[bytes | OSError] = ()) -> None:
        self.serial_number = serial
        self.packets = list(packets)
        self.sent: list[tuple[int, bytes]] = []
        self.configured = False

    def set_configuration(self) -> None:
        """Claim the device."""
        self.configured = True

    def read(self, endpoint: int, size: int, timeout: int) -> bytes:
        """The next packet, or its error; afterwards nothing comes."""
        assert (endpoint, size) == (0x82, 64) and timeout >= 1
        found = self.packets.pop(0) if self.packets else OSError(errno.ETIMEDOUT, "timed out")
        if isinstance(found, OSError):
            raise found
        return found

    def write(self, endpoint: int, data: bytes, timeout: int) -> int:
        """Keep what is sent, if a slow brick has two seconds for it."""
        assert timeout == 2_000
        self.sent.append((endpoint, data))
        return len(data)


class SlowWire:
    """A socket whose other side needs a second for everything."""

    timeout_s = 2.0

    def settimeout(self, timeout_s: float) -> None:
        """How long to wait from now on."""
        self.timeout_s = timeout_s

    def _wait(self) -> None:
        if self.timeout_s < 1:
            raise TimeoutError

    def recv(self, size: int) -> bytes:
        """What comes after a second."""
        self._wait()
        return b"late"

    def sendall(self, data: bytes) -> None:
        """Taken after a second."""
        self._wait()


def test_a_connection_waits_as_long_as_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A short read comes back empty; a write is not cut short by the read before."""
    wire = SlowWire()
    monkeypatch.setattr(socket, "create_connection", lambda address, timeout: wire)
    link = SocketLink("127.0.0.1", 1)
    assert [link.read(0.05), link.read(1.5), link.read(0.05)] == [b"", b"late", b""]
    link.write(b"ask")


def test_the_other_side_sees_that_a_connection_was_closed() -> None:
    """At once, while the link is still there."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = SocketLink("127.0.0.1", server.getsockname()[1])
        other, _ = server.accept()
        with other:
            other.settimeout(60)
            link.write(b"stop")
            link.close()
            assert [other.recv(4), other.recv(4)] == [b"stop", b""]


def test_packets_of_the_wanted_brick_are_the_stream() -> None:
    """Among two bricks the serial number chooses; a packet that is late is not lost."""
    device = Device(BRICK, [b"one", b"two"])
    link = UsbLink(BRICK, lambda vendor, product: [Device(OTHER), device])
    assert device.configured
    link.write(b"ask")
    assert device.sent == [(1, b"ask")]
    assert [link.read(0.05), link.read(0.05), link.read(0.05)] == [b"one", b"two", b""]


def test_a_brick_that_leaves_is_a_lost_link() -> None:
    """The monitor then connects again."""
    gone = OSError(errno.ENODEV, "No such device")
    link = UsbLink("", lambda vendor, product: [Device(BRICK, [gone])])
    with pytest.raises(LinkLostError, match="the brick is no longer on the USB"):
        link.read(0.05)


def test_why_there_is_no_link_is_said() -> None:
    """No brick, not the wanted one, or one that may not be opened."""
    with pytest.raises(LinkLostError, match="no brick on the USB"):
        UsbLink("", lambda vendor, product: [])
    with pytest.raises(LinkLostError, match=f"no brick with the serial number {BRICK}"):
        UsbLink(BRICK, lambda vendor, product: [Device(OTHER)])

    def refuse(vendor: int, product: int) -> list[Device]:
        assert (vendor, product) == (0x0694, 0x0002)
        raise OSError(errno.EACCES, "Access denied")

    with pytest.raises(LinkLostError, match=r"Access denied.*ravenbrick doctor"):
        UsbLink("", refuse)


def test_the_library_itself_finds_no_brick_here() -> None:
    """pyusb is really asked; without libusb the package is named."""
    try:
        with pytest.raises(LinkLostError, match="no brick with the serial number FFFFFFFFFFFF"):
            open_link("usb:FFFFFFFFFFFF")
    except ToolMissingError as error:
        assert "libusb-1.0-0" in error.sentence
