# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The world at the brick's lines: a computer in range, a USB host, other bricks.

Each peer runs the brick when it has to wait, so a program that uses one is a deterministic run.
`brick` is a `virtual_brick.VirtualBrick`.
"""

from __future__ import annotations

import struct
from typing import Any, Protocol

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import PeerError

__all__ = [
    "BluetoothComputer",
    "BluetoothLink",
    "Rs485Line",
    "StreamPeer",
    "UsbComputer",
    "UsbStream",
]

STEP_MS = 1
CONNECT_MS = 60_000
READ_MS = 10_000
USB_MS = 2_000
USB_RESET_MS = 20
USB_ADDRESS = 5
USB_STREAM_MS = 3_600_000
BRICK_IDENTITY = (0x0694, 0x0002)
USB_PACKET = 64
USB_READS = 16
# Transfers of a stream are numbered from here on, those before it from 1.
STREAM_NUMBERS = 1_000_000
FROM_HOST, INTO_HOST = 1, 2
DEVICE_DESCRIPTOR = bytes([0x80, 6, 0, 1, 0, 0, 18, 0])


def _run(brick: Any, milliseconds: int) -> None:
    """Let time pass; raises PeerError when the run ends."""
    stop = brick.run_until(brick.cycles + MASTER_CLOCK.cycles_of_ms(milliseconds))
    if stop.reason != "reached":
        raise PeerError(f"the brick stopped while a peer waited: {stop.reason}: {stop.message}")


class StreamPeer(Protocol):
    """A computer that exchanges a stream of bytes with the program on the brick."""

    @property
    def connected(self) -> bool:
        """The stream is there."""

    def connect(self, timeout_ms: int = ...) -> None:
        """Begin; raises PeerError."""

    def write(self, data: bytes) -> None:
        """Bytes for the brick; raises PeerError."""

    def take(self) -> bytes:
        """What the brick has sent so far, without waiting."""

    def close(self) -> None:
        """End the stream."""


class BluetoothComputer:
    """A computer in range of the brick that opens a serial connection to it.

    `pin` is offered when the brick does not know the computer; a brick that knows it (its
    configuration: `bluetooth.known`) does not ask.
    """

    def __init__(
        self,
        brick: Any,
        address: str = "00:1A:7D:00:00:01",
        name: str = "computer",
        pin: str | None = None,
    ) -> None:
        self._brick, self.address, self._name, self._pin = brick, address, name, pin
        self._connected = False
        self._received = bytearray()
        brick.bluetooth_send(brick.cycles, address, "in_range", name=name)

    @property
    def connected(self) -> bool:
        """The connection stands."""
        return self._connected

    def page(self) -> None:
        """Ask for the connection, without waiting."""
        self._brick.bluetooth_send(
            self._brick.cycles, self.address, "page", name=self._name, pin=self._pin
        )

    def connect(self, timeout_ms: int = CONNECT_MS) -> None:
        """Open the connection. Raises PeerError when the brick refuses or does not answer."""
        self.page()
        for _ in range(0, timeout_ms, STEP_MS):
            _run(self._brick, STEP_MS)
            kinds = self.collect()
            if "refuse" in kinds:
                raise PeerError(f"the brick refuses a connection with {self.address}")
            if self._connected:
                return
        raise PeerError(f"the brick did not answer {self.address} in {timeout_ms} ms")

    def collect(self) -> list[str]:
        """Take what the brick has sent so far; the kinds of the signals."""
        kinds = []
        for _, peer, kind, data, _, _ in self._brick.bluetooth_sent():
            if peer != self.address:
                continue
            kinds.append(kind)
            self._received += data
            if kind in ("accept", "close"):
                self._connected = kind == "accept"
        return kinds

    def write(self, data: bytes) -> None:
        """Bytes for the brick. Raises PeerError without a connection."""
        if not self._connected:
            raise PeerError(f"{self.address} is not connected with the brick; connect first")
        self._brick.bluetooth_send(self._brick.cycles, self.address, "data", bytes(data))

    def read(self, count: int, timeout_ms: int = READ_MS) -> bytes:
        """So many bytes from the brick. Raises PeerError when they do not come."""
        for _ in range(0, timeout_ms, STEP_MS):
            self.collect()
            if len(self._received) >= count:
                data = bytes(self._received[:count])
                del self._received[:count]
                return data
            if not self._connected:
                raise PeerError(f"the connection of {self.address} has ended")
            _run(self._brick, STEP_MS)
        raise PeerError(f"the brick sent {len(self._received)} of {count} bytes in {timeout_ms} ms")

    def take(self) -> bytes:
        """Whatever the brick has sent so far, without waiting."""
        self.collect()
        data = bytes(self._received)
        self._received.clear()
        return data

    def hang_up(self) -> None:
        """End the connection, without waiting; does nothing without one."""
        if self._connected:
            self._brick.bluetooth_send(self._brick.cycles, self.address, "close")
            self._connected = False

    def close(self) -> None:
        """End the connection; does nothing without one."""
        if self._connected:
            self.hang_up()
            _run(self._brick, STEP_MS)


class UsbComputer:
    """A USB host whose cable is plugged into the brick."""

    def __init__(self, brick: Any) -> None:
        self._brick = brick
        self._number = 0
        self._others: list[tuple[int, bytes | None, str | None]] = []
        brick.schedule_input(brick.cycles, "usb.plugged", 1)

    def enumerate(self, timeout_ms: int = READ_MS) -> tuple[int, int]:
        """Reset, address, configuration 1; vendor and product of the device.

        Raises PeerError when there is none.
        """
        for _ in range(0, timeout_ms, STEP_MS):
            if self._brick.usb_attached:
                break
            _run(self._brick, STEP_MS)
        else:
            raise PeerError(f"no device on the cable in {timeout_ms} ms")
        self.transfer("reset")
        _run(self._brick, USB_RESET_MS)
        self.control(bytes([0, 5, USB_ADDRESS, 0, 0, 0, 0, 0]))
        descriptor = self.control(DEVICE_DESCRIPTOR)
        self.control(bytes([0, 9, 1, 0, 0, 0, 0, 0]))
        vendor, product = struct.unpack_from("<HH", descriptor.ljust(12, b"\0"), 8)
        return vendor, product

    def control(self, request: bytes) -> bytes:
        """A control transfer; `request` is 8 bytes and the data for the device."""
        return self.transfer("control", data=request)

    def write(self, endpoint: int, data: bytes) -> None:
        """Bytes to a bulk endpoint."""
        self.transfer("out", endpoint, data)

    def read(self, endpoint: int, length: int = 64) -> bytes:
        """Bytes from a bulk endpoint, up to a packet that is not full."""
        return self.transfer("in", endpoint, length=length)

    def transfer(self, kind: str, endpoint: int = 0, data: bytes = b"", length: int = 0) -> bytes:
        """A transfer from begin to end. Raises PeerError when it fails."""
        begun = self.begin(kind, endpoint, data, length)
        while True:
            _run(self._brick, STEP_MS)
            completed = self._brick.usb_completed()
            others = [other for other in completed if other[1] != begun]
            self._others += [(number, data, failure) for _, number, data, failure in others]
            for _, _, received, failure in (one for one in completed if one[1] == begun):
                if received is None:
                    raise PeerError(f"USB {kind} transfer on endpoint {endpoint}: {failure}")
                return bytes(received)

    def begin(
        self,
        kind: str,
        endpoint: int = 0,
        data: bytes = b"",
        length: int = 0,
        timeout_ms: int = USB_MS,
    ) -> int:
        """Begin a transfer without waiting for it; its number."""
        self._number += 1
        timeout_cycles = MASTER_CLOCK.cycles_of_ms(timeout_ms)
        self._brick.usb_transfer(
            self._brick.cycles, self._number, timeout_cycles, kind, endpoint, data, length
        )
        return self._number

    def ended(self) -> list[tuple[int, bytes | None, str | None]]:
        """Number, bytes and failure of transfers of `begin` that have ended since the last call."""
        ended, self._others = self._others, []
        completed = self._brick.usb_completed()
        return ended + [(number, data, failure) for _, number, data, failure in completed]


class UsbStream:
    """A USB host that takes the brick's bulk endpoints for a stream of bytes, as telemetry does.

    Only `connect` and `close` run the brick; meanwhile reads wait for its next packets.
    """

    def __init__(self, brick: Any) -> None:
        self._brick = brick
        self._computer: UsbComputer | None = None
        self._number = 0
        self._reading: set[int] = set()
        self._configured = False
        self._received = bytearray()

    @property
    def connected(self) -> bool:
        """The host has configured the brick, which is still on the bus."""
        return self._configured and bool(self._brick.usb_attached)

    def connect(self, timeout_ms: int = READ_MS) -> None:
        """Plug the cable in and enumerate. Raises PeerError when there is no brick."""
        self._computer = self._computer or UsbComputer(self._brick)
        vendor, product = self._computer.enumerate(timeout_ms)
        if (vendor, product) != BRICK_IDENTITY:
            raise PeerError(f"the device on the cable is {vendor:04x}:{product:04x}, not a brick")
        self._received.clear()
        self._configured = True
        self._number = STREAM_NUMBERS
        self._reading = {self._read() for _ in range(USB_READS)}

    def write(self, data: bytes) -> None:
        """Bytes for the brick, which takes them when it can. Raises PeerError when it is gone."""
        if not self.connected:
            raise PeerError("the brick is not on the cable; connect first")
        self._begin("out", FROM_HOST, data=bytes(data))

    def take(self) -> bytes:
        """Whatever the brick has sent so far, without waiting."""
        for _, number, received, failure in self._brick.usb_completed():
            if failure is not None:
                self._configured = False
            elif number in self._reading:
                self._received += received
                self._reading.remove(number)
                self._reading.add(self._read())
        data = bytes(self._received)
        self._received.clear()
        return data

    def close(self) -> None:
        """Pull the cable out; does nothing when it is not in."""
        if self._computer is not None:
            self._brick.schedule_input(self._brick.cycles, "usb.plugged", 0)
            self._computer, self._configured = None, False
            _run(self._brick, STEP_MS)

    def _read(self) -> int:
        return self._begin("in", INTO_HOST, length=USB_PACKET)

    def _begin(self, kind: str, endpoint: int, data: bytes = b"", length: int = 0) -> int:
        self._number += 1
        timeout_cycles = MASTER_CLOCK.cycles_of_ms(USB_STREAM_MS)
        self._brick.usb_transfer(
            self._brick.cycles, self._number, timeout_cycles, kind, endpoint, data, length
        )
        return self._number


class BluetoothLink:
    """Two bricks in range of each other; deterministic.

    A signal takes `LATENCY_MS` through the air, and the bricks run in turn for that long, so
    what one sends always lies in the other's future.
    """

    LATENCY_MS = 5

    def __init__(self, first: Any, second: Any) -> None:
        self._bricks = (first, second)
        self._addresses = tuple(brick.bluetooth_device()[0] for brick in self._bricks)
        if self._addresses[0] == self._addresses[1]:
            raise PeerError(
                f"both bricks have the Bluetooth address {self._addresses[0]}; "
                "give one of them another in its configuration"
            )
        self._seen: list[tuple[str, bool] | None] = [None, None]
        self._ended: list[Any] = [None, None]
        self.lost: list[tuple[int, str]] = []

    def run_until(self, cycles: int) -> tuple[Any, Any]:
        """Run both bricks to `cycles`; their stops. A brick whose run has ended stays behind."""
        quantum = MASTER_CLOCK.cycles_of_ms(self.LATENCY_MS)
        running = [i for i in (0, 1) if self._ended[i] is None]
        now = min((self._bricks[i].cycles for i in running), default=cycles)
        while True:
            now = min(now + quantum, cycles)
            self._introduce()
            stops = [self._run(index, now) for index in (0, 1)]
            for index in (0, 1):
                self._carry(index, quantum)
            if now >= cycles:
                return stops[0], stops[1]

    def _run(self, index: int, cycles: int) -> Any:
        if self._ended[index] is not None:
            return self._ended[index]
        stop = self._bricks[index].run_until(cycles)
        if stop.reason != "reached":
            self._ended[index] = stop
        return stop

    def _introduce(self) -> None:
        """Tell each brick how the other is seen in an inquiry, when that has changed."""
        for index, other in ((0, 1), (1, 0)):
            address, name, discoverable = self._bricks[other].bluetooth_device()
            if self._seen[other] == (name, discoverable):
                continue
            self._seen[other] = (name, discoverable)
            brick = self._bricks[index]
            kind = "in_range" if discoverable else "out_of_range"
            brick.bluetooth_send(brick.cycles, address, kind, name=name)

    def _carry(self, sender: int, latency_cycles: int) -> None:
        other = 1 - sender
        brick = self._bricks[other]
        for at_cycles, peer, kind, data, name, pin in self._bricks[sender].bluetooth_sent():
            if peer != self._addresses[other]:
                self.lost.append((at_cycles, peer))
                continue
            arrival = max(at_cycles + latency_cycles, brick.cycles)
            brick.bluetooth_send(arrival, self._addresses[sender], kind, data, name, pin)


class Rs485Line:
    """Bricks on one RS485 line at their ports 4; deterministic.

    The bricks run in turn for `QUANTUM_US`, and what one sends reaches the others that much later.
    Two that send at once destroy what both say only where they hear it: a brick that sends hears
    nothing. `bit_cycles` is the length of a bit that the bricks have agreed on.
    """

    QUANTUM_US = 100
    CHARACTER_BITS = 10

    def __init__(self, *bricks: Any, bit_cycles: int = 52) -> None:
        self._bricks = bricks
        self._bit_cycles = bit_cycles

    def run_until(self, cycles: int) -> tuple[Any, ...]:
        """Run all bricks to `cycles`; their stops. A brick whose run has ended stays behind."""
        quantum = MASTER_CLOCK.cycles_of_us(self.QUANTUM_US)
        now = min(brick.cycles for brick in self._bricks)
        while True:
            now = min(now + quantum, cycles)
            stops = tuple(brick.run_until(now) for brick in self._bricks)
            for sender in self._bricks:
                self._carry(sender, quantum)
            if now >= cycles:
                return stops

    def _carry(self, sender: Any, latency_cycles: int) -> None:
        length = self.CHARACTER_BITS * self._bit_cycles
        for ended_cycles, byte in sender.rs485_sent():
            begin = ended_cycles + latency_cycles - length
            for brick in self._bricks:
                if brick is not sender:
                    brick.rs485_send(max(begin, brick.cycles), bytes([byte]), self._bit_cycles)
