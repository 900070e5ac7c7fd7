# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The run-time in the timing analysis: its services, and loops that grow with the tasks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.bounds import Bound, execution_times
from ravenbrick.timing.facts.facts import annotations_of
from ravenbrick.timing.initial_state import (
    ALARM_SOURCE,
    Handler,
    ProtectedObject,
    initializers,
    object_words,
    protected_objects,
)

__all__ = [
    "ALARM_LATENESS_CYCLES",
    "DELAY_UNTIL",
    "DISPATCH",
    "ENTRY_CALL",
    "EVENT_RING",
    "INTERRUPT",
    "SUSPEND",
    "WAITING",
    "YIELD",
    "InterruptCost",
    "Services",
    "entry_exit_cycles",
    "expiry_facts",
    "handler_facts",
    "interrupt_costs",
    "kernel_facts",
    "no_cost",
    "run_time_facts",
    "services",
]

DELAY_UNTIL = "ada__real_time__delays__delay_until"
PROTECTED = "system__tasking__protected_objects"
ENTRY_CALL = f"{PROTECTED}__single_entry__protected_single_entry_call"
SERVICE_ENTRY = f"{PROTECTED}__single_entry__service_entry"
SUSPEND = "ada__synchronous_task_control__suspend_until_true"
SET_TRUE = "ada__synchronous_task_control__set_true"
SET_FALSE = "ada__synchronous_task_control__set_false"
YIELD = "ada__dispatching__yield"
# Operations in which a thread may give the processor to one that is no more urgent.
WAITING = frozenset((DELAY_UNTIL, ENTRY_CALL, SUSPEND, YIELD))
INTERRUPT = "ravenbrick_interrupt"
RESUME = "resume"
EVENTS = "ada__real_time__timing_events"
SET_HANDLERS = (f"{EVENTS}__set_handler", f"{EVENTS}__cancel_handler")
DISPATCH = f"{PROTECTED}__dispatch"
MASKING = (
    DELAY_UNTIL,
    ENTRY_CALL,
    SERVICE_ENTRY,
    SUSPEND,
    SET_TRUE,
    SET_FALSE,
    YIELD,
    DISPATCH,
    *SET_HANDLERS,
)
SETTING = (DELAY_UNTIL, *SET_HANDLERS)
EVENT_RING = "ravenbrick__delays__events__ring_with_events"
EXPIRE = f"{EVENTS}__expire"
RINGS = ("ravenbrick__delays__ring", EVENT_RING)
QUEUES = (
    "ravenbrick-threads.adb",
    "ravenbrick-delays.adb",
    "ravenbrick-delays-events.adb",
    "interrupt.S",
)
# Looks at all threads.
SUPERVISION = "ravenbrick-supervision.adb"
# What a task calls at its end, where the program has set a handler, and the word that names it.
AT_END = "system__tasking__restricted__stages__complete_restricted_task"
END_HANDLER = "ada__task_termination__call_fallback"
END_HOOK = "system__tasking__at_termination"
# GNAT names them by where the object is declared: in a body or in a specification.
ENTRY_CODE = re.compile(r"_[BE]\d+[bs]$")

EXCEPTION_CYCLES = 3
# From the alarm's request until the processor sees it, by timing profile: tick of the clock,
# shortest count of the alarm's timer, synchronisation in controller and processor
# (`aic_level_cycles`, `core_sync_cycles`), the longest instruction.
ALARM_LATENESS_CYCLES = {
    "optimistic": 16 + 4 + 5 + 20,
    "nominal": 16 + 4 + 6 + 20,
    "pessimistic": 16 + 4 + 7 + 20,
}
# What the alarm is set early by, so that the wake-up time has passed when its handler looks.
ALARM_LEAD_CYCLES = 2 * (48 + 24)


@dataclass(frozen=True)
class InterruptCost:
    """A handler with entry and exit: from the exception until the interrupted thread goes on."""

    handler: Handler
    cycles: int
    body: Bound
    timing: str = "nominal"

    @property
    def stack_bytes(self) -> int | None:
        """On the handlers' stack."""
        return None if self.body.stack_bytes is None else self.body.stack_bytes + 4


@dataclass(frozen=True)
class Services:
    """Bounds of the run-time's own services in one image, in cycles.

    `dispatch` is the call with which a thread gives the processor away at the end of a protected
    action; 0 if the image has none.
    """

    delay_until: int
    resume: int
    masking: dict[str, int]
    timing: str = "nominal"
    dispatch: int = 0

    @property
    def release_jitter(self) -> int:
        """Longest from a wake-up time until the alarm's handler can be entered."""
        setting = max(self.masking.get(name, 0) for name in SETTING)
        return ALARM_LATENESS_CYCLES[self.timing] + max(0, setting - ALARM_LEAD_CYCLES)

    def longest_masked(self, reached: Iterable[str]) -> tuple[int, str]:
        """The longest service with masked interrupts among these functions."""
        found = [(self.masking[name], name) for name in reached if name in self.masking]
        return max(found, default=(0, ""))

    def resumed_masked_cycles(self, reached: Iterable[str]) -> int:
        """Longest time that a thread goes on with masked interrupts when it was interrupted just as
        it masked them; `reached` are the functions that its job may call."""
        masked, _ = self.longest_masked(reached)
        return masked + self.resume if masked else 0


