# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Snapshots of a virtual brick in files (docs/reference/snapshots.md).

A file holds what the run came from (configuration, digest of the image, inputs, probes) and what it
had come to (cycle, program counter, memory, digest of the trace). A brick is restored by running,
and compared with what the file holds: it is the brick that was saved, or an error.
"""

from __future__ import annotations

import hashlib
import json
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import UsageError
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.stimuli import TimedInput

__all__ = ["Snapshot", "SnapshotError", "SnapshotOptions"]

_MAGIC = b"RAVENBRICK SNAPSHOT\n"
_VERSION = 1
_HEAD = struct.Struct("<II")
_LARGEST_FILE = 1 << 28
# A day.
_LONGEST_CYCLES = 24 * 3600 * 48_054_858
_SLICE_CYCLES = 48_054_858
_MEMORIES = ((0x0020_0000, 0x1_0000), (0x0010_0000, 0x4_0000))
_MEMORY_BYTES = sum(length for _, length in _MEMORIES)


class SnapshotError(UsageError):
    """The file is not a snapshot, is damaged, or belongs to another image or version."""


def _memory(brick: Any) -> bytes:
    return b"".join(brick.read_memory(start, length) for start, length in _MEMORIES)


@dataclass(frozen=True)
class Snapshot:
    """A brick at an instant."""

    configuration: str
    image_digest: str
    inputs: tuple[TimedInput, ...]
    probes: tuple[tuple[str, str], ...]
    cycles: int
    program_counter: int
    trace_digest: str
    memory: bytes

    @classmethod
    def take(
        cls,
        brick: Any,
        configuration: str,
        image: ElfImage,
        inputs: tuple[TimedInput, ...],
        probes: tuple[tuple[str, str], ...],
    ) -> Snapshot:
        """Of a brick that has had these inputs, those to come included."""
        return cls(
            configuration,
            image.digest,
            inputs,
            probes,
            brick.cycles,
            brick.program_counter,
            brick.trace_digest(),
            _memory(brick),
        )

    def restore(self, module: Any, image: ElfImage) -> Any:
        """A brick in this state, made with `virtual_brick`; raises SnapshotError."""
        if image.digest != self.image_digest:
            raise SnapshotError(f"{image.path}: is not the image of the snapshot; name that one")
        kind = module.VirtualBrick
        try:
            if image.bare:
                brick = kind.from_binary(self.configuration, image.content, image.entry)
            else:
                brick = kind(self.configuration, image.content)
            for timed in self.inputs:
                brick.schedule_input(timed.at_cycles, timed.name, timed.value)
            for symbol, scalar in self.probes:
                brick.add_probe(symbol, scalar)
        except (module.ConfigurationError, module.InputError, module.ImageError) as error:
            raise SnapshotError(f"the snapshot is refused: {error}") from None
        stop = None
        while brick.cycles < self.cycles and (stop is None or stop.reason == "reached"):
            stop = brick.run_until(min(self.cycles, brick.cycles + _SLICE_CYCLES))
        found = (brick.cycles, brick.program_counter, brick.trace_digest(), _memory(brick))
        if found != (self.cycles, self.program_counter, self.trace_digest, self.memory):
            raise SnapshotError(
                "this version of the virtual brick comes to another state than the snapshot's; "
                "use the version that saved it, or save it again"
            )
        return brick

    def save(self, path: Path) -> None:
        """Write the file, whole or not at all."""
        fields = vars(self) | {
            "inputs": [[timed.at_cycles, timed.name, timed.value] for timed in self.inputs],
            "memory": len(self.memory),
        }
        header = json.dumps(fields, sort_keys=True).encode()
        memory = zlib.compress(self.memory, 9)
        content = _MAGIC + _HEAD.pack(_VERSION, len(header)) + header + memory
        atomic_write(path, content + hashlib.sha256(content).digest())

    @classmethod
    def load(cls, path: Path) -> Snapshot:
        """Read a file; raises SnapshotError."""
        if not path.is_file():
            raise SnapshotError(
                f"{path}: there is no such snapshot; 'ravenbrick run --save-snapshot' writes one"
            )
        try:
            if path.stat().st_size > _LARGEST_FILE:
                raise ValueError("it is larger than any snapshot")
            return cls._read(path.read_bytes(), str(path))
        except (OSError, ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
            raise SnapshotError(
                f"{path}: is not a snapshot ({error}); 'ravenbrick run --save-snapshot' writes one"
            ) from None

    @classmethod
    def _read(cls, content: bytes, place: str) -> Snapshot:
        body, digest = content[:-32], content[-32:]
        start = len(_MAGIC) + _HEAD.size
        if not body.startswith(_MAGIC) or len(body) < start:
            raise ValueError("its first bytes are wrong")
        version, length = _HEAD.unpack_from(body, len(_MAGIC))
        if version != _VERSION:
            raise ValueError(f"its version is {version}, this program reads {_VERSION}")
        if hashlib.sha256(body).digest() != digest:
            raise ValueError("it is damaged or cut off")
        fields = json.loads(body[start : start + length])
        if not isinstance(fields, dict):
            raise ValueError("its header is not a JSON object")
        unpacked = zlib.decompressobj()
        try:
            memory = unpacked.decompress(body[start + length :], _MEMORY_BYTES)
        except zlib.error as error:
            raise ValueError(error) from None
        if len(memory) != _MEMORY_BYTES or fields.pop("memory") != _MEMORY_BYTES:
            raise ValueError("its memory has another size")
        inputs = [
            TimedInput(_whole(at, _LONGEST_CYCLES), _text(name), float(value), place)
            for at, name, value in _list(fields["inputs"])
        ]
        probes = [(_text(symbol), _text(scalar)) for symbol, scalar in _list(fields["probes"])]
        return cls(
            _text(fields["configuration"]),
            _text(fields["image_digest"]),
            tuple(inputs),
            tuple(probes),
            _whole(fields["cycles"], _LONGEST_CYCLES),
            _whole(fields["program_counter"], 0xFFFF_FFFF),
            _text(fields["trace_digest"]),
            memory,
        )


def _whole(value: Any, most: int) -> int:
    """A whole number from 0 to `most`; raises ValueError."""
    if type(value) is not int or not 0 <= value <= most:
        raise ValueError(f"{str(value)[:20]} is not a whole number from 0 to {most}")
    return value


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError(f"{str(value)[:20]} is not a list")
    return value


def _text(value: Any) -> str:
    """Text that has an encoding; raises ValueError."""
    if not isinstance(value, str):
        raise ValueError(f"{str(value)[:20]} is not a text")
    value.encode()
    return value


@dataclass(frozen=True)
class SnapshotOptions:
    """For a run: the snapshot to begin with, and where to save one after so many milliseconds."""

    start: Snapshot | None = None
    save: Path | None = None
    save_ms: int = 0
