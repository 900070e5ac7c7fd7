# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles and bytes of the run-time beside published peers."""

from __future__ import annotations

from collections.abc import Iterator

from verification.benchmarks.figures import Figure
from verification.benchmarks.runtime.footprints import footprints
from verification.benchmarks.runtime.measure import figures

# Both run outside the project on the virtual brick, as ARM code in RAM.
FREERTOS = "FreeRTOS 11.1.0, port ARM7_AT91SAM7S, gcc 12.2 -O2, on the virtual brick 2026-11-23"
CHIBIOS = "ChibiOS/RT 2.4.0, its own test suite, gcc 12.2 -O2, on the virtual brick 2026-11-26"

# Value and source of peers that cannot run beside ours.
PUBLISHED = {
    "run-time text": (7292, "FreeRTOS 11.1 kernel with mutex, ARM -Os, compiled 2026"),
    "context switch, voluntary": (86.5, f"switch; {CHIBIOS}"),
    "protected procedure with its call": (94.3, f"mutex lock and unlock; {CHIBIOS}"),
    "suspension object to task": (515, f"semaphore; {FREERTOS}"),
    "entry opened to task": (429, f"notification; {FREERTOS}"),
    "interrupt to handler": (95, FREERTOS),
    "interrupt to task": (524, f"semaphore; {FREERTOS}"),
    "delay until, idle processor": (421, f"xTaskDelayUntil; {FREERTOS}"),
    "delay until, six tasks released together": (3593, f"xTaskDelayUntil; {FREERTOS}"),
    "timing event to handler": (943, f"timer callback; {FREERTOS}"),
    "work while idle, per second": (195_000, "FreeRTOS ARM7 port, ticks of 1 ms"),
    "control block": (72, "FreeRTOS 11.1 task control block"),
    "kernel and Ada layer with all its services, arm text": (
        7292,
        "FreeRTOS 11.1 with mutex, ARM -Os",
    ),
    "kernel and Ada layer with all its services, thumb text": (
        5324,
        "FreeRTOS 11.1 with mutex, Thumb -Os",
    ),
    "two tasks, thumb text": (5196, "FreeRTOS 11.1, two tasks, delay, semaphore, Thumb -Os"),
    "two tasks, arm text": (7104, "FreeRTOS 11.1, two tasks, delay, semaphore, ARM -Os"),
}


def cycles() -> Iterator[Figure]:
    """Cycles of the run-time's operations: mean and worst of thousands of random phases."""
    for measured in figures():
        name = measured["figure"]
        value, source = PUBLISHED.get(name, (None, None))
        if measured["mean"] is not None:
            unit = f"{measured['unit']}, mean"
            yield Figure(name, measured["mean"], unit, source, value)
        yield Figure(f"{name}, worst", measured["worst"], measured["unit"])


def footprint_bytes() -> Iterator[Figure]:
    """Bytes of small programs in both states and of a task's control block."""
    for figure, value in footprints():
        source = PUBLISHED.get(figure)
        peer, peer_value = (source[1], source[0]) if source else (None, None)
        yield Figure(f"footprint of {figure}", value, "bytes", peer, peer_value)