def _entry_facts(image: ElfImage) -> str:
    """Barriers and bodies of entries, which the run-time calls indirectly."""
    targets = sorted(name for name in image.symbols if ENTRY_CODE.search(name))
    functions = [name for name in (ENTRY_CALL, SERVICE_ENTRY) if name in image.symbols]
    if not targets:
        return ""
    return annotations_of({"call": [{"symbol": f, "targets": targets} for f in functions]})


def _end_facts(image: ElfImage) -> str:
    """What a task calls that ends: nothing, unless the program has handlers of that."""
    if AT_END not in image.symbols:
        return ""
    if END_HANDLER in image.symbols:
        return annotations_of({"call": [{"symbol": AT_END, "targets": [END_HANDLER]}]})
    if END_HOOK not in image.symbols:
        return ""
    hook = {"address": image.symbols[END_HOOK].address, "value": 0}
    return annotations_of({"word": [hook]})


def kernel_facts(thread_count: int, objects: Sequence[ProtectedObject]) -> str:
    """Loops over queues, and words that are constant after elaboration.

    The alarm's handler is bounded for one thread: each release is charged a call of its own, which
    is more than the share of a call that releases several.
    """
    loops: list[dict[str, object]] = [
        {"symbol": ring, "index": 0, "iterations": 1} for ring in RINGS
    ]
    # The search of the ready queue that is compiled into the handler.
    loops += [{"symbol": ring, "index": 1, "header_executions": thread_count} for ring in RINGS]
    loops += [{"file": file, "header_executions": thread_count, "every": True} for file in QUEUES]
    loops += [{"file": SUPERVISION, "header_executions": thread_count + 1, "every": True}]
    return annotations_of({"loop": loops, "word": [dict(w) for w in object_words(objects)]})


def handler_facts() -> tuple[str, str]:
    """What is executed by handlers only never gives the processor away at the end of a protected
    action: no thread is as urgent as a handler, which `attached_handlers` checks."""
    return "handlers", annotations_of({"never": [{"symbol": DISPATCH}]})


def expiry_facts(handlers: Sequence[str]) -> tuple[str, str]:
    """Handlers that the alarm calls for expired events; without handlers, none expires."""
    if not handlers:
        return "no expiry", annotations_of({"never": [{"symbol": EXPIRE}]})
    calls = [
        {"symbol": EVENT_RING, "targets": [EXPIRE]},
        {"symbol": EXPIRE, "targets": list(handlers)},
    ]
    return "timing events", annotations_of({"call": calls})


def run_time_facts(
    image: ElfImage, thread_count: int, expiring: Sequence[str] = ()
) -> tuple[tuple[ProtectedObject, ...], list[tuple[str, str]]]:
    """The protected objects that elaboration sets up, and annotations of the run-time's code."""
    entries = ("entries", _entry_facts(image) + _end_facts(image))
    elaborated = execution_times(
        image.content, root="adainit", callees=initializers(image), annotations=[entries]
    )
    objects = protected_objects(image, elaborated.calls)
    if expiring:
        entries = (entries[0], entries[1] + expiry_facts(expiring)[1])
    return objects, [entries, ("run-time", kernel_facts(thread_count, objects))]


def services(
    image: ElfImage, annotations: Sequence[tuple[str, str]], timing: str = "nominal"
) -> Services:
    """Bounds of the services that the image has, in a timing profile. Raises `ImageFileError` for
    an old image."""
    missing = [name for name in (RESUME, INTERRUPT) if name not in image.symbols]
    if missing:
        raise ImageFileError(
            f"{image.path}: has no '{missing[0]}', which the run-time of this version has; the "
            "image is older: build it again with 'ravenbrick build'"
        )
    present = [name for name in MASKING if name in image.symbols]
    found = execution_times(
        image.content, functions=[*present, RESUME], annotations=annotations, timing=timing
    )
    cycles = {bound.symbol: bound.cycles for bound in found.functions}
    resume = cycles.pop(RESUME) + found.return_cycles
    dispatch = cycles[DISPATCH] + found.return_cycles if DISPATCH in cycles else 0
    return Services(cycles.get(DELAY_UNTIL, 0), resume, cycles, timing, dispatch)


def no_cost(symbol: str) -> tuple[str, str]:
    """A function left out of a bound."""
    return f"without {symbol}", annotations_of({"cost": [{"symbol": symbol, "cycles": 0}]})


def entry_exit_cycles(
    image: ElfImage, cost: InterruptCost, annotations: Sequence[tuple[str, str]]
) -> int:
    """Bound of an interrupt's entry and exit, without its handler."""
    without = [no_cost(cost.handler.symbol), *annotations]
    return interrupt_costs(image, [cost.handler], without, cost.timing)[0].cycles


def interrupt_costs(
    image: ElfImage,
    handlers: Sequence[Handler],
    annotations: Sequence[tuple[str, str]],
    timing: str = "nominal",
) -> tuple[InterruptCost, ...]:
    """Cost of each handler in a timing profile, the alarm's first."""
    found = []
    for handler in sorted(handlers, key=lambda each: each.source != ALARM_SOURCE):
        target = annotations_of(
            {
                "call": [{"symbol": INTERRUPT, "targets": [handler.symbol]}],
                "word": [{"address": address, "value": value} for address, value in handler.words],
            }
        )
        times = execution_times(
            image.content,
            functions=[INTERRUPT, handler.symbol],
            annotations=[*annotations, handler_facts(), ("interrupt entry", target)],
            timing=timing,
        )
        whole, body = times.functions
        cycles = EXCEPTION_CYCLES + whole.cycles + times.return_cycles
        found.append(InterruptCost(handler, cycles, body, timing))
    return tuple(found)
