# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The record taken: from a link to a real brick, or from a virtual brick through its USB."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from ravenbrick.brick.links.peers import UsbStream
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ConnectionFailedError, PeerError, RunFaultError
from ravenbrick.image.elf import ElfImage
from ravenbrick.installation import brick_module
from ravenbrick.self_test.record import PARTS, Record, parse_lines

__all__ = ["Settings", "from_real_brick", "from_virtual_brick"]

Settings = Mapping[str, Any]
"""Fields of the virtual brick's configuration."""

REQUEST = b"?"
SILENCE_S = 60.0
READ_S = 0.5
STEP_MS = 20
VIRTUAL_MS = 120_000
PRESS_MS = 200


class ByteLink(Protocol):
    """A connection to a brick."""

    def read(self, timeout_s: float) -> bytes:
        """What arrived, after at most so long."""

    def write(self, data: bytes) -> None:
        """Send all."""


class _Lines:
    """Bytes of the link cut into lines, from the record's first one on."""

    def __init__(self, shown: Callable[[str], None]) -> None:
        self._rest = b""
        self._shown = shown
        self.lines: list[str] = []

    def add(self, data: bytes) -> None:
        """Take what arrived."""
        *whole, self._rest = (self._rest + data).split(b"\n")
        for line in whole:
            text = line.decode("ascii", "replace")
            if text.startswith('{"self_test"'):
                self.lines = []
            self.lines.append(text)
            self._shown(text)

    def finished(self, part: str) -> bool:
        """The brick has said that this part is done."""
        return json.dumps({"finished": part}, separators=(",", ":")) in self.lines


def _no_line(_: str) -> None:
    pass


def _record(lines: list[str], source: str, image: ElfImage) -> Record:
    try:
        return parse_lines(lines, source, image.digest)
    except ValueError as error:
        raise ConnectionFailedError(
            f"what the brick sent is no record: {error}; take the record again"
        ) from None


def from_real_brick(
    link: ByteLink, image: ElfImage, shown: Callable[[str], None] = _no_line
) -> Record:
    """Ask for the record and wait for its end; `shown` gets each line as it arrives.

    Raises `ConnectionFailedError` when the brick is silent for a minute.
    """
    lines = _Lines(shown)
    link.write(REQUEST)
    heard = time.monotonic()
    while not lines.finished(PARTS[-1]):
        data = link.read(READ_S)
        lines.add(data)
        if data:
            heard = time.monotonic()
        elif time.monotonic() > heard + SILENCE_S:
            raise ConnectionFailedError(
                f"the brick has been silent for {SILENCE_S:.0f} s after {len(lines.lines)} lines; "
                "note what its display shows, switch it off and take the record again"
            )
    return _record(lines.lines, "usb", image)


def _not_ended(reason: str, lines: list[str]) -> RunFaultError:
    return RunFaultError(
        f"the self-test does not end on the virtual brick ({reason})", detail="\n".join(lines[-1:])
    )


def from_virtual_brick(
    image: ElfImage, settings: Settings, until: str = PARTS[-1], module: Any = None
) -> Record:
    """The record of a virtual brick, read through its USB; the sensor in port 1 is pressed."""
    module = module if module is not None else brick_module()
    brick = module.VirtualBrick(json.dumps(dict(settings)), image.content)
    host, lines = UsbStream(brick), _Lines(_no_line)
    try:
        host.connect()
        host.write(REQUEST)
        for now_ms in range(0, VIRTUAL_MS, STEP_MS):
            if lines.finished(until):
                break
            if lines.finished(PARTS[0]) and now_ms % PRESS_MS == 0:
                _press(brick, settings, pressed=now_ms // PRESS_MS % 2)
            stop = brick.run_until(brick.cycles + MASTER_CLOCK.cycles_of_ms(STEP_MS))
            if stop.reason != "reached":
                raise _not_ended(f"{stop.reason}: {stop.message}", lines.lines)
            lines.add(host.take())
        else:
            raise _not_ended(f"not in {VIRTUAL_MS // 1000} s", lines.lines)
    except PeerError as error:
        raise RunFaultError(f"the self-test does not answer on the virtual USB: {error}") from None
    return _record(lines.lines, "virtual brick", image)


def _press(brick: Any, settings: Settings, pressed: int) -> None:
    """The person presses or releases the orange button and the sensor, if there is one."""
    for name in ("button.orange", *(["touch.1"] if settings.get("sensors", {}).get("1") else [])):
        brick.schedule_input(brick.cycles, name, pressed)
