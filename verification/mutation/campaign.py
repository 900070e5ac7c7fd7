# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sample mutants of a room, run the room's own tests on each, and write the table of scores.

`python -m verification.mutation.campaign ROOM ... [--sample 60] [--seed 1] [--minutes 50]` goes on
where an earlier run ended, also one in another clone: `outcomes/` keeps what was found. An outcome
holds while the mutated file, and for survivors the tests too, stay as they are. Each survivor gets
a verdict, by hand, in `verdicts.toml`; `results.json` becomes docs/reference/mutants.md.
Of a mutant in Python the tests run that execute it. In other rooms `--near 2` runs only the two
files of tests that share most words with the mutated file: what they kill is killed; what survives
them counts as a survivor, which other tests judge again.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
import tomllib
from collections.abc import Iterator
from contextlib import ExitStack
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write

from tools.docs import tables
from verification.built_examples import build_example
from verification.commands import Counts, NotRunError
from verification.mutation.executed import Executed
from verification.mutation.mutants import Mutant, ranked
from verification.mutation.one_build import one_build
from verification.mutation.rooms import ROOMS, Room, digest_of
from verification.mutation.scratch import Scratch, unchanged_s
from verification.support.paths import ROOT

RESULTS = ROOT / "verification" / "mutation" / "results.json"
VERDICTS = RESULTS.with_name("verdicts.toml")
OUTCOMES = RESULTS.with_name("outcomes")
SAMPLE = 60
SEED = 1
MINUTES = 50
GOAL_ROOM = 0.85
LIMIT_S = 1_200
Row = dict[str, Any]


def verdicts(path: Path = VERDICTS) -> dict[str, Row]:
    """The reviewed survivors by the mutant's name: `verdict`, "equivalent" or "open", `reason`."""
    entries = tomllib.loads(path.read_text(encoding="utf-8")).get("survivor", [])
    return {entry["mutant"]: entry for entry in entries}


class Outcomes:
    """What earlier runs found of a room's mutants that there still are, in a file after each.

    A survivor has survived the tests whose digest is kept: the nearest files, or all of the room.
    """

    def __init__(self, room: Room, near: int = 0) -> None:
        self.room, self.near = room, near
        self.file = OUTCOMES / f"{room.name}.json"
        kept = json.loads(self.file.read_text()) if self.file.exists() else {}
        present = {mutant.key for mutant in room.mutants(ROOT)}
        self.kept: dict[str, Row] = {key: row for key, row in kept.items() if key in present}
        self.all_tests = digest_of(room.files(ROOT, room.tests))
        self._near_tests: dict[str, str] = {}

    def tests(self, mutant: Mutant) -> str:
        """One digest of the tests that judge a mutant."""
        if mutant.file not in self._near_tests:
            nearest = self.room.tests_near(ROOT, mutant.file, self.near)
            read = [file for test in nearest for file in self.room.read_by(test)]
            self._near_tests[mutant.file] = digest_of(read) if nearest else self.all_tests
        return self._near_tests[mutant.file]

    def of(self, mutant: Mutant) -> str | None:
        """Killed, survived or refused (by the compiler); None when it has to be run."""
        row = self.kept.get(mutant.key)
        if row is None or row["source"] != digest_of([ROOT / mutant.file]):
            return None
        stale = row["outcome"] == "survived" and row["tests"] not in (
            self.all_tests, self.tests(mutant)
        )  # fmt: skip
        return None if stale else str(row["outcome"])

    def keep(self, mutant: Mutant, outcome: str) -> None:
        """Write an outcome down, whole."""
        source = digest_of([ROOT / mutant.file])
        self.kept[mutant.key] = {"outcome": outcome, "source": source, "tests": self.tests(mutant)}
        self.file.parent.mkdir(exist_ok=True)
        rows = sorted(self.kept.items())
        lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(row)}" for key, row in rows)
        atomic_write(self.file, f"{{\n{lines}\n}}\n")


