# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What brick and host say to each other: contents of frames (docs/reference/telemetry.md).

Numbers are little-endian. A value is four bytes: IEEE single, signed integer, or 0 and 1.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

__all__ = [
    "VERSION",
    "Answer",
    "Ask",
    "Hello",
    "KeepAlive",
    "Kind",
    "Message",
    "ParameterDescription",
    "Refused",
    "Sample",
    "SetParameter",
    "SignalDescription",
    "Status",
    "Stop",
    "Value",
    "Verdict",
    "decode",
    "encode",
    "unpack_value",
]

VERSION = 1
"""Of the protocol; a brick with another one says so and sends nothing else."""

Value = float | int | bool


class Kind(IntEnum):
    """How the four bytes of a value are read."""

    REAL = 0
    WHOLE = 1
    TRUTH = 2


class Verdict(IntEnum):
    """Answer to a request to change a parameter."""

    ACCEPTED = 0
    OUT_OF_RANGE = 1
    UNKNOWN = 2


@dataclass(frozen=True)
class Hello:
    """The brick introduces its program; `time_us` since power-on."""

    version: int
    signal_count: int
    parameter_count: int
    time_us: int
    name: str


@dataclass(frozen=True)
class SignalDescription:
    """One signal: the value at `position` (from 0) of the samples of `group`."""

    group: int
    position: int
    kind: Kind
    name: str
    unit: str


@dataclass(frozen=True)
class ParameterDescription:
    """One parameter, its limits as the brick checks them, and the value in force."""

    index: int
    minimum: float
    maximum: float
    value: float
    name: str
    unit: str


@dataclass(frozen=True)
class Sample:
    """Values of a group at `time_us` modulo 2**32; `number` counts all published, modulo 2**16."""

    group: int
    number: int
    time_us: int
    words: tuple[bytes, ...]


@dataclass(frozen=True)
class Answer:
    """The brick's answer to `SetParameter`; `value` is in force now."""

    index: int
    verdict: Verdict
    value: float


@dataclass(frozen=True)
class Status:
    """Totals since power-on: samples sent, samples dropped, damaged frames from the host."""

    sent: int
    dropped: int
    damaged: int


@dataclass(frozen=True)
class Refused:
    """The brick speaks another version of the protocol."""

    version: int


@dataclass(frozen=True)
class Ask:
    """The host wants descriptions and then samples."""

    version: int = VERSION


@dataclass(frozen=True)
class SetParameter:
    """The host wants a parameter changed."""

    index: int
    value: float


@dataclass(frozen=True)
class KeepAlive:
    """The host is still there; without any word for 3 s the brick stops sending."""


@dataclass(frozen=True)
class Stop:
    """The host wants no more samples."""


Message = (
    Hello
    | SignalDescription
    | ParameterDescription
    | Sample
    | Answer
    | Status
    | Refused
    | Ask
    | SetParameter
    | KeepAlive
    | Stop
)

_CODES: dict[type, int] = {
    Hello: 0x01,
    SignalDescription: 0x02,
    ParameterDescription: 0x03,
    Sample: 0x04,
    Answer: 0x05,
    Status: 0x06,
    Refused: 0x07,
    Ask: 0x41,
    SetParameter: 0x42,
    KeepAlive: 0x43,
    Stop: 0x44,
}
_WORD = 4
_SAMPLE = struct.Struct("<BHI")
_FIXED: dict[type, struct.Struct] = {
    Hello: struct.Struct("<BBBQ"),
    SignalDescription: struct.Struct("<BBB"),
    ParameterDescription: struct.Struct("<Bfff"),
    Answer: struct.Struct("<BBf"),
    Status: struct.Struct("<III"),
    Refused: struct.Struct("<B"),
    Ask: struct.Struct("<B"),
    SetParameter: struct.Struct("<Bf"),
    KeepAlive: struct.Struct("<"),
    Stop: struct.Struct("<"),
}


def unpack_value(kind: Kind, word: bytes) -> Value:
    """The value of four bytes; any word other than 0 is true."""
    if kind is Kind.REAL:
        return float(struct.unpack("<f", word)[0])
    number = int(struct.unpack("<i", word)[0])
    return number if kind is Kind.WHOLE else number != 0


def _texts(*texts: str) -> bytes:
    return b"".join(bytes([len(text)]) + text.encode("latin-1") for text in texts)


def encode(message: Message) -> bytes:
    """The content of the frame that carries a message."""
    code = bytes([_CODES[type(message)]])
    match message:
        case Sample(group, number, time_us, words):
            return code + _SAMPLE.pack(group, number, time_us) + b"".join(words)
        case Hello():
            fields = (message.version, message.signal_count, message.parameter_count)
            packed = _FIXED[Hello].pack(*fields, message.time_us)
            return code + packed + _texts(message.name)
        case SignalDescription():
            packed = _FIXED[SignalDescription].pack(message.group, message.position, message.kind)
            return code + packed + _texts(message.name, message.unit)
        case ParameterDescription():
            limits = (message.minimum, message.maximum, message.value)
            packed = _FIXED[ParameterDescription].pack(message.index, *limits)
            return code + packed + _texts(message.name, message.unit)
        case _:
            return code + _FIXED[type(message)].pack(*vars(message).values())


def _read_texts(body: bytes, count: int) -> tuple[str, ...] | None:
    texts: list[str] = []
    for _ in range(count):
        if not body or len(body) < 1 + body[0]:
            return None
        texts.append(body[1 : 1 + body[0]].decode("latin-1"))
        body = body[1 + body[0] :]
    return tuple(texts) if not body else None


def _sample(body: bytes) -> Sample | None:
    words = body[_SAMPLE.size :]
    if len(body) < _SAMPLE.size or len(words) % _WORD:
        return None
    parts = tuple(words[i : i + _WORD] for i in range(0, len(words), _WORD))
    group, number, time_us = _SAMPLE.unpack(body[: _SAMPLE.size])
    return Sample(group, number, time_us, parts)


_TEXT_COUNT: dict[type, int] = {Hello: 1, SignalDescription: 2, ParameterDescription: 2}
_KINDS_BY_CODE = {code: kind for kind, code in _CODES.items()}
_ENUMS: dict[type, tuple[int, Callable[[int], IntEnum]]] = {
    SignalDescription: (2, Kind),
    Answer: (1, Verdict),
}


def decode(content: bytes) -> Message | None:
    """The message of a frame's content, or None when it is not one of this version."""
    message = _KINDS_BY_CODE.get(content[0]) if content else None
    if message is None:
        return None
    body = content[1:]
    if message is Sample:
        return _sample(body)
    layout = _FIXED[message]
    texts = _read_texts(body[layout.size :], _TEXT_COUNT.get(message, 0))
    if len(body) < layout.size or texts is None:
        return None
    fields = list(layout.unpack(body[: layout.size]))
    if message in _ENUMS:
        place, enumeration = _ENUMS[message]
        try:
            fields[place] = enumeration(fields[place])
        except ValueError:
            return None
    decoded: Message = message(*fields, *texts)
    return decoded
