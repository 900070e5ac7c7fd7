# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a campaign draws for hidden runs: seeds from its secret, pulses of an input from a seed.

A program that prints what the public scenario leads to is wrong for drawn pulses.
"""

from __future__ import annotations

import hashlib
import random
from dataclasses import dataclass

from ravenbrick.project.scenario import Input

__all__ = ["Pulses", "hidden_seeds"]

# Whole periods of any task of the lab sheets that samples a sensor.
GRID_MS = 20
SHORTEST_MS = 100


def hidden_seeds(secret: str, check: str, count: int) -> tuple[int, ...]:
    """So many seeds of a check, which nobody knows without the secret."""
    digests = (hashlib.sha256(f"{secret} {check} {n}".encode()) for n in range(count))
    return tuple(int(digest.hexdigest()[:7], 16) for digest in digests)


@dataclass(frozen=True)
class Pulses:
    """An input is 1 a drawn number of times, for drawn times, in a window of a scenario."""

    input: str
    least: int
    most: int
    from_ms: int
    until_ms: int

    def __post_init__(self) -> None:
        room = (self.until_ms - self.from_ms) // max(self.most, 1)
        if self.least > self.most or room < 2 * SHORTEST_MS + 2 * GRID_MS:
            raise ValueError(
                f"{self.most} pulses do not fit between {self.from_ms} and {self.until_ms} ms; "
                f"each needs {2 * SHORTEST_MS + 2 * GRID_MS} ms"
            )

    def draw(self, seed: int) -> list[tuple[int, int]]:
        """Begin and end of each pulse in ms, at whole multiples of 20 ms apart."""
        numbers = random.Random(seed)
        count = numbers.randint(self.least, self.most)
        room = (self.until_ms - self.from_ms) // count // GRID_MS
        shortest = SHORTEST_MS // GRID_MS
        pulses = []
        for place in range(count):
            long = numbers.randint(shortest, room - shortest)
            begin = place * room + numbers.randint(1, room - long - 1)
            pulses.append((self.from_ms + begin * GRID_MS, self.from_ms + (begin + long) * GRID_MS))
        return pulses

    def filled(self, text: str, seed: int) -> str:
        """A sentence with the drawn `{count}`, and the time at 1 of all pulses as `{total_ms}`."""
        pulses = self.draw(seed)
        total = sum(end - begin for begin, end in pulses)
        return text.replace("{count}", str(len(pulses))).replace("{total_ms}", str(total))

    def inputs(self, others: tuple[Input, ...], seed: int) -> tuple[Input, ...]:
        """The scenario's inputs with these instead of its own of that name."""
        kept = [entry for entry in others if entry.name != self.input]
        drawn = [
            Input(at_ms, self.input, value, "drawn", 0)
            for begin, end in self.draw(seed)
            for at_ms, value in ((begin, 1.0), (end, 0.0))
        ]
        return tuple(sorted([*kept, *drawn], key=lambda entry: entry.at_ms))
