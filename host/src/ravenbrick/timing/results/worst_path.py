# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The worst path on the source, line by line, beside what a job of a run took.

Cycles of a line are those of its own instructions; a call stands below its line, with the lines of
the called function. All lines and remainders of a path add up to its bound, or to the job's time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elftools.common.exceptions import ELFError

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.elf import ElfImage
from ravenbrick.image.source_texts import named_sources
from ravenbrick.timing.observation.job_path import JobPath
from ravenbrick.timing.task_set.scheduled_tasks import TaskTiming

__all__ = [
    "Executed",
    "PathFunction",
    "PathLine",
    "WorstPath",
    "expensive_lines",
    "path_table",
    "source_lines",
    "worst_paths",
]

# Lines of source files, by the files' names.
Sources = Mapping[str, list[str]]

# Lines that the list of the most expensive ones has.
MOST_LINES = 8


@dataclass(frozen=True)
class Executed:
    """How often, and how many cycles."""

    times: int = 0
    cycles: int = 0

    def __add__(self, other: Executed) -> Executed:
        return Executed(self.times + other.times, self.cycles + other.cycles)


@dataclass
class PathLine:
    """A line of a function, or what belongs to no line; `text` is empty where the source is not
    there. None for a path that does not execute it."""

    place: str
    text: str = ""
    worst: Executed | None = None
    run: Executed | None = None
    calls: list[PathFunction] = field(default_factory=list)


@dataclass
class PathFunction:
    """A function as the paths execute it from one line, with all that it calls."""

    name: str
    worst: Executed | None = None
    run: Executed | None = None
    lines: list[PathLine] = field(default_factory=list)

    def all_lines(self) -> Iterator[tuple[PathFunction, PathLine]]:
        """Its lines and those of the functions that it calls."""
        for line in self.lines:
            yield self, line
            for called in line.calls:
                yield from called.all_lines()


@dataclass(frozen=True)
class WorstPath:
    """The worst path of a task's job, its most expensive lines, and when the job of the run began
    that stands beside it; None where there is none."""

    task: str
    function: PathFunction
    expensive: list[tuple[str, str, str, Executed, Executed]]
    begin_seconds: float | None


def source_lines(content: bytes) -> dict[str, list[str]]:
    """Lines of the sources that an ELF file's line tables name and that are there, by the names of
    the files; not of different files with the same name."""
    found: dict[str, list[str]] = {}
    several = set()
    try:
        named = named_sources(content)
    except (ELFError, ValueError, KeyError):
        return {}
    for path in (Path(name) for name in named):
        if path.is_file():
            lines = path.read_text("utf-8", errors="replace").splitlines()
            if found.setdefault(path.name, lines) != lines:
                several.add(path.name)
    return {name: lines for name, lines in found.items() if name not in several}


def _ada_name(symbol: str) -> str:
    """A name as people know it: GNAT's separators and the ending of task bodies taken away."""
    return symbol.removesuffix("TKB").removesuffix("TB").strip("_").replace("__", ".")


def _line(place: str | None, symbol: str, address: int, sources: Sources) -> PathLine:
    """A line with its text; all lines of a function whose source is not there are one."""
    if place is not None:
        file, _, number = place.rpartition(":")
        lines = sources.get(file, [])
        if int(number) <= len(lines):
            return PathLine(place, lines[int(number) - 1].strip())
    return PathLine(f"{symbol} at {address:#x}")


def _sort_key(line: PathLine, home: str) -> tuple[bool, str, int]:
    """Lines of the function's own file first, then those that the compiler inlined."""
    file, _, number = line.place.rpartition(":")
    return file != home, file, int(number) if number.isdigit() else 0


def _add(line: PathLine, side: str, own: Executed) -> None:
    """Takes in executions of a part of a line, which is as frequent as its most frequent part."""
    known = getattr(line, side) or Executed()
    sums = Executed(max(known.times, own.times), known.cycles + own.cycles)
    setattr(line, side, sums)


def _merged(paths: Mapping[str, Sequence[Mapping[str, Any]]], sources: Sources) -> PathFunction:
    """One function, by side (worst, run): what each path executes of it."""
    sides = [(side, path) for side, same in paths.items() for path in same]
    function = PathFunction(_ada_name(sides[0][1]["symbol"]))
    lines: dict[str, PathLine] = {}
    called: dict[str, dict[str, dict[str, list[Mapping[str, Any]]]]] = {}
    for side, path in sides:
        whole = getattr(function, side) or Executed()
        setattr(function, side, whole + Executed(path["calls"], path["cycles"]))
        for row in path["lines"]:
            at = row["at"]
            inside = (at["symbol"] or path["symbol"]).partition("+")[0]
            found = _line(at["line"], inside, path["address"], sources)
            line = lines.setdefault(found.place, found)
            _add(line, side, Executed(row["executions"], row["cycles"]))
            for call in row["calls"]:
                same = called.setdefault(found.place, {}).setdefault(call["symbol"], {})
                same.setdefault(side, []).append(call)
        if path["difference"]:
            rest = lines.setdefault("", PathLine("what facts add, less what they exclude"))
            _add(rest, side, Executed(path["calls"], path["difference"]))
    for place, callees in called.items():
        lines[place].calls = [_merged(same, sources) for same in callees.values()]
    first = next((row["at"]["line"] for row in sides[0][1]["lines"] if row["at"]["line"]), ":")
    home = first.rpartition(":")[0]
    function.lines = sorted(lines.values(), key=lambda line: _sort_key(line, home))
    return function


def path_table(
    worst: Mapping[str, Any],
    sources: Sources,
    run: Mapping[str, Any] | None = None,
    net_cycles: int | None = None,
) -> PathFunction:
    """A worst path (`PathReport` of the crate `wcet`), beside that of a job with `net_cycles`.

    What its instructions differ from this time becomes a line: the trace may charge a job with
    parts of interrupts that it does not show.
    """
    function = _merged({"worst": [worst], "run": [] if run is None else [run]}, sources)
    if run is not None and net_cycles is not None and net_cycles != run["cycles"]:
        rest = Executed(1, net_cycles - run["cycles"])
        function.lines.append(PathLine("what the trace charges to the job besides", run=rest))
        function.run = Executed(run["calls"], net_cycles)
    return function


def expensive_lines(function: PathFunction) -> list[tuple[str, str, str, Executed, Executed]]:
    """The lines that cost most on the worst path, over all calls: place, text, function, worst
    path, run."""
    sums: dict[tuple[str, str, str], tuple[Executed, Executed]] = {}
    for owner, line in function.all_lines():
        key = line.place, line.text, owner.name
        worst, run = sums.get(key, (Executed(), Executed()))
        sums[key] = worst + (line.worst or Executed()), run + (line.run or Executed())
    most = sorted(sums.items(), key=lambda item: -item[1][0].cycles)[:MOST_LINES]
    return [(*key, *executed) for key, executed in most]


def worst_paths(
    tasks: Sequence[TaskTiming], image: ElfImage, runs: Mapping[str, JobPath]
) -> list[WorstPath]:
    """The worst path of each task beside the path of its longest job in the run."""
    sources = source_lines(image.content)
    found = []
    for timing in tasks:
        if timing.job.path is None:
            continue
        run = runs.get(timing.task.name)
        beside = (None, None) if run is None else (run.path, run.cycles)
        function = path_table(timing.job.path, sources, *beside)
        begin = None if run is None else float(MASTER_CLOCK.seconds(run.begin_cycles))
        found.append(WorstPath(timing.task.name, function, expensive_lines(function), begin))
    return found
