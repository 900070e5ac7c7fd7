# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a program has sent so far, with its own clock, and as a recording for the trace tools."""

from __future__ import annotations

import hashlib
from array import array
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from ravenbrick.clock import Clock
from ravenbrick.telemetry.messages import Sample, SignalDescription, unpack_value
from ravenbrick.trace.recording import EVENT_TYPE, Recording, Signal, Stop

__all__ = ["RunLog"]

MICROSECONDS = Clock(Fraction(1_000_000))
_NUMBERS = 1 << 16
_INSTANTS = 1 << 32


def _nearest(wrapped: int, modulus: int, reference: int) -> int:
    """The number nearest to the reference that is `wrapped` modulo the modulus."""
    ahead = (wrapped - reference) % modulus
    return reference + (ahead if ahead < modulus // 2 else ahead - modulus)


@dataclass
class GroupLog:
    """Samples of a group: instants (us, whole) and one column of values per signal."""

    signals: dict[int, SignalDescription] = field(default_factory=dict)
    times_us: array[int] = field(default_factory=lambda: array("q"))
    columns: dict[int, array[float]] = field(default_factory=dict)
    missing: int = 0
    next_number: int | None = None

    def describe(self, signal: SignalDescription) -> None:
        """Learn a signal; its column begins with the next sample."""
        self.signals[signal.position] = signal

    def add(self, sample: Sample, time_us: int) -> bool:
        """Keep a sample; False when its signals are not known or it repeats an old one."""
        if set(self.signals) != set(range(len(sample.words))):
            return False
        if self.next_number is not None:
            skipped = (sample.number - self.next_number) % _NUMBERS
            if skipped >= _NUMBERS // 2:
                return False
            self.missing += skipped
        self.next_number = (sample.number + 1) % _NUMBERS
        self.times_us.append(time_us)
        for position, word in enumerate(sample.words):
            value = float(unpack_value(self.signals[position].kind, word))
            self.columns.setdefault(position, array("d")).append(value)
        return True


class RunLog:
    """All samples between two starts of the brick."""

    def __init__(self, name: str, begin_us: int) -> None:
        self.name = name
        self.groups: dict[int, GroupLog] = {}
        self.last_us = begin_us
        self.refused = 0

    def describe(self, signal: SignalDescription) -> None:
        """Learn a signal."""
        self.groups.setdefault(signal.group, GroupLog()).describe(signal)

    def add(self, sample: Sample) -> None:
        """Keep a sample at its unwrapped instant."""
        time_us = _nearest(sample.time_us, _INSTANTS, self.last_us)
        group = self.groups.get(sample.group)
        if group is None or not group.add(sample, time_us):
            self.refused += 1
            return
        self.last_us = max(self.last_us, time_us)

    @property
    def sample_count(self) -> int:
        """Samples kept, over all groups."""
        return sum(len(group.times_us) for group in self.groups.values())

    @property
    def missing(self) -> int:
        """Samples that the brick numbered but that never arrived: dropped or lost on the way."""
        return sum(group.missing for group in self.groups.values())

    def recording(self) -> Recording:
        """The run as the trace tools know it; one cycle of its clock is a microsecond."""
        signals: dict[str, Signal] = {}
        digest = hashlib.sha256()
        for _, group in sorted(self.groups.items()):
            cycles = np.array(group.times_us, dtype=np.int64).astype(np.uint64)
            for position, column in sorted(group.columns.items()):
                values = np.array(column, dtype=np.float64)
                signals[group.signals[position].name] = Signal(cycles[-len(values) :], values)
                digest.update(cycles.tobytes() + values.tobytes())
        return Recording(
            scenario=self.name,
            clock=MICROSECONDS,
            stop=Stop("reached", self.last_us, "end of the telemetry"),
            events=np.empty(0, dtype=EVENT_TYPE),
            signals=signals,
            threads=(),
            pictures=(),
            digest=digest.hexdigest(),
        )
