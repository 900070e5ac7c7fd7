# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which values of the unspecified timing parameters the witnesses allow.

Each witness is a constraint: a firmware that works on bricks must get nearly all its frames through
to the co-processor, without starting the link again. `python -m
verification.firmware.witnesses.inference [--workers N]` tries the values of `inference.toml`, one
parameter at a time and two for the picture, the others nominal. It writes `inference.json`, and
from it docs/reference/timing-inference.md and its picture. Absent images are left out by name.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ravenbrick.brick.firmware import FirmwareBrick
from ravenbrick.errors import RunFaultError

from tools.docs import tables
from verification.firmware.witnesses.library import ImageAbsentError, images, timing
from verification.firmware.witnesses.link import count_frames
from verification.firmware.witnesses.others import GNAT, gnat_brick, lejos_brick

__all__ = ["CONSTRAINTS", "Constraint"]

TABLE = Path(__file__).with_name("inference.toml")
RESULTS = Path(__file__).with_name("inference.json")
Row = dict[str, Any]
Value = int | str | bool
COUNTED_S = 1.5
# A firmware that starts its link again loses more frames than the one that a count cuts in two.
MOST_BAD = 1
FEWEST = 0.9


@dataclass(frozen=True)
class Constraint:
    """A firmware, the instant from which its frames are counted, and how many a second there are.

    `most_bad` is the share of bad frames at which the programs still drove.
    """

    name: str
    brick: Callable[[], FirmwareBrick]
    from_s: float
    rate_per_s: int
    most_bad: float = 0.0

    def refusal(self, settings: dict[str, Value]) -> str | None:
        """Why the constraint does not hold with these parameters; None when it does."""
        with timing(dict(settings)):
            brick = self.brick()
        try:
            brick.run(self.from_s)
            counted = count_frames(brick, COUNTED_S)
        except RunFaultError as error:
            return str(error)
        allowed = max(MOST_BAD, self.most_bad * counted.writes)
        if counted.bad > allowed or counted.good < FEWEST * self.rate_per_s * COUNTED_S:
            return str(counted)
        return "the link starts again" if counted.greetings else None


def _of(name: str, from_s: float, rate_per_s: int) -> Constraint:
    return Constraint(name, lambda: images()[name].brick(), from_s, rate_per_s)


def _gnat() -> Iterator[Constraint]:
    for name in GNAT:
        yield Constraint(name, partial(gnat_brick, name), 0.2, 45, most_bad=0.05)


CONSTRAINTS: tuple[Constraint, ...] = (
    _of("LEGO 1.29.2", 2.0, 500),
    _of("NBC/NXC 1.28", 2.0, 500),
    _of("NBC/NXC 1.32", 2.0, 500),
    _of("pbLua 2.0.0 RC2", 3.0, 500),
    _of("nxtOSEK Hello World", 1.5, 450),
    _of("Pybricks 4.0.0b5", 4.0, 200),
    Constraint("leJOS NXJ", lejos_brick, 2.5, 500),
    *_gnat(),
)


def _judge(task: tuple[int, dict[str, Value]]) -> str | None:
    index, settings = task
    try:
        return CONSTRAINTS[index].refusal(settings)
    except ImageAbsentError as error:
        return f"absent: {error}"


def _combinations(table: Row) -> list[dict[str, Value]]:
    """Every set of values to try: nominal, one parameter at a time, then the picture's."""
    single = [
        {parameter["name"]: value}
        for parameter in table["parameter"]
        for value in parameter["values"]
    ]
    picture = table["picture"]
    pairs = [
        {picture["x"]: x, picture["y"]: y} for x in picture["x_values"] for y in picture["y_values"]
    ]
    profiles: list[dict[str, Value]] = [
        {"profile": name} for name in ("nominal", "optimistic", "pessimistic")
    ]
    return [*profiles, *single, *pairs]


def search(workers: int) -> list[Row]:
    """A row for each set of values: the constraints that refuse it, with the reason."""
    sets = _combinations(tomllib.loads(TABLE.read_text(encoding="utf-8")))
    tasks = [(index, settings) for settings in sets for index in range(len(CONSTRAINTS))]
    with ProcessPoolExecutor(workers) as pool:
        answers = list(pool.map(_judge, tasks, chunksize=4))
    rows: list[Row] = []
    for number, settings in enumerate(sets):
        found = answers[number * len(CONSTRAINTS) :][: len(CONSTRAINTS)]
        named = dict(zip((c.name for c in CONSTRAINTS), found, strict=True))
        refused = {n: why for n, why in named.items() if why and not why.startswith("absent")}
        absent = [name for name, why in named.items() if why and why.startswith("absent")]
        rows.append({"settings": settings, "refused": refused, "absent": absent})
    return rows


def main(arguments: list[str] | None = None) -> int:
    """Search and write; 1 when the nominal values are refused."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=2, help="processes (default: 2)")
    options = parser.parse_args(arguments)
    rows = search(options.workers)
    head = {
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "constraints": [constraint.name for constraint in CONSTRAINTS],
    }
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULTS.write_text(f'{{"head": {json.dumps(head)}, "rows": [\n{lines}\n]}}\n', "utf-8")
    tables.main([])
    for name, why in rows[0]["refused"].items():
        print(f"nominal values are refused by {name}: {why}", file=sys.stderr)
    return int(bool(rows[0]["refused"]))


if __name__ == "__main__":
    sys.exit(main())
