# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The state after the elaboration of a program that no longer changes: interrupt handlers and
ceilings.

The handlers are read from the memory of a brick on which the program has been elaborated; the
ceilings are constants in the calls that set up protected objects.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.timing.bounds import Call
from ravenbrick.trace.flow_counts import flow_counts
from ravenbrick.trace.recording import ENVIRONMENT

__all__ = [
    "ALARM_SOURCE",
    "Handler",
    "ProtectedObject",
    "attached_handlers",
    "elaborated",
    "executed_bodies",
    "initializers",
    "main_rests",
    "object_words",
    "protected_objects",
]

ELABORATED_MS = 300
# Two states of a thread, and where in it its wake-up time is
# (runtime/kernel/ravenbrick-threads.ads); what "delay until Time_Last" makes of that.
DELAYED, TERMINATED = 2, 5
WAKE = struct.Struct("<q")
WAKE_OFFSET = 40
NEVER = 2**63 - 2
# How GNAT ends the symbols of bodies of single tasks and of task types.
BODIES = ("TKB", "TB")
HANDLERS = "ravenbrick__interrupts__handlers"
HANDLER = struct.Struct("<IIiI")
SOURCE_COUNT = 32
# The controller's vector register, and what it reads as: the third word of the handler's record.
VECTOR = 0xFFFF_F100
ALARM_SOURCE = 12
FIRST_INTERRUPT_PRIORITY = 31
PRIORITY_LAST = 30
INITIALIZER = "system__tasking__protected_objects__initialize_protection"
ENTRY_INITIALIZER = "system__tasking__protected_objects__single_entry__initialize_protection_entry"
INITIALIZERS = (INITIALIZER, ENTRY_INITIALIZER)
VENEERS = ("_from_thumb", "_from_arm")
CODE_OFFSET = 20
RECORD = struct.Struct("<II")


@dataclass(frozen=True)
class Handler:
    """An attached interrupt handler; `words` are those of its record, which stay as they are."""

    source: int
    priority: int
    symbol: str
    words: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class ProtectedObject:
    """A protected object; `code` is the address of a record with its entry's barrier and body, 0
    without; `words` is that record where the image has it."""

    name: str
    address: int
    ceiling: int
    code: int
    words: tuple[tuple[int, int], ...] = ()

    @property
    def urgency(self) -> int:
        """Urgency of a protected action: twice the ceiling, plus one."""
        return 2 * self.ceiling + 1


def elaborated(robot: Robot, scenario: Scenario, image: ElfImage) -> Any:
    """A brick on which the program has been elaborated and its tasks have begun; errors as
    `VirtualTarget.run`."""
    begins = (image.symbols[name].address & ~1 for name in _bodies(image))
    points = json.dumps([{"kind": "place", "addresses": [begin]} for begin in begins])
    brick = VirtualTarget(flow_points=points).prepare(robot, scenario, image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(min(ELABORATED_MS, scenario.duration_ms)))
    return brick


def _bodies(image: ElfImage) -> list[str]:
    """Symbols of all bodies of tasks."""
    return sorted(name for name in image.symbols if name.endswith(BODIES))


def executed_bodies(brick: Any, image: ElfImage) -> dict[str, str]:
    """The body of each task that has begun on an `elaborated` brick, by its name in lower case."""
    names = [thread.name.lower() for thread in brick.threads()]
    counts = zip(_bodies(image), flow_counts(brick), strict=True)
    begun = [
        (int(arrival["at_cycles"]), names[arrival["thread"]], body)
        for body, each in counts
        for arrival in each.in_threads
    ]
    # A task begins with its body, which may call what is only named like one.
    return {name: body for _, name, body in sorted(begun, reverse=True)}


def main_rests(brick: Any) -> bool:
    """Whether the main procedure has ended, or waits for the end of all time."""
    main = next(thread for thread in brick.threads() if thread.name == ENVIRONMENT)
    if main.state != DELAYED:
        return bool(main.state == TERMINATED)
    (wake,) = WAKE.unpack(brick.read_memory(main.address + WAKE_OFFSET, WAKE.size))
    return bool(wake == NEVER)


