# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The sockets of a live brick: host tools on its USB, and peers that mean no good."""

from __future__ import annotations

import random
import resource
import socket
import struct
import threading
from collections.abc import Callable
from typing import Any

import nxt.brick
import pytest
from verification.support.bricks.nxt_firmware import brick_at_the_menu, firmware_brick, run_ms

from ravenbrick.brick.links.byte_ports import TcpPort
from ravenbrick.brick.links.live import LiveRecord, LiveRun, replay_live
from ravenbrick.brick.links.usbip import UsbIpServer

LIST = struct.pack(">HHI", 0x0111, 0x8005, 0)
IMPORT = struct.pack(">HHI32s", 0x0111, 0x8003, 0, b"1-1")
GROWTH_MOST_KB = 64 * 1024
LONGEST_S = 300


class Host:
    """A USB host on the other side of USB/IP; nxt-python's way to a brick."""

    bsize = 60
    type = "usb"

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=LONGEST_S)
        self._sequence = 0

    def exactly(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            piece = self._socket.recv(count - len(data))
            assert piece, "the server hung up"
            data += piece
        return data

    def identity(self) -> tuple[int, int] | None:
        """Vendor and product of the device that is offered."""
        self._socket.sendall(LIST)
        assert self.exactly(8) == struct.pack(">HHI", 0x0111, 5, 0)
        if self.exactly(4) == bytes(4):
            return None
        record = self.exactly(312)
        assert record[256:260] == b"1-1\0"
        self.exactly(4 * record[311])
        vendor, product = struct.unpack_from(">HH", record, 300)
        return vendor, product

    def wait_for_device(self) -> tuple[int, int]:
        """Its identity, as soon as the program has switched its pull-up on."""
        while (identity := self.identity()) is None:
            pass
        return identity

    def attach(self) -> None:
        self._socket.sendall(IMPORT)
        assert self.exactly(8) == struct.pack(">HHI", 0x0111, 3, 0)
        self.exactly(312)

    def submit(self, endpoint: int, incoming: bool, data: bytes = b"", length: int = 0) -> bytes:
        """A transfer from begin to end."""
        self._sequence += 1
        size = length if incoming else len(data)
        head = (1, self._sequence, 0x0001_0001, int(incoming), endpoint, 0, size, 0, 0xFFFF_FFFF, 0)
        self._socket.sendall(struct.pack(">10I8x", *head) + data)
        answer = self.exactly(48)
        command, sequence = struct.unpack_from(">II", answer)
        status, actual = struct.unpack_from(">iI", answer, 20)
        assert (command, sequence, status) == (3, self._sequence, 0)
        return self.exactly(actual) if incoming else b""

    def send(self, data: bytes) -> None:
        self.submit(1, incoming=False, data=data)

    def recv(self) -> bytes:
        return self.submit(2, incoming=True, length=64)

    def close(self) -> None:
        self._socket.close()


class Turns:
    """The brick runs when its client lets it: neither's speed changes what happens between them."""

    def __init__(self) -> None:
        self._given, self._taken = threading.Semaphore(0), threading.Semaphore(0)
        self._free = False

    def give(self, count: int) -> None:
        """Let the brick run so many times 5 ms."""
        for _ in range(count):
            self._given.release()
            self._taken.acquire()

    def give_all(self) -> None:
        """Let the brick run on."""
        self._free = True
        self._given.release()

    def take(self) -> None:
        """Wait for a turn."""
        if not self._free:
            self._given.acquire()
            self._taken.release()


def played(
    brick: Any, work: Callable[[int, int], Any], turn: Callable[[], None] = lambda: None
) -> tuple[Any, LiveRecord]:
    """What `work` gives, done from outside with the ports of USB and Bluetooth of a live brick."""

    def over() -> bool:
        turn()
        return not client.is_alive()

    port, usb, record = TcpPort(0), UsbIpServer(0), LiveRecord("none")
    live = LiveRun(brick, port, record, "1234", speed=0, usb_ip=usb)
    results: list[Any] = []
    number = int(port.address.partition(":")[2])
    client = threading.Thread(target=lambda: results.append(work(usb.port, number)), daemon=True)
    client.start()
    try:
        stopped = live.run(None, stop=over)
    finally:
        port.close()
        usb.close()
    assert stopped.reason == "reached"
    assert results, "the client failed"
    return results[0], record


def test_nxt_python_speaks_over_usb_ip_with_the_lego_identity_and_replay_is_the_same() -> None:
    def work(usb: int, _: int) -> Any:
        host = Host(usb)
        identity = host.wait_for_device()
        host.attach()
        with nxt.brick.Brick(host) as remote:
            return identity, remote.get_device_info()[0], remote.get_firmware_version()

    brick = brick_at_the_menu()
    start = brick.snapshot()
    (identity, name, version), record = played(brick, work)
    assert identity == (0x0694, 0x0002)
    assert (name, version) == ("Rover", ((1, 124), (1, 29)))
    brick.restore(start)
    assert replay_live(brick, record)


def test_the_boot_monitor_is_offered_with_its_own_identity() -> None:
    def work(usb: int, _: int) -> Any:
        host = Host(usb)
        identity = host.wait_for_device()
        host.attach()
        host.submit(1, incoming=False, data=b"N#")
        return identity, host.submit(2, incoming=True, length=64)

    brick = firmware_brick()
    run_ms(brick, 100)
    brick.enter_boot_monitor()
    assert played(brick, work)[0] == ((0x03EB, 0x6124), b"\n\r")


def hostile_bytes(numbers: random.Random) -> bytes:
    """Beginnings of what is right, damaged."""
    submit = struct.pack(">10I8x", 1, numbers.randrange(9), 1, 1, 2, 0, 64, 0, 0, 0)
    content = bytearray(numbers.choice([b"", LIST, IMPORT, IMPORT + submit * 200]))
    content += numbers.randbytes(numbers.choice([0, 7, 48, 5000]))
    for _ in range(numbers.randrange(4)):
        if content:
            content[numbers.randrange(len(content))] = numbers.randrange(256)
    return bytes(content)


def annoy(client: socket.socket, turns: Turns, numbers: random.Random) -> None:
    """Send what is hostile, take a part of the answers, and be let go or go."""
    try:
        client.sendall(hostile_bytes(numbers))
        turns.give(20)
        client.setblocking(False)
        client.recv(numbers.choice([1, 400]))
    except OSError:
        return


@pytest.mark.parametrize("seed", [1, 2])
def test_hostile_peers_end_neither_the_run_nor_the_memory(seed: int) -> None:
    turns = Turns()

    def work(usb: int, bluetooth: int) -> Any:
        numbers = random.Random(seed)
        try:
            for _ in range(60):
                target = numbers.choice([usb, bluetooth])
                with socket.create_connection(("127.0.0.1", target), timeout=LONGEST_S) as client:
                    annoy(client, turns, numbers)
        finally:
            turns.give_all()
        return Host(usb).identity()

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    identity, record = played(firmware_brick(), work, turns.take)
    assert identity is None or identity == (0x0694, 0x0002)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < GROWTH_MOST_KB
    assert len(record.cable) < 60 * 64
