# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Timing events (Ada.Real_Time.Timing_Events): their handlers, how often they run, what they cost.

A handler runs in the alarm's interrupt. Handlers are the protected procedures whose address is
taken and that no interrupt is attached to; events are counted by their types.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from elftools.dwarf.die import DIE
from elftools.dwarf.dwarfinfo import DWARFInfo
from elftools.elf.elffile import ELFFile

from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.bounds import Bound, ExecutionTimeError
from ravenbrick.timing.facts.facts import EventLoad, Facts
from ravenbrick.timing.initial_state import Handler
from ravenbrick.timing.kernel import (
    EVENT_RING,
    InterruptCost,
    expiry_facts,
    interrupt_costs,
    no_cost,
)

__all__ = ["EventCost", "event_costs", "event_count", "handlers_of_events"]

EVENT_TYPE = "ada__real_time__timing_events__timing_event"
PROTECTED_PROCEDURE = re.compile(r"^(\w+__\w+)P(\.\w+\.\d+)*$")
WORD_BYTES = 4
LOADED = 2  # SHF_ALLOC
DECLARED = "DW_AT_type"


@dataclass(frozen=True)
class EventCost:
    """A handler with everything around it, from the alarm's request on, and how often it runs.

    `masked_cycles` is the alarm's handler without the event's, which runs unmasked.
    """

    name: str
    handler: Handler
    cycles: int
    body: Bound
    masked_cycles: int
    loads: tuple[EventLoad, ...]

    @property
    def stack_bytes(self) -> int | None:
        """On the handlers' stack."""
        return None if self.body.stack_bytes is None else self.body.stack_bytes + 4


def _ada_name(symbol: str) -> str:
    found = PROTECTED_PROCEDURE.match(symbol)
    return (found[1] if found else symbol).replace("__", ".").title()


def _taken_addresses(elf: ELFFile) -> set[int]:
    """All words of the loaded sections, without the bit that tells Thumb."""
    found: set[int] = set()
    for section in elf.iter_sections():
        if section["sh_flags"] & LOADED and section["sh_type"] != "SHT_NOBITS":
            content = section.data()
            words = memoryview(content[: len(content) // WORD_BYTES * WORD_BYTES]).cast("I")
            found |= {word & ~1 for word in words}
    return found


def handlers_of_events(image: ElfImage, attached: Sequence[Handler]) -> tuple[str, ...]:
    """Symbols of the handlers; none in a program without timing events."""
    if EVENT_RING not in image.symbols:
        return ()
    taken = _taken_addresses(ELFFile(io.BytesIO(image.content)))
    interrupts = {handler.symbol for handler in attached}
    return tuple(
        name
        for name, symbol in sorted(image.symbols.items())
        if PROTECTED_PROCEDURE.match(name)
        and symbol.address & ~1 in taken
        and name not in interrupts
    )


def _type_of(die: DIE) -> DIE | None:
    return die.get_DIE_from_attribute(DECLARED) if DECLARED in die.attributes else None


def _length(array: DIE) -> int:
    """Elements of an array; 1 for bounds that are not static."""
    length = 1
    for bounds in array.iter_children():
        low, high = (bounds.attributes.get(f"DW_AT_{end}_bound") for end in ("lower", "upper"))
        if high is not None and isinstance(high.value, int):
            length *= high.value - (low.value if low is not None else 1) + 1
    return length


def _events_in(kind: DIE | None) -> int:
    """Timing events in an object of a type."""
    if kind is None:
        return 0
    name = kind.attributes.get("DW_AT_name")
    if name is not None and name.value.decode() == EVENT_TYPE:
        return 1
    if kind.tag == "DW_TAG_array_type":
        return _length(kind) * _events_in(_type_of(kind))
    if kind.tag == "DW_TAG_structure_type":
        parts = (part for part in kind.iter_children() if part.tag == "DW_TAG_member")
        return sum(_events_in(_type_of(part)) for part in parts)
    if kind.tag in ("DW_TAG_typedef", "DW_TAG_const_type", "DW_TAG_volatile_type"):
        return _events_in(_type_of(kind))
    return 0


def event_count(image: ElfImage) -> int:
    """Timing events that the program has.

    Raises `ExecutionTimeError` for an image without debugging information.
    """
    if EVENT_RING not in image.symbols:
        return 0
    elf = ELFFile(io.BytesIO(image.content))
    if not elf.has_dwarf_info():
        raise ExecutionTimeError(
            f"{image.path}: has timing events, but no debugging information to count them; "
            "build it with -g"
        )
    count = 0
    for unit in elf.get_dwarf_info().iter_CUs():
        for die in unit.get_top_DIE().iter_children():
            if die.tag == "DW_TAG_variable" and "DW_AT_location" in die.attributes:
                count += _events_in(_type_of(die))
    return max(1, count)


def _place(dwarf: DWARFInfo, address: int) -> str:
    """File and line of the code at an address."""
    for unit in dwarf.iter_CUs():
        program = dwarf.line_program_for_CU(unit)
        if program is None:
            continue
        files = program.header["file_entry"]
        first = 0 if program.header["version"] >= 5 else 1
        for row in (entry.state for entry in program.get_entries()):
            if row is not None and row.address == address and not row.end_sequence:
                return f"{PurePath(files[row.file - first].name.decode()).name}:{row.line}"
    return "the program"


def _loads(image: ElfImage, facts: Facts, symbol: str) -> tuple[EventLoad, ...]:
    name = _ada_name(symbol)
    loads = facts.event_loads(name)
    if loads:
        return loads
    dwarf = ELFFile(io.BytesIO(image.content)).get_dwarf_info()
    place = _place(dwarf, image.symbols[symbol].address & ~1)
    raise ExecutionTimeError(
        f"{place}: how often at most is {name} the handler of a timing event? say in {facts.name}: "
        f'[[timing_event]] handler = "{name}", at_most = ..., window_us = ..., reason = "..."'
    )


def event_costs(
    image: ElfImage,
    alarm: InterruptCost,
    handlers: Sequence[str],
    facts: Facts,
    annotations: Sequence[tuple[str, str]],
) -> tuple[EventCost, ...]:
    """Each handler of an event.

    Raises `ExecutionTimeError` for one without a rate, by file and line.
    """
    if not handlers:
        return ()
    loads = [_loads(image, facts, symbol) for symbol in handlers]

    def cost(known: list[tuple[str, str]]) -> InterruptCost:
        return interrupt_costs(image, [alarm.handler], [*known, *annotations], alarm.timing)[0]

    around = cost([*map(no_cost, handlers), expiry_facts(handlers)]).body.cycles
    found = []
    for symbol, rates in zip(handlers, loads, strict=True):
        whole, name = cost([expiry_facts([symbol])]), _ada_name(symbol)
        found.append(EventCost(name, alarm.handler, whole.cycles, whole.body, around, rates))
    return tuple(found)
