# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Rows of the timing campaigns for `verification.run`."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from tools.docs.tables import Row
from verification.timing.just_missed import MISSED, REACHED

__all__ = [
    "examples",
    "input_search",
    "integer_program",
    "kernel_services",
    "lowest_tasks",
    "program_campaign",
    "random_sets",
    "timing_events",
    "wcet_benchmarks",
]

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "verification" / "timing"
TACLE = "RAVENBRICK_TACLE"
SETS, SIMSO_SETS, PROGRAMS = 10_000, 1_000, 1_000
TACLE_PROGRAMS = 57
TACLE_TABLE = ROOT / "verification" / "timing" / "tacle.md"
SEARCH_TABLE = ROOT / "verification" / "timing" / "tacle_searched.md"


def _answer(module: str, *options: str) -> Any:
    command = [sys.executable, "-m", f"verification.timing.{module}", *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise SystemExit(f"{module}: no result\n{done.stderr[-2000:]}")
    return json.loads(done.stdout)


def _keep(name: str, result: dict[str, Any]) -> None:
    """The counts of a campaign, for the page of `verification.timing.examples`."""
    (KEPT / f"{name}.json").write_text(json.dumps(result, indent=1, sort_keys=True) + "\n")


def _row(suite: str, cases: int, passed: int, excluded: list[Row] | None = None) -> Row:
    return {
        "area": "timing",
        "suite": suite,
        "case_count": cases,
        "passed": passed,
        "excluded": excluded or [],
    }


def random_sets() -> Row:
    """Bounds of random task sets equal to those of outside tools; no simulated run above one."""
    with_simso = importlib.util.find_spec("simso") is not None
    options = ["--simso", str(SIMSO_SETS)] if with_simso else []
    result = _answer("random_sets", "--sets", str(SETS), *options)
    _keep("random_sets", result)
    counts = result["counts"]
    names = ("crate fixed priority", "crate with blocking", "crate earliest deadline", "pycpa")
    equal = sum(counts.get(f"{name} equal", 0) for name in names)
    different = sum(counts.get(f"{name} different", 0) for name in names)
    simulated = counts.get("simulator tasks", 0)
    above = counts.get("simso above bound", 0)
    excluded: list[Row] = []
    if importlib.util.find_spec("pycpa") is None:
        reason = (
            "no case counted, but pyCPA is compared: pip install -r tools/requirements/timing.txt"
        )
        excluded.append({"count": 0, "reason": reason})
    if not with_simso:
        reason = (
            "no case counted, but SimSo is compared: pip install -r tools/requirements/timing.txt"
        )
        excluded.append({"count": 0, "reason": reason})
    suite = f"random: {SETS} task sets, bounds equal to other tools', runs below"
    return _row(suite, equal + different + simulated, equal + simulated - above, excluded)


def _campaign_row(
    suite: str,
    module: str,
    options: Sequence[str],
    judged: Callable[[dict[str, Any]], tuple[int, list[Row]]],
) -> Row:
    """A campaign over the TACLe programs; `judged` gives those that passed and those left out."""
    folder = os.environ.get(TACLE)
    if folder is None:
        reason = f"{TACLE} does not name the folder 'bench' of github.com/tacle/tacle-bench"
        return _row(suite, TACLE_PROGRAMS, 0, [{"count": TACLE_PROGRAMS, "reason": reason}])
    result = _answer(module, folder, *options)
    return _row(suite, result["programs"], *judged(result))


def wcet_benchmarks(code: str, level: str) -> Row:
    """TACLe programs with a bound for their own data that their run does not exceed."""

    def judged(result: dict[str, Any]) -> tuple[int, list[Row]]:
        without: list[Row] = [
            {"count": 1, "reason": f"{outcome['name']}: no bound: {outcome['error'][:160]}"}
            for outcome in result["outcomes"]
            if not outcome["bound"]
        ]
        return result["analysed"] - len(result["below_observed"]), without

    suite = f"wcet: TACLeBench, {code} -{level}, own data, bounded and not exceeded"
    options = ("--code", code, "--level", level, "--table", str(TACLE_TABLE), "--seconds", "900")
    return _campaign_row(suite, "wcet_benchmarks", options, judged)


def input_search(code: str, level: str) -> Row:
    """TACLe programs whose longest run that a search finds stays below their bound for any data."""

    def judged(result: dict[str, Any]) -> tuple[int, list[Row]]:
        without: list[Row] = [
            {"count": 1, "reason": f"{outcome['name']}: {outcome['none']}"}
            for outcome in result["outcomes"]
            if outcome["none"]
        ]
        return result["bounded"] - len(result["exceeded"]), without

    suite = f"wcet: TACLeBench, {code} -{level}, inputs searched, bound for any data not exceeded"
    options = ("--code", code, "--level", level, "--table", str(SEARCH_TABLE), "--seconds", "300")
    return _campaign_row(suite, "input_search", options, judged)


def kernel_services() -> Row:
    """Services of the run-time between their longest observed time and a tenth above it."""
    rows = _answer("kernel_services")
    passed = sum(row["close"] for row in rows)
    suite = "wcet: services of the run-time, bounds not exceeded and at most 10 % above"
    return _row(suite, len(rows), passed)


def integer_program() -> Row:
    """Longest paths of the examples' code as an integer program and by the crate's walk."""
    result = _answer("integer_program")
    suite = "wcet: integer program and walk over loops agree on the examples' functions"
    return _row(suite, result["graphs"], result["graphs"] - len(result["different"]))


def timing_events() -> Row:
    """Values of a program with timing events within their bounds."""
    pairs = [
        row[key] for row in _answer("timing_events") for key in ("execution", "response", "stack")
    ]
    good = sum(bound is not None and seen <= bound for bound, seen in pairs)
    suite = "timing events: jobs, responses and stacks of a program with them within bounds"
    return _row(suite, len(pairs), good)


def examples() -> Row:
    """Execution times, responses and stacks of all examples within their bounds; the page, which
    also holds hunts and hours, is left to its own command."""
    from verification.timing.examples import EXAMPLES, analysed, judge

    count, good = judge(analysed(list(EXAMPLES)))
    return _row("examples: jobs, responses and stacks of all examples within bounds", count, good)


@cache
def _campaign() -> dict[str, Any]:
    result: dict[str, Any] = _answer("program_campaign", "--programs", str(PROGRAMS))
    _keep("program_campaign", result)
    return result


def program_campaign() -> Row:
    """Generated Ada programs whose response times stay below their bounds."""
    result = _campaign()
    suite = (
        f"campaign: tasks of {result['programs']} generated Ada programs, responses below bounds"
    )
    return _row(suite, result["tasks"], result["tasks"] - len(result["above_bound"]))


def lowest_tasks() -> Row:
    """Programs whose least urgent task comes within 5 % of its bound."""
    result = _campaign()
    far = Counter(found["reason"] for found in result["lowest_task_beyond"])
    compared = result["lowest_task_compared"]
    close = result["lowest_task_within_5_percent"] + far.pop(REACHED, 0)
    longest = max((found["longer"] for found in result["lowest_task_beyond"]), default=0.0)
    shown = (
        f"; with a job longer by at most {longest:.1%} of the response the run meets it and comes "
        "within 5 %, in each"
    )
    excluded: list[Row] = [
        {"count": count, "reason": reason + (shown if reason == MISSED else "")}
        for reason, count in sorted(far.items())
    ]
    suite = "campaign: least urgent task of each program within 5 % of its bound"
    return _row(suite, compared, close, excluded)
