# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Flow facts that each run counts: iterations, targets of calls, recursion, excluded places."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.errors import UsageError
from ravenbrick.image.elf import ElfImage
from ravenbrick.installation import brick_module
from ravenbrick.timing.facts.facts import Facts

__all__ = ["CountedFact", "counted_facts", "points_text", "turn_facts"]


@dataclass(frozen=True)
class CountedFact:
    """A fact with a place at which it is counted.

    `fact` is the fact as it is written, `declared` what it allows (iterations, activations at the
    same time; 0 for no execution), `point` where and what to count, as the virtual brick takes it;
    `mode` is the one in which it holds, empty for always; `turn` the number of the turn of jobs
    and their task, for what these do not execute.
    """

    fact: str
    file: str
    table: str
    place: str
    declared: int
    point: dict[str, Any]
    mode: str = ""
    turn: tuple[int, str] | None = None


def turn_facts(image: ElfImage, facts: Facts) -> tuple[CountedFact, ...]:
    """What jobs of each turn do not execute, of tasks that keep a common release."""
    found = []
    stated = (facts.in_turn(name) for name in dict.fromkeys(fact.task for fact in facts.turns))
    for fact in (fact for fact in stated if fact is not None):
        text = f'{fact.file}: [[jobs_in_turn]] task = "{fact.task}"'
        for turn, symbols in enumerate(fact.never):
            for symbol in (name for name in symbols if name in image.symbols):
                begin = image.symbols[symbol].address & ~1
                point = {"kind": "place", "addresses": [begin]}
                of_turn = (turn, fact.task)
                found.append(CountedFact(text, fact.file, "turn", symbol, 0, point, turn=of_turn))
    return tuple(found)


def counted_facts(
    elf: bytes,
    roots: Sequence[str],
    annotations: Sequence[tuple[str, str]],
    files: Collection[str],
) -> tuple[CountedFact, ...]:
    """Facts of these annotation files about the functions `roots` and all that they call.

    Raises `UsageError` for a wrong annotation.
    """
    request = {
        "annotations": [{"name": name, "text": text} for name, text in annotations],
        "counted": list(roots),
    }
    try:
        answer = json.loads(brick_module().bound_execution_times(elf, json.dumps(request)))
    except ValueError as error:
        raise UsageError(str(error)) from None
    return tuple(CountedFact(**row) for row in answer["counted"] if row["file"] in files)


def points_text(facts: Sequence[CountedFact]) -> str:
    """Where to count, as the virtual brick takes it."""
    return json.dumps([fact.point for fact in facts])
