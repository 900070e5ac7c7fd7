# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing targets in Python: snapshot files, the sockets of a live brick, and readers of files.

A target has a corpus of right contents and a way to damage them. `case` gives one content and
raises when it did more than be refused with words.
"""

from __future__ import annotations

import contextlib
import json
import queue
import random
import socket
import struct
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import virtual_brick
from ravenbrick.brick.links.byte_ports import TcpPort
from ravenbrick.brick.links.live import LiveRecord, LiveRun, replay_live
from ravenbrick.brick.links.usbip import UsbIpServer
from ravenbrick.brick.snapshot import Snapshot, SnapshotError
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.stimuli import TimedInput

from verification.fuzz.files import file_readers, write_anew
from verification.fuzz.mutation import mutate_bytes, mutate_snapshot

__all__ = ["Target", "targets"]

HERE = Path(__file__).resolve().parent
FIRMWARE = Path("/usr/share/nxt-firmware/nxt_firmware.bin")
FLASH = 0x0010_0000
MENU_CYCLES = 6_000 * 48_055
CONFIGURATION = (HERE / "corpus" / "configuration" / "vehicle.json").read_text()
BRICK = json.dumps({"bluetooth": json.loads(CONFIGURATION)["bluetooth"]})
LIST = struct.pack(">HHI", 0x0111, 0x8005, 0)
LOOPBACK = "127.0.0.1"
# A valid file may have been saved after hours of run; it is read, but not run here.
RUN_CYCLES_MAX = 10_000_000
PIECES_MAX = 12
REPLAYED_EACH = 16
# By the clock, of which the idle class of the scheduler may get little.
PATIENCE_S = 600.0


class Target(Protocol):
    """A part of the virtual brick that takes content from outside."""

    name: str
    input: str
    corpus: list[bytes]

    def mutate(self, numbers: random.Random, content: bytes) -> bytes:
        """Mutated content."""

    def case(self, content: bytes) -> None:
        """Run one case; raises when the content is neither accepted nor refused with a cause."""

    def close(self) -> None:
        """Release what the target holds."""


def _stored(kind: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted((HERE / "corpus" / kind).iterdir())]


class SnapshotFiles:
    """Snapshot files, loaded and restored."""

    name = "malformed snapshot"
    input = "snapshot files with wrong bytes or fields, mostly with a correct checksum"

    def __init__(self, image: Path) -> None:
        self._image: ElfImage = read_image(image)
        self._folder = tempfile.TemporaryDirectory()
        self._path = Path(self._folder.name) / "input.rbs"
        self.corpus = [self._saved(inputs) for inputs in ((), (TimedInput(5, "touch.1", 1.0),))]

    def _saved(self, inputs: tuple[TimedInput, ...]) -> bytes:
        brick = virtual_brick.VirtualBrick(CONFIGURATION, self._image.content)
        for timed in inputs:
            brick.schedule_input(timed.at_cycles, timed.name, timed.value)
        brick.add_probe("total", "i32")
        brick.run_until(100_000)
        probes = (("total", "i32"),)
        Snapshot.take(brick, CONFIGURATION, self._image, inputs, probes).save(self._path)
        return self._path.read_bytes()

    def mutate(self, numbers: random.Random, content: bytes) -> bytes:
        return mutate_snapshot(numbers, content)

    def case(self, content: bytes) -> None:
        write_anew(self._path, content)
        with contextlib.suppress(SnapshotError):
            snapshot = Snapshot.load(self._path)
            if snapshot.cycles < RUN_CYCLES_MAX:
                snapshot.restore(virtual_brick, self._image)

    def close(self) -> None:
        self._folder.cleanup()


class LivePeer:
    """A peer on the Bluetooth or USB/IP port of a brick that runs LEGO's firmware.

    After each session a well-behaved host must find the USB port served, unless LEGO's firmware was
    misled to what a strict brick stops at, such as a wild pointer; now and then the record of the
    whole run is replayed and must give the same run.
    """

    def __init__(self, kind: str) -> None:
        self.name = f"hostile peer, {kind}"
        self.input = f"sessions with wrong bytes on the {kind} port, cut into pieces, hung up"
        self.corpus = _stored(kind)
        self._usb = kind == "usb-ip"
        self._brick = virtual_brick.VirtualBrick.from_binary(BRICK, FIRMWARE.read_bytes(), FLASH)
        self._brick.run_until(MENU_CYCLES)
        self._start = self._brick.snapshot()
        self._sessions = 0

    def mutate(self, numbers: random.Random, content: bytes) -> bytes:
        return mutate_bytes(numbers, content)

    def case(self, content: bytes) -> None:
        self._brick.restore(self._start)
        port, usb, record = TcpPort(0), UsbIpServer(0), LiveRecord("none")
        try:
            self._session(content, port, usb, record)
        finally:
            port.close()
            usb.close()
        self._sessions += 1
        if self._sessions % REPLAYED_EACH == 0:
            self._brick.restore(self._start)
            assert replay_live(self._brick, record), "the record gives another run"

    def _session(self, content: bytes, port: TcpPort, usb: UsbIpServer, record: LiveRecord) -> None:
        number = usb.port if self._usb else int(port.address.partition(":")[2])
        client = socket.create_connection((LOOPBACK, number), timeout=PATIENCE_S)
        size = max(1, -(-len(content) // PIECES_MAX))
        pieces = [content[at : at + size] for at in range(0, len(content), size)]
        live = LiveRun(self._brick, port, record, "1234", speed=0, usb_ip=usb)
        stopped = live.run(None, stop=_sender(client, pieces))
        client.close()
        if stopped.reason == "fault":
            return
        with socket.create_connection((LOOPBACK, usb.port), timeout=PATIENCE_S) as regular:
            regular.sendall(LIST)
            regular.setblocking(False)
            answer = bytearray()
            stopped = live.run(None, stop=_receiver(regular, answer, 12))
        assert stopped.reason == "fault" or answer[:8] == struct.pack(">HHI", 0x0111, 5, 0), (
            "USB/IP is no longer served"
        )

    def close(self) -> None:
        del self._brick


def _sender(client: socket.socket, pieces: list[bytes]) -> Callable[[], bool]:
    """Sends a piece in each slice of the run; true when all are sent or the server hung up."""
    client.setblocking(False)
    waiting = list(pieces)

    def step() -> bool:
        try:
            if waiting:
                client.sendall(waiting.pop(0))
            client.recv(4096)
        except BlockingIOError:
            pass
        except OSError:
            return True
        return not waiting

    return step


def _receiver(client: socket.socket, answer: bytearray, count: int) -> Callable[[], bool]:
    slices = iter(range(400))

    def step() -> bool:
        with contextlib.suppress(BlockingIOError):
            answer.extend(client.recv(4096))
        return len(answer) >= count or next(slices, None) is None

    return step


class DebugPeer:
    """A peer on the debugger's socket; afterwards the server must answer a regular one."""

    name = "hostile peer, gdb"
    input = "sessions of GDB's protocol with wrong packets, hung up anywhere"

    def __init__(self, image: Path) -> None:
        self.corpus = _stored("gdb")
        self._ended = threading.Event()
        brick = virtual_brick.VirtualBrick(CONFIGURATION, image.read_bytes())
        answers: queue.Queue[int | BaseException] = queue.Queue()

        def serve() -> None:
            try:
                stop = self._ended.is_set
                brick.serve_debugger(0, LOOPBACK, on_listening=answers.put, should_stop=stop)
            except BaseException as error:
                answers.put(error)

        self._answers = answers
        self._server = threading.Thread(target=serve, daemon=True)
        self._server.start()
        port = answers.get(timeout=PATIENCE_S)
        assert isinstance(port, int), port
        self._port = port
        self._before: socket.socket | None = None

    def mutate(self, numbers: random.Random, content: bytes) -> bytes:
        return mutate_bytes(numbers, content)

    def _connected(self) -> socket.socket:
        return socket.create_connection((LOOPBACK, self._port), timeout=PATIENCE_S)

    def case(self, content: bytes) -> None:
        # The next client always waits already: a server without one sleeps for a while.
        client, regular, before = self._connected(), self._connected(), self._before
        if before is not None:
            before.close()
        self._before = regular
        with client, contextlib.suppress(OSError):
            client.settimeout(0.01)
            client.sendall(content)
            client.recv(4096)
        regular.sendall(b"$?#3f")
        answer = b""
        while b"#" not in answer:
            piece = regular.recv(4096)
            assert piece, f"the server hung up: {self._failure()}"
            answer += piece
        assert answer.lstrip(b"+").startswith((b"$T", b"$S", b"$W")), answer

    def _failure(self) -> Any:
        return self._answers.get_nowait() if not self._answers.empty() else "no reason"

    def close(self) -> None:
        if self._before is not None:
            self._before.close()
        self._ended.set()
        self._server.join(PATIENCE_S)


def targets(image: Path) -> list[Callable[[], Target]]:
    """Makers of all targets; those that need LEGO's firmware only where it is installed."""
    found: list[Callable[[], Target]] = [lambda: SnapshotFiles(image), lambda: DebugPeer(image)]
    if FIRMWARE.exists():
        found += [lambda: LivePeer("usb-ip"), lambda: LivePeer("bluetooth")]
    return [*found, *file_readers(image)]
