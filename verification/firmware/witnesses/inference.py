# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which values of the unspecified timing parameters the witnesses allow.

Each witness is a constraint: a firmware that works on bricks must get nearly all its frames through
to the co-processor, without starting the link again; a test suite must have the scores that were
published from silicon. `python -m verification.firmware.witnesses.inference [--workers N]` tries
the values of `inference.toml`, one parameter at a time and two for the picture, the others nominal.
It writes `inference.json`, and from it docs/reference/timing-inference.md and its picture. Absent
images are left out by name.
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

import virtual_brick
from ravenbrick.brick.firmware import FirmwareBrick
from ravenbrick.errors import RunFaultError

from tools.docs import tables
from tools.docs.timing_table import settled_by
from verification.firmware.witnesses import chibios
from verification.firmware.witnesses.library import ImageAbsentError, images, timing
from verification.firmware.witnesses.link import count_frames
from verification.firmware.witnesses.others import GNAT, gnat_brick, lejos_brick

__all__ = ["CONSTRAINTS", "Constraint"]

TABLE = Path(__file__).with_name("inference.toml")
RESULTS = Path(__file__).with_name("inference.json")
Row = dict[str, Any]
Value = int | str | bool
COUNTED_S = 0.6
# A firmware that starts its link again loses more frames than the one that a count cuts in two.
MOST_BAD = 1
FEWEST = 0.9
# These drive with an ultrasonic sensor, whose bus keeps the handler of the link waiting. Their
# authors noted that they drive a whole lap, which asks for no more than most of the frames.
BUSY_WITH_SONAR = {f"GNAT topdog {digest}": 0.5 for digest in ("9adf04", "3d48d6", "378385")}


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


@dataclass(frozen=True)
class Scores:
    """A test suite of a kernel whose scores on silicon are published."""

    name: str

    def refusal(self, settings: dict[str, Value]) -> str | None:
        """Which scores are far from the published ones; None when none is."""
        with timing(dict(settings)):
            brick = images()[self.name].brick()
        try:
            shares = chibios.deviations(self.name, chibios.measured(brick))
        except (AssertionError, RunFaultError) as error:
            return str(error)
        return "; ".join(chibios.far(self.name, shares).values()) or None


def _of(name: str, from_s: float, rate_per_s: int) -> Constraint:
    return Constraint(name, lambda: images()[name].brick(), from_s, rate_per_s)


def _gnat() -> Iterator[Constraint]:
    for name in GNAT:
        most_bad = BUSY_WITH_SONAR.get(name, 0.05)
        yield Constraint(name, partial(gnat_brick, name), 0.4, 20, most_bad)


CONSTRAINTS: tuple[Constraint | Scores, ...] = (
    _of("LEGO 1.29.2", 2.5, 495),
    _of("NBC/NXC 1.28", 3.2, 495),
    _of("pbLua 2.0.0 RC2", 1.2, 495),
    _of("nxtOSEK Hello World", 1.2, 495),
    _of("Pybricks 4.0.0b5", 1.2, 245),
    Constraint("leJOS NXJ", lejos_brick, 1.2, 490),
    *_gnat(),
    *map(Scores, chibios.PUBLISHED),
)


def _judge(task: tuple[int, dict[str, Value]]) -> str | None:
    index, settings = task
    try:
        return CONSTRAINTS[index].refusal(settings)
    except ImageAbsentError as error:
        return f"absent: {error}"


def _combinations(table: Row) -> list[dict[str, Value]]:
    """Every set of values to try: profiles, one parameter at a time, then the picture's."""
    single = [
        {parameter["name"]: value}
        for parameter in table["parameter"]
        for value in parameter["values"]
    ]
    picture = table["picture"]
    pairs = [
        {picture["x"]: x, picture["y"]: y} for x in picture["x_values"] for y in picture["y_values"]
    ]
    return [*table["profiles"], *single, *pairs]


def search(workers: int) -> list[Row]:
    """A row for each set of values: the constraints that refuse it, with the reason."""
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    sets, picture = _combinations(table), table["picture"]
    tasks = [
        (index, settings)
        for settings in sets
        for index, constraint in enumerate(CONSTRAINTS)
        if list(settings) != [picture["x"], picture["y"]]
        or constraint.name not in picture["without"]
    ]
    with ProcessPoolExecutor(workers) as pool:
        answers = list(pool.map(_judge, tasks, chunksize=4))
    rows: list[Row] = []
    for settings in sets:
        named = {
            CONSTRAINTS[index].name: answer
            for (index, of), answer in zip(tasks, answers, strict=True)
            if of is settings
        }
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
    settled = settled_by()
    parameters = {
        one["name"]: {"nominal": one["nominal"], "settled": settled[one["name"]]}
        for one in json.loads(virtual_brick.timing_parameters())
    }
    head = {
        "parameters": parameters,
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