class Judge:
    """Runs mutants of one room in its scratch copy, with time limits from unchanged runs."""

    def __init__(self, room: Room, scratch: Scratch, near: int = 0) -> None:
        self.room, self.scratch, self.near = room, scratch, near
        self.used_s = 0.0  # processor time of the last mutant
        for file in room.files(scratch.tree, room.sources):
            if file.suffix == ".rs":
                file.touch()  # Cargo's products outlive the copy of an earlier run
        self._needed_s: dict[Path, float] = {}

    def _limit_s(self, tests: list[Path]) -> float:
        """For tests which have passed unchanged, once for each file; no file: all of the room."""
        keys = tests or [self.scratch.tree]
        new = [path for path in keys if path not in self._needed_s]
        if new:
            if not self._needed_s:
                unchanged_s(self.scratch, self.room.build, LIMIT_S, builds=True)
            needed_s = unchanged_s(self.scratch, self.room.command(tests and new), LIMIT_S)
            self._needed_s |= dict.fromkeys(new, needed_s / len(new))
        return 30 + 5 * sum(self._needed_s[path] for path in keys)

    def _prepare(self, mutant: Mutant) -> None:
        """Do what needs the sources as they are."""
        self._limit_s(self._tests_near(mutant))

    def _tests_near(self, mutant: Mutant) -> list[Path]:
        return self.room.tests_near(self.scratch.tree, mutant.file, self.near)

    def _takes(self, mutant: Mutant, changed: str) -> bool:
        """Whether a compiler takes what the mutant makes of its file."""
        taken, self.used_s = self.scratch.run(self.room.build, LIMIT_S)
        return taken

    def _passed(self, mutant: Mutant, source: str) -> bool:
        """Whether the tests of a mutant of this source pass."""
        tests = self._tests_near(mutant)
        passed, needed_s = self.scratch.run(self.room.command(tests), self._limit_s(tests))
        self.used_s += needed_s
        return passed

    def outcome(self, mutant: Mutant) -> str:
        """Of one mutant; the file is as before afterwards."""
        file = self.scratch.tree / mutant.file
        source = file.read_text(encoding="utf-8")
        self._prepare(mutant)
        changed = mutant.applied(source)
        file.write_text(changed, encoding="utf-8")
        try:
            if not self._takes(mutant, changed):
                return "refused"
            return "survived" if self._passed(mutant, source) else "killed"
        finally:
            file.write_text(source, encoding="utf-8")

    def in_one_build(self, mutants: list[Mutant], end: float) -> Iterator[tuple[Mutant, str]]:
        """Outcomes of those that a run can choose."""
        with one_build(self.room, self.scratch, mutants, LIMIT_S) as tests:
            for mutant, test in tests.items():
                limit_s = self._limit_s([])
                if time.monotonic() > end:
                    return
                passed, self.used_s = self.scratch.run(test, limit_s)
                yield mutant, "survived" if passed else "killed"


class PythonJudge(Judge):
    """Of a mutant it runs the tests that execute it."""

    @cached_property
    def _executed(self) -> Executed:
        unchanged_s(self.scratch, self.room.build, LIMIT_S, builds=True)
        return Executed(self.room, self.scratch, LIMIT_S)

    def _prepare(self, mutant: Mutant) -> None:
        assert self._executed

    def _takes(self, mutant: Mutant, changed: str) -> bool:
        self.used_s = 0.0
        try:
            compile(changed, mutant.file, "exec")
        except SyntaxError:
            return False
        return True

    def _passed(self, mutant: Mutant, source: str) -> bool:
        tests = self._executed.tests(mutant, source)
        if not tests:
            self.scratch.log.write_text("no test executes it\n")
            return True
        passed, self.used_s = self._executed.passed(tests)
        return passed


def judged(
    room: Room, sample: int, seed: int, end: float, near: int = 0
) -> Iterator[tuple[Mutant, str]]:
    """The first mutants in the seed's order that a compiler takes, each with its outcome."""
    outcomes, found, judge = Outcomes(room, near), 0, None
    waiting = ranked(room.mutants(ROOT), seed)

    def known(judge: Judge, mutant: Mutant, outcome: str) -> str:
        outcomes.keep(mutant, outcome)
        place = f"{mutant.line}: {mutant.key} ({judge.scratch.said()})"
        print(f"{room.name} {outcome} {judge.used_s:.1f} s {place}", file=sys.stderr, flush=True)
        return outcome

    with ExitStack() as stack:
        for mutant in waiting:
            outcome = outcomes.of(mutant)
            if outcome is None and judge is None and time.monotonic() <= end:
                judging = PythonJudge if room.executed else Judge
                if room.executed:
                    build_example("vehicle")  # the tests take it as built, as with `make test`
                judge = judging(room, stack.enter_context(Scratch(room.name)), near)
                if room.one_build:
                    counted = (other for other in waiting if outcomes.of(other) != "refused")
                    unknown = [m for m in islice(counted, sample) if outcomes.of(m) is None]
                    for other, result in judge.in_one_build(unknown, end):
                        known(judge, other, result)
                    outcome = outcomes.of(mutant)
            if outcome is None:
                if judge is None or time.monotonic() > end:
                    return
                outcome = known(judge, mutant, judge.outcome(mutant))
            if outcome != "refused":
                found += 1
                yield mutant, outcome
            if found == sample:
                return


