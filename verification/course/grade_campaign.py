# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many generated submissions on one worker, two workers and a local Dask cluster.

`python -m verification.course.grade_campaign [COUNT]` writes docs/reference/grading-throughput.md
and prints one JSON object. Each way builds, runs and judges all submissions, with objects and
images of its own. The submissions come in slices, and the ways take turns with each slice, so that
what else the machine does meets all of them: the ratios are those of neighbours in time.
"""

from __future__ import annotations

import ctypes
import importlib.util
import json
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.submission import Submission, find_submissions

from verification.benchmarks.figures import Figure
from verification.commands import Counts
from verification.course.attacks import COMPILER, FILES, Place
from verification.processor_time import processor_s
from verification.support.paths import ROOT
from verification.support.submissions import RUBRIC, variant, write_submission

PAGE = ROOT / "docs" / "reference" / "grading-throughput.md"
COUNT, SLICE, WORKERS = 300, 20, 2
PR_SET_CHILD_SUBREAPER = 36
# How long the first process of a sandbox may outlive it.
LEFT_S = 0.5
# One of so many submissions is hostile.
HOSTILE_EVERY = 10
MEASURED = 40
HOSTILE = [attack for pair in zip(FILES, COMPILER, strict=False) for attack in pair]
PLACE = Place(Path("/etc/passwd"), RUBRIC, ROOT / "docs" / "teaching" / "01-tasks.md")
NO_DASK = "the package distributed is not installed: pip install -r tools/requirements/cluster.txt"


@dataclass
class Way:
    """How submissions are graded, what came out, and what each slice took."""

    name: str
    folder: Path
    options: dict[str, Any]
    results: list[dict[str, Any]] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    processor_seconds: float = 0.0

    def grade(self, rubric: Rubric, submissions: list[Submission], counted: bool = True) -> None:
        """One slice; what is not counted only fills caches and starts workers."""
        start, used = time.monotonic(), processor_seconds()
        results = run_campaign(rubric, submissions, self.folder, secret="benchmark", **self.options)
        if counted:
            self.seconds.append(time.monotonic() - start)
            self.processor_seconds += processor_seconds() - used
            self.results += results


def adopt() -> None:
    """Become the parent of what a sandbox leaves: its first process outlives bubblewrap shortly.

    prctl(2), PR_SET_CHILD_SUBREAPER. Otherwise the time of what ran inside is nobody's.
    """
    if ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "PR_SET_CHILD_SUBREAPER")


def processor_seconds() -> float:
    """Of this process and of its children that have ended, adopted ones too."""
    time.sleep(LEFT_S)
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    return processor_s()


def _ways(folder: Path, stack: ExitStack) -> list[Way]:
    ways = [
        Way("1 worker", folder / "one", {"workers": 1}),
        Way(f"{WORKERS} workers", folder / "two", {"workers": WORKERS}),
    ]
    if importlib.util.find_spec("distributed") is not None:
        import distributed

        cluster = stack.enter_context(
            distributed.LocalCluster(
                n_workers=WORKERS, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
            )
        )
        options = {"workers": 1, "dask": cluster.scheduler_address}
        ways.append(Way(f"Dask cluster of {WORKERS} workers", folder / "dask", options))
    return ways


def measure(count: int = COUNT) -> list[Way]:
    """Grade `count` different submissions in each way; the first way is the one to compare with."""
    rubric = read_rubric(RUBRIC)
    adopt()
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder = Path(name)
        for number in range(count):
            path = folder / "all" / f"student-{number:03}"
            if number % HOSTILE_EVERY == HOSTILE_EVERY - 1:
                path.parent.mkdir(exist_ok=True)
                HOSTILE[number // HOSTILE_EVERY % len(HOSTILE)].make(path, PLACE)
            else:
                write_submission(path, variant(number))
        write_submission(folder / "first")
        submissions = find_submissions([folder / "all"])
        ways = _ways(folder, stack)
        for way in ways:
            way.grade(rubric, [Submission("first", folder / "first")], counted=False)
        for turn, begin in enumerate(range(0, count, SLICE)):
            for place in range(len(ways)):
                way = ways[(turn + place) % len(ways)]
                way.grade(rubric, submissions[begin : begin + SLICE])
            done = min(begin + SLICE, count)
            shown = ", ".join(f"{way.name} {way.seconds[-1]:.0f} s" for way in ways)
            print(f"{done} of {count}: {shown}", file=sys.stderr, flush=True)
    return ways


def same_results(way: Way, single: Way) -> int:
    """How many results are those of the other way, to the last field."""
    return len(single.results) - len(differences(way, single))


def differences(way: Way, single: Way) -> list[str]:
    """A sentence for each result that is another one, with the first field that differs."""
    found = []
    for own, other in zip(way.results, single.results, strict=True):
        if own != other:
            field = next(name for name in other if own.get(name) != other[name])
            found.append(
                f"{way.name}: {other['submission']}: {field} is {own.get(field)!r}, "
                f"with {single.name} {other[field]!r}"
            )
    return found


def _spread(values: list[float]) -> str:
    if len(values) < 2:
        return f"{values[0]:.3g}"
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive")
    return f"{middle:.3g} ({low:.3g} to {high:.3g})"


def page(ways: list[Way], count: int) -> str:
    """The reference page."""
    single = ways[0]
    lines = [
        "# Throughput of grading",
        "",
        f"Generated by `python -m verification.course.grade_campaign`; do not edit. {count}",
        f"different submissions to lab sheet 1, every {HOSTILE_EVERY}th of them",
        f"[hostile](hostile-submissions.md), are graded by its rubric, in slices of {SLICE} that",
        "alternate between the configurations: each submission is built, run with two seeds and",
        "checked. The table has medians of the slices with quartiles in brackets. *Speed* is",
        "relative to the adjacent slice of one worker, on a machine with two processors.",
        "Processor time is the sum for grader, compiler and runs over all slices.",
        "",
        "| Workers | Submissions per minute | Speed | Processor time of each, s | Same results |",
        "|---|---:|---:|---:|---:|",
    ]
    for way in ways:
        sizes = [min(SLICE, count - begin) for begin in range(0, count, SLICE)]
        rates = [60 * n / s for n, s in zip(sizes, way.seconds, strict=True)]
        ratios = [a / b for a, b in zip(single.seconds, way.seconds, strict=True)]
        used = "" if "dask" in way.options else f"{way.processor_seconds / count:.2f}"
        same = f"{same_results(way, single)} of {count}"
        lines.append(f"| {way.name} | {_spread(rates)} | {_spread(ratios)} | {used} | {same} |")
    return "\n".join([*lines, ""])


def main(count: int = COUNT) -> dict[str, Any]:
    """Measure; write the page when all submissions and ways are there."""
    ways = measure(count)
    if count == COUNT and len(ways) == 3:
        PAGE.write_text(page(ways, count), encoding="utf-8")
    return {
        "count": count,
        "points": sorted({result["points"] for result in ways[0].results}),
        "seconds": {way.name: [round(s, 2) for s in way.seconds] for way in ways},
        "processor_seconds": {way.name: round(way.processor_seconds, 1) for way in ways},
        "same": {way.name: same_results(way, ways[0]) for way in ways[1:]},
        "differences": [text for way in ways[1:] for text in differences(way, ways[0])],
        "page": page(ways, count),
    }


def suite() -> Counts:
    """Results of two workers and of Dask that are those of one worker."""
    answer = main()
    count, same = answer["count"], answer["same"]
    excluded = [] if len(same) == 2 else [{"count": count, "reason": NO_DASK}]
    return Counts(2 * count, sum(same.values()), excluded, answer["differences"])


def figures() -> Iterator[Figure]:
    """Submissions built, run and judged per minute, in each way beside one worker."""
    ways = measure(MEASURED)
    single = 60 * MEASURED / sum(ways[0].seconds)
    for way in ways:
        rate = 60 * MEASURED / sum(way.seconds)
        yield Figure(f"grading, {way.name}", rate, "per min", ways[0].name, single)


if __name__ == "__main__":
    print(json.dumps(main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)))
