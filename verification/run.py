# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the suites of `suites.toml`, or the benchmarks, and write their results.

`python -m verification.run` runs all suites and writes `verification/results.{json,md}`;
`--benchmarks` measures the parts of `benchmarks/suites.toml` into `benchmarks/results.{json,md}`.
A suite that cannot run here keeps its last result, and the reason is shown. Exit code 1: a case
failed or a suite gave no result; 2: no suite has the name.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tools.docs import tables
from tools.docs.tables import merge_rows
from verification.commands import NoResultError, counts_of, function_of
from verification.table import BENCHMARKS, SUITES, Suite, TableError, chosen, read_suites

Row = dict[str, Any]
KEYS = {SUITES: ("suite",), BENCHMARKS: ("figure", "peer")}


def run_suite(suite: Suite) -> tuple[list[Row], int, str]:
    """The row of a suite, the number of cases that failed, and the line to show."""
    counts = counts_of(suite.kind, suite.command, suite.arguments)
    judged = counts.case_count - sum(e["count"] for e in counts.excluded)
    row = {"area": suite.area, "suite": suite.name, **asdict(counts)}
    return [row], judged - counts.passed, f"{counts.passed} of {judged}"


def measure(part: Suite) -> tuple[list[Row], int, str]:
    """The rows of a part of the benchmarks, and the line to show; nothing fails here."""
    rows = [asdict(figure) for figure in function_of(str(part.command))(*part.arguments)]
    return rows, 0, "; ".join(f"{r['figure']}: {r['value']:.5g} {r['unit']}" for r in rows)


def run_table(
    table: Path, suites: list[Suite], run: Callable[[Suite], tuple[list[Row], int, str]]
) -> tuple[list[Row], int]:
    """Run the suites with progress on standard error; rows, which are written, and failures."""
    results = table.with_name("results.json")
    all_rows: list[Row] = []
    failures = 0
    for number, suite in enumerate(suites, 1):
        head = f"[{number}/{len(suites)}] {suite.area}: {suite.name}"
        if reason := suite.missing():
            print(f"{head}: not run: {reason}", file=sys.stderr, flush=True)
            continue
        print(f"{head}, about {suite.minutes:g} min …", file=sys.stderr, flush=True)
        start = time.monotonic()
        try:
            rows, failed, shown = run(suite)
        except NoResultError as error:
            rows, failed, shown = [], 1, f"no result: {error}"
        print(f"{head}: {shown} ({time.monotonic() - start:.0f} s)", file=sys.stderr, flush=True)
        failures += failed
        all_rows += rows
        merge_rows(results, rows, KEYS[table])
    tables.main([])
    return all_rows, failures


def list_text(suites: list[Suite]) -> str:
    """One line for each suite: area, truth, minutes, name, what it is compared with."""
    lines = []
    for suite in suites:
        lacks = f"; not here: {reason}" if (reason := suite.missing()) else ""
        lines.append(
            f"{suite.area:<12} {suite.truth:<8} {suite.minutes:>4g} min  {suite.name} "
            f"({suite.compared_with}{lacks})"
        )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Run, write results and tables; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m verification.run", description=__doc__)
    parser.add_argument(
        "--benchmarks", action="store_true", help="run benchmarks instead of suites"
    )
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="WORD", help="areas, or parts of suite names"
    )
    parser.add_argument("--list", action="store_true", help="list the suites without running them")
    parser.add_argument("--json", action="store_true", help="result as JSON on standard output")
    options = parser.parse_args(arguments)
    table, run = (BENCHMARKS, measure) if options.benchmarks else (SUITES, run_suite)
    try:
        suites = chosen(read_suites(table), options.only)
    except TableError as error:
        print(error, file=sys.stderr)
        return 2
    if options.list:
        print(json.dumps([asdict(s) for s in suites]) if options.json else list_text(suites))
        return 0
    rows, failures = run_table(table, suites, run)
    if options.json:
        print(json.dumps(rows, indent=1))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