def measure(
    name: str, sample: int = SAMPLE, seed: int = SEED, minutes: float = MINUTES, near: int = 0
) -> tuple[Row, list[str]]:
    """The room's row, which is also written, and its survivors without a verdict."""
    reviewed = verdicts()
    results = list(judged(ROOMS[name], sample, seed, time.monotonic() + 60 * minutes, near))
    survivors = [mutant.key for mutant, outcome in results if outcome == "survived"]
    known = {key: reviewed[key] for key in survivors if key in reviewed}
    equivalent = [key for key, entry in known.items() if entry["verdict"] == "equivalent"]
    row = {
        "room": name,
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "seed": seed,
        "sampled": len(results),
        "killed": len(results) - len(survivors),
        "equivalent": len(equivalent),
        "survivors": [
            {"mutant": key, "verdict": entry["verdict"], "reason": entry["reason"]}
            for key, entry in known.items()
        ] + [{"mutant": k, "verdict": "open", "reason": ""} for k in survivors if k not in known],
    }  # fmt: skip
    tables.merge_rows(RESULTS, [row], ("room",))
    return row, [key for key in survivors if key not in known]


def score(rows: list[Row]) -> float:
    """Share of the mutants that change behaviour which are killed."""
    of = sum(row["sampled"] - row["equivalent"] for row in rows)
    return sum(row["killed"] for row in rows) / max(of, 1)


def counts(row: Row, new: list[str]) -> Counts:
    """What a room's row holds; survivors without a verdict and a low score are failures."""
    if score([row]) < GOAL_ROOM:
        low = f"{row['room']}: {score([row]):.0%} are killed, {GOAL_ROOM:.0%} are expected"
        new = [*new, low]
    still_open = row["sampled"] - row["killed"] - row["equivalent"] - len(new)
    excluded = [
        {"count": row["equivalent"], "reason": "equivalent"},
        {"count": max(still_open, 0), "reason": "survive, with a verdict in verdicts.toml"},
    ]
    left_out = [entry for entry in excluded if entry["count"]]
    drawn = f"drawn by seed {row['seed']}, {score([row]):.0%} of those not equivalent are killed"
    return Counts(row["sampled"], row["killed"], left_out, new, [drawn])


def suite(name: str) -> Counts:
    """Mutants of a room: equivalent and reviewed ones left out, new survivors and low scores fail.

    Raises `NotRunError` when the time did not suffice, or RAVENBRICK_MUTATION_MINUTES gives none,
    with what is held; the next run goes on there.
    """
    minutes = float(os.environ.get("RAVENBRICK_MUTATION_MINUTES", 0))
    if minutes:
        row, new = measure(name, minutes=minutes)
        if row["sampled"] >= SAMPLE:
            return counts(row, new)
        reason = f"{row['sampled']} of {SAMPLE} mutants so far; run it again to go on"
        raise NotRunError(reason, counts(row, new), row["date"])
    reason = f"all rooms take many hours: RAVENBRICK_MUTATION_MINUTES={MINUTES} gives each so long"
    row = next((row for row in tables.read_rows(RESULTS) if row["room"] == name), {})
    if not row:
        raise NotRunError(reason)
    new = [one["mutant"] for one in row["survivors"] if not one["reason"]]
    raise NotRunError(reason, counts(row, new), row["date"])


def main(arguments: list[str]) -> int:
    """Measure the rooms and write the page; 1 when one misses the goal or has new survivors."""
    parser = argparse.ArgumentParser(prog="python -m verification.mutation.campaign")
    parser.add_argument("rooms", nargs="*", choices=[*ROOMS, []], metavar="ROOM")
    parser.add_argument("--sample", type=int, default=SAMPLE)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--minutes", type=float, default=MINUTES, help="for each room")
    parser.add_argument("--near", type=int, default=0, help="files of tests; 0: all of the room")
    chosen = parser.parse_args(arguments)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)  # the scratch copy is removed
    wrong = False
    for name in chosen.rooms or ROOMS:
        row, new = measure(name, chosen.sample, chosen.seed, chosen.minutes, chosen.near)
        wrong = wrong or bool(new) or score([row]) < GOAL_ROOM
        print(f"{name}: {row['killed']} of {row['sampled']} killed, {row['equivalent']} equivalent")
        print("".join(f"  no verdict: {key}\n" for key in new), end="")
    tables.main([])
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
