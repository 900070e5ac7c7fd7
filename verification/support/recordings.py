# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Small recordings with known instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np
from ravenbrick.clock import MASTER_CLOCK, Clock
from ravenbrick.project.stimuli import TimedInput
from ravenbrick.trace.recording import (
    EVENT_TYPE,
    IDLE,
    EventKind,
    Recording,
    Screen,
    Signal,
    Stop,
    Thread,
)

__all__ = ["MEGAHERTZ", "TC0", "TWI", "Event", "made", "preempted", "sampled"]

K = EventKind
Event = tuple[int, int, int, int]
MEGAHERTZ = Clock(Fraction(1_000_000))
MS = 48_055
TWI, TC0 = 9, 12
# The worker (thread 0) is released at 1000; TWI interrupts it at 1500; the urgent task preempts it
# from 2000 on; it completes at 6000. The urgent task comes again, late, at 100000.
EVENTS = [
    (0, K.PROCESSOR_STOPPED, 0, 0),
    (900, K.PROCESSOR_RESUMED, 0, 0),
    (1000, K.RELEASE, 0, 1000),
    (1010, K.THREAD_RUNNING, 0, 0),
    (1500, K.INTERRUPT_ENTERED, TWI, 0),
    (1600, K.INTERRUPT_LEFT, 0, 0),
    (2005, K.INTERRUPT_ENTERED, TC0, 0),
    (2050, K.RELEASE, 1, 2000),
    (2100, K.INTERRUPT_LEFT, 0, 0),
    (2130, K.THREAD_RUNNING, 1, 0),
    (3000, K.COMPLETION, 1, 2000),
    (3040, K.THREAD_RUNNING, 0, 0),
    (4000, K.MOTOR_COMMAND, 1, 0x100 | (-40 & 0xFF)),
    (6000, K.COMPLETION, 0, 1000),
    (6020, K.THREAD_RUNNING, IDLE, 0),
    (6030, K.PROCESSOR_STOPPED, 0, 0),
    (50_000, K.DISPLAY_CHANGED, 0, 1),
    (99_990, K.PROCESSOR_RESUMED, 0, 0),
    (100_000, K.INTERRUPT_ENTERED, TC0, 0),
    (100_010, K.RELEASE, 1, 99_000),
    (100_200, K.INTERRUPT_LEFT, 0, 0),
    (100_210, K.THREAD_RUNNING, 1, 0),
    (101_000, K.COMPLETION, 1, 99_000),
    (101_020, K.THREAD_RUNNING, IDLE, 0),
    (101_030, K.PROCESSOR_STOPPED, 0, 0),
    (200_000, K.POWER_OFF, 0, 0),
]


def sampled(cycles: Sequence[int], values: Sequence[float]) -> Signal:
    """A signal with these samples."""
    return Signal(np.array(cycles, np.uint64), np.array(values, np.float64))


def made(
    events: Sequence[Event],
    end: int,
    threads: int | Sequence[Thread] = 2,
    signals: Mapping[str, Signal] | None = None,
) -> Recording:
    """A run with a clock of one cycle per microsecond, and as many threads, or these."""
    if isinstance(threads, int):
        threads = [Thread(f"task_{i}", i, 1024, 100) for i in range(threads)]
    return Recording(
        scenario="made",
        clock=MEGAHERTZ,
        stop=Stop("reached", end, ""),
        events=np.array(list(events), dtype=EVENT_TYPE),
        signals=signals or {},
        threads=tuple(threads),
        pictures=(),
        digest="",
    )


def preempted() -> Recording:
    """Two tasks, two interrupt sources, signals of which one begins late, an input, a text."""
    every = [0, MS, 2 * MS, 3 * MS, 4 * MS]
    return Recording(
        scenario="made",
        clock=MASTER_CLOCK,
        stop=Stop("power_off", 200_000, ""),
        events=np.array(EVENTS, dtype=EVENT_TYPE),
        signals={
            "body.x": sampled(every, [0.0, 0.1, 0.2, 0.3, 0.4]),
            "body.y": sampled(every, [0.0, 0.0, 0.0, 0.0, 0.1]),
            "motor.B.angular_velocity": sampled(every, [0.0, 8.2, 8.9, 8.5, 1 / 3]),
            "probe.late": sampled(every[2:], [5.0, 5.0, 7.0]),
        },
        threads=(Thread("worker", 1, 1024, 100), Thread("urgent", 5, 1024, 100)),
        pictures=(),
        digest="ab" * 32,
        inputs=(TimedInput(0, "touch.1", 1.0), TimedInput(7_209, "touch.1", 0.0)),
        screens=(Screen(50_000, ("closed  loop", "set  4.79")),),
    )
