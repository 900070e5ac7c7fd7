# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A USB client of Pybricks: its profile 1.5 (protocol.h of the firmware), and its scripts."""

from __future__ import annotations

import importlib
import struct

from ravenbrick.brick.firmware import FirmwareBrick
from ravenbrick.errors import PeerError

__all__ = ["CompilerAbsentError", "PybricksHub", "compiled"]

COMPILER = "mpy_cross_v6_3"
SUBSCRIBE, COMMAND = 1, 2
START, WRITE_META, WRITE_RAM = 1, 3, 4
RESPONSE, EVENT, STDOUT = 1, 2, 1
IDENTITY = (0x0694, 0x0002)
CHUNK_BYTES = 50


class CompilerAbsentError(Exception):
    """The compiler of scripts is not installed."""


def compiled(source: str) -> bytes:
    """A script as the firmware takes it: size, name, bytecode. Raises CompilerAbsentError."""
    try:
        compiler = importlib.import_module(COMPILER)
    except ImportError:
        raise CompilerAbsentError(
            f"the Python package {COMPILER.replace('_', '-')}, which compiles scripts, is absent"
        ) from None
    _, code = compiler.mpy_cross_compile("__main__", source)
    assert code is not None
    return struct.pack("<I", len(code)) + b"__main__\0" + code


class PybricksHub:
    """The computer at the cable of a brick with Pybricks."""

    def __init__(self, brick: FirmwareBrick) -> None:
        self._brick = brick
        self._computer = brick.usb()
        assert self._computer.enumerate() == IDENTITY
        self.output = ""
        self._computer.write(1, bytes([SUBSCRIBE, 1]))
        self._answer()

    def download(self, program: bytes) -> None:
        """Write a program into the hub's memory for user programs."""
        self._command(WRITE_META, struct.pack("<I", 0))
        for at in range(0, len(program), CHUNK_BYTES):
            chunk = program[at : at + CHUNK_BYTES]
            self._command(WRITE_RAM, struct.pack("<I", at) + chunk)
        self._command(WRITE_META, struct.pack("<I", len(program)))

    def start(self) -> None:
        """Start the program."""
        self._command(START, b"\0")

    def expect(self, text: str, within: float = 3.0) -> str:
        """Wait until a whole line with the text was printed; the line. Raises AssertionError."""
        end = self._brick.seconds + within
        while True:
            for line in self.output.splitlines(keepends=True):
                if text in line and line.endswith("\n"):
                    return line
            assert self._brick.seconds < end, f"printed {self.output!r}, expected '{text}'"
            try:
                self._take(self._computer.read(2))
            except PeerError:
                continue

    def _command(self, number: int, content: bytes) -> None:
        self._computer.write(1, bytes([COMMAND, number]) + content)
        self._answer()

    def _answer(self) -> None:
        """Wait for a response, which must say that all is well."""
        while not self._take(self._computer.read(2)):
            pass

    def _take(self, packet: bytes) -> bool:
        """Keep what was printed; whether the packet is a response."""
        if packet[:2] == bytes([EVENT, STDOUT]):
            self.output += packet[2:].decode("utf-8", "replace")
        if packet[:1] != bytes([RESPONSE]):
            return False
        (error,) = struct.unpack("<I", packet[1:5])
        assert error == 0, f"the hub answers with error {error}"
        return True
