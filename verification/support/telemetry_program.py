# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The brick's side of the telemetry protocol, and a socket that offers it, for tests."""

from __future__ import annotations

import socket
import struct
import threading
import time
from dataclasses import dataclass, field

from ravenbrick.telemetry.frames import FrameReader, frame
from ravenbrick.telemetry.messages import (
    VERSION,
    Answer,
    Ask,
    Hello,
    Kind,
    Message,
    ParameterDescription,
    Refused,
    Sample,
    SetParameter,
    SignalDescription,
    Status,
    Stop,
    Verdict,
    decode,
    encode,
)

SIGNALS = (
    SignalDescription(1, 0, Kind.REAL, "setpoint", "V"),
    SignalDescription(1, 1, Kind.REAL, "speed", "V"),
    SignalDescription(2, 0, Kind.WHOLE, "battery", "mV"),
)


def sent(*messages: Message) -> bytes:
    """The bytes on the line."""
    return b"".join(frame(encode(message)) for message in messages)


@dataclass
class Program:
    """A program that answers; times are in microseconds."""

    version: int = VERSION
    time_us: int = 0
    gains: list[float] = field(default_factory=lambda: [0.5, 8.0])
    asking: bool = False
    numbers: dict[int, int] = field(default_factory=lambda: {1: 0, 2: 0})
    heard: list[Message] = field(default_factory=list)
    ignores: int = 0
    reader: FrameReader = field(default_factory=FrameReader)

    def parameters(self) -> list[ParameterDescription]:
        """Two gains with their limits."""
        return [
            ParameterDescription(0, 0.0, 2.0, self.gains[0], "kp", ""),
            ParameterDescription(1, 0.0, 50.0, self.gains[1], "ki", "1/s"),
        ]

    def receive(self, data: bytes) -> bytes:
        """What the program says to that."""
        answers = b""
        for content in self.reader.feed(data):
            message = decode(content)
            if message is None:
                continue
            if self.ignores:
                self.ignores -= 1
                continue
            self.heard.append(message)
            answers += self._answer(message)
        return answers

    def _answer(self, message: Message) -> bytes:
        match message:
            case Ask(version) if version != self.version:
                return sent(Refused(self.version))
            case Ask():
                self.asking = True
                hello = Hello(self.version, len(SIGNALS), 2, self.time_us, "fake")
                return sent(hello, *SIGNALS, *self.parameters(), Status(0, 0, 0))
            case SetParameter(index, value):
                return sent(self._set(index, value))
            case Stop():
                self.asking = False
        return b""

    def _set(self, index: int, value: float) -> Answer:
        if index >= len(self.gains):
            return Answer(index, Verdict.UNKNOWN, 0.0)
        limits = self.parameters()[index]
        if not limits.minimum <= value <= limits.maximum:
            return Answer(index, Verdict.OUT_OF_RANGE, self.gains[index])
        self.gains[index] = value
        return Answer(index, Verdict.ACCEPTED, value)

    def sample(self, group: int, *values: float) -> bytes:
        """A sample of a group now, with the next number."""
        number = self.numbers[group]
        self.numbers[group] = (number + 1) % 2**16
        kinds = [s.kind for s in SIGNALS if s.group == group]
        words = tuple(
            struct.pack("<f" if kind is Kind.REAL else "<i", value)
            for kind, value in zip(kinds, values, strict=True)
        )
        return sent(Sample(group, number, self.time_us % 2**32, words))


class Server:
    """A program behind a TCP port of this computer; each connection lasts `samples` samples."""

    def __init__(self, program: Program, samples: int) -> None:
        self.program = program
        self._samples = samples
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """No more connections."""
        self._socket.close()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            with connection:
                self._talk(connection)

    def _talk(self, connection: socket.socket) -> None:
        connection.settimeout(0.005)
        left = self._samples
        self.program.asking = False
        try:
            while left:
                try:
                    data = connection.recv(1000)
                except TimeoutError:
                    data = b""
                connection.sendall(self.program.receive(data))
                if self.program.asking:
                    self.program.time_us += 4_000
                    connection.sendall(self.program.sample(1, 1.0, 0.5))
                    left -= 1
        except OSError:
            time.sleep(0)