def _code_name(brick: Any, address: int) -> str:
    found = brick.nearest_code(address & ~1)
    return found[0] if found is not None and found[1] == 0 else f"0x{address:08x}"


def _check_threads(brick: Any, image: ElfImage) -> None:
    """The run-time masks no interrupts for a task, so one of an interrupt priority has no bound."""
    for thread in brick.threads():
        if thread.base_priority >= FIRST_INTERRUPT_PRIORITY:
            raise ImageFileError(
                f"{image.path}: the task '{thread.name}' has the interrupt priority "
                f"{thread.base_priority}, for which the run-time masks no interrupts; give it one "
                f"of at most {PRIORITY_LAST}"
            )


def attached_handlers(brick: Any, image: ElfImage) -> tuple[Handler, ...]:
    """Handlers by source, the alarm's included; `brick` has elaborated the program.

    Raises `ImageFileError` for a program without a run-time, or with a task that is as urgent as a
    handler.
    """
    _check_threads(brick, image)
    table = image.symbols.get(HANDLERS)
    if table is None:
        raise ImageFileError(f"{image.path}: has no '{HANDLERS}'; link it with the run-time")
    content = brick.read_memory(table.address, SOURCE_COUNT * HANDLER.size)
    found = []
    for source, (item, code, urgency, _) in enumerate(HANDLER.iter_unpack(content)):
        if code:
            record = table.address + source * HANDLER.size
            words = (
                (VECTOR, record + 8),
                (record, item),
                (record + 4, code),
                (record + 8, urgency),
            )
            found.append(Handler(source, urgency // 2, _code_name(brick, code), words))
    return tuple(found)


def _name_of(image: ElfImage, address: int) -> str:
    inside = (
        name
        for name, symbol in sorted(image.symbols.items())
        if symbol.address <= address < symbol.address + symbol.size
    )
    return next(inside, f"0x{address:08x}")


def initializers(image: ElfImage) -> tuple[str, ...]:
    """Functions that set up protected objects, and the linker's veneers to them."""
    veneers = (f"__{name}{suffix}" for name in INITIALIZERS for suffix in VENEERS)
    return (*INITIALIZERS, *(name for name in veneers if name in image.symbols))


def _behind_veneer(name: str) -> str:
    for suffix in VENEERS:
        if name.startswith("__") and name.endswith(suffix):
            return name[2:].removesuffix(suffix)
    return name


def _record(image: ElfImage, address: int) -> tuple[tuple[int, int], ...]:
    """Addresses and values of barrier and body; nothing when they are not known before the run."""
    content = image.bytes_at(address, RECORD.size) if address else b""
    values = RECORD.unpack(content) if len(content) == RECORD.size else ()
    return tuple((address + 4 * n, v) for n, v in enumerate(values)) if all(values) else ()


def protected_objects(image: ElfImage, calls: Sequence[Call]) -> tuple[ProtectedObject, ...]:
    """Protected objects from the calls of `initializers`."""
    found = []
    for call in calls:
        if _behind_veneer(call.caller) in INITIALIZERS:
            continue
        address, ceiling, _, code = call.arguments
        if address is None or ceiling is None:
            raise ImageFileError(
                f"{image.path}: the protected object set up in {call.caller} has no static "
                "ceiling; declare it at library level with a static priority"
            )
        if ceiling == 0xFFFF_FFFF:
            ceiling = PRIORITY_LAST
        entry = (code or 0) if _behind_veneer(call.callee) == ENTRY_INITIALIZER else 0
        words = _record(image, entry)
        found.append(ProtectedObject(_name_of(image, address), address, ceiling, entry, words))
    return tuple(sorted(set(found), key=lambda item: item.address))


def object_words(objects: Sequence[ProtectedObject]) -> list[dict[str, int]]:
    """Words of protected objects that keep their values: ceiling, span, code of the entry."""
    words = []
    for item in objects:
        span = item.urgency if item.ceiling < FIRST_INTERRUPT_PRIORITY else 0
        words.append({"address": item.address, "value": item.urgency})
        words.append({"address": item.address + 4, "value": span})
        if item.code:
            words.append({"address": item.address + CODE_OFFSET, "value": item.code})
        words += [{"address": address, "value": value} for address, value in item.words]
    return words
