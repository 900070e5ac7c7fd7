# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expectations in words, one sentence each; the grammar is in docs/reference/trace.md.

The compiled module reads and judges them, so the page and the commands say the same.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass

from ravenbrick.installation import brick_module

__all__ = ["PIN", "Expectation", "ExpectationSyntaxError", "expected_pins", "parse_expectation"]

# A pin's level is the signal of this name and its number.
PIN = "pin."


class ExpectationSyntaxError(ValueError):
    """A sentence that is not an expectation."""


@dataclass(frozen=True)
class Expectation:
    """`text` as it was written, `place` where, and what to know of it before the run.

    `last_named` is the latest instant of its window (s), `pin` the one it is about. `judges_tasks`:
    it is about deadlines or response times, of `task` or, with None, of all.
    """

    text: str
    place: str
    last_named: float
    pin: int | None
    judges_faults: bool
    judges_tasks: bool
    task: str | None


def parse_expectation(text: str, place: str) -> Expectation:
    """Read one sentence; raises `ExpectationSyntaxError`, which says what the forms are."""
    try:
        return Expectation(place=place, **json.loads(brick_module().expectation(text)))
    except ValueError as error:
        raise ExpectationSyntaxError(str(error)) from None


def expected_pins(expectations: Iterable[Expectation]) -> list[int]:
    """Pins that expectations are about: 0 to 31."""
    return sorted({e.pin for e in expectations if e.pin is not None})
