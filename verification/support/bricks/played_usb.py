# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""libnxt's own programs against a virtual brick: their libusb is `played_usb.c`."""

from __future__ import annotations

import os
import socket
import struct
import subprocess
import threading
from pathlib import Path
from tempfile import TemporaryDirectory

from ravenbrick.brick.links.peers import DEVICE_DESCRIPTOR, UsbComputer
from ravenbrick.errors import PeerError

SOURCE = Path(__file__).with_suffix(".c")
HEAD = struct.Struct("<iI")
INTO_HOST = 0x80
ERROR_TIMEOUT = -7


def build_library(folder: Path) -> Path:
    """The library that takes the place of libusb; needs the host's C compiler."""
    library = folder / "played_usb.so"
    command = ["cc", "-shared", "-fPIC", "-O1", "-Wall", "-Wextra", "-Werror", "-o", str(library)]
    subprocess.run([*command, str(SOURCE)], check=True)
    return library


class PlayedLink:
    """The bulk endpoints of the played device as a link, in a command run by `run_with_device`."""

    def __init__(self) -> None:
        self._line = socket.socket(socket.AF_UNIX)
        self._line.connect(os.environ["RAVENBRICK_PLAYED_USB"])
        self._stream = self._line.makefile("rwb")
        self._request(0, 0)

    def _request(self, endpoint: int, length: int, data: bytes = b"") -> bytes:
        self._stream.write(HEAD.pack(endpoint, length) + data)
        self._stream.flush()
        _, count = HEAD.unpack(self._stream.read(HEAD.size))
        return self._stream.read(count) if endpoint == 0 or endpoint & INTO_HOST else b""

    def read(self, timeout_s: float) -> bytes:
        """The next packet, or nothing after the played host's own time."""
        return self._request(INTO_HOST | 2, 64)

    def write(self, data: bytes) -> None:
        """Send all."""
        self._request(1, len(data), data)

    def close(self) -> None:
        """Let go."""
        self._stream.close()
        self._line.close()


def _descriptor(computer: UsbComputer) -> bytes:
    """Of the device, which a host enumerates again when another has taken its place."""
    try:
        return computer.control(DEVICE_DESCRIPTOR)
    except PeerError:
        computer.enumerate()
        return computer.control(DEVICE_DESCRIPTOR)


def _answer(computer: UsbComputer, endpoint: int, length: int, data: bytes) -> bytes:
    """What the device does with a request; a transfer that fails is a time-out of libusb."""
    try:
        if endpoint == 0:
            received = _descriptor(computer)
        elif endpoint & INTO_HOST:
            received = computer.read(endpoint & ~INTO_HOST, length)
        else:
            computer.write(endpoint, data)
            return HEAD.pack(0, length)
    except PeerError:
        return HEAD.pack(ERROR_TIMEOUT, 0)
    return HEAD.pack(0, len(received)) + received


def _serve(line: socket.socket, computer: UsbComputer) -> None:
    stream = line.makefile("rwb")
    while len(head := stream.read(HEAD.size)) == HEAD.size:
        endpoint, length = HEAD.unpack(head)
        out = endpoint != 0 and not endpoint & INTO_HOST
        stream.write(_answer(computer, endpoint, length, stream.read(length) if out else b""))
        stream.flush()


def run_with_device(
    command: list[str], computer: UsbComputer, library: Path
) -> subprocess.CompletedProcess[str]:
    """Run a command whose libusb sees the brick of `computer`, which runs meanwhile."""
    # The path of a socket has at most 107 bytes, which that of a test's own folder may exceed.
    with TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as server:
        path = f"{folder}/usb"
        environment = {**os.environ, "LD_PRELOAD": str(library), "RAVENBRICK_PLAYED_USB": path}
        server.bind(path)
        server.listen()
        server.settimeout(0.2)
        process = subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        output: list[str] = []
        reader = threading.Thread(target=lambda: output.append(process.communicate()[0]))
        reader.start()
        while reader.is_alive():
            try:
                line, _ = server.accept()
            except TimeoutError:
                continue
            with line:
                line.settimeout(None)
                _serve(line, computer)
        reader.join()
    return subprocess.CompletedProcess(command, process.returncode, output[0])
