# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The timing campaigns as suites: each function gives counts."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

from verification.commands import Counts, NoResultError
from verification.support.paths import ROOT
from verification.timing.unreached_bounds import MISSED, REACHED

__all__ = [
    "bounds_reached",
    "examples",
    "input_search",
    "integer_program",
    "random_sets",
    "responses_below_bounds",
    "wcet_benchmarks",
]

HERE = Path(__file__).resolve().parent
SETS, SIMSO_SETS, PROGRAMS = 10_000, 1_000, 1_000
# Modules, their names, and the file of tools/requirements that installs them.
OUTSIDE_TOOLS = {"pycpa": ("pyCPA", "pycpa"), "simso": ("SimSo", "timing")}


def _answer(module: str, *options: str) -> Any:
    command = [sys.executable, "-m", f"verification.timing.{module}", *options]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    if not done.stdout.strip():
        raise NoResultError(f"{' '.join(command[1:])}: no result, exit code {done.returncode}")
    return json.loads(done.stdout)


def _keep(name: str, result: dict[str, Any]) -> None:
    """The counts of a campaign, for the page of `verification.timing.examples`."""
    (HERE / f"{name}.json").write_text(json.dumps(result, indent=1, sort_keys=True) + "\n")


def random_sets() -> Counts:
    """Bounds of random task sets equal to those of outside tools; no simulated run above one."""
    absent = [name for name in OUTSIDE_TOOLS if importlib.util.find_spec(name) is None]
    options = [] if "simso" in absent else ["--simso", str(SIMSO_SETS)]
    result = _answer("random_sets", "--sets", str(SETS), *options)
    _keep("random_sets", result)
    counts = result["counts"]
    names = ("crate fixed priority", "crate with blocking", "crate earliest deadline", "pyCPA")
    equal = sum(counts.get(f"{name} equal", 0) for name in names)
    different = sum(counts.get(f"{name} different", 0) for name in names)
    simulated = counts.get("simulator tasks", 0)
    above = counts.get("simso above bound", 0)
    excluded = [
        {
            "count": 0,
            "reason": f"{name} is not installed, and no case of it counted: "
            f"pip install -r tools/requirements/{requirements}.txt",
        }
        for name, requirements in (OUTSIDE_TOOLS[module] for module in absent)
    ]
    passed = equal + simulated - above
    return Counts(equal + different + simulated, passed, excluded, result["different"])


def _tacle(module: str, code: str, level: str, table: str, seconds: int) -> Any:
    options = ("--code", code, "--level", level, "--table", str(HERE / table))
    return _answer(module, os.environ["RAVENBRICK_TACLE"], *options, "--seconds", str(seconds))


def wcet_benchmarks(code: str, level: str) -> Counts:
    """TACLe programs with a bound for their own data that their run does not exceed."""
    result = _tacle("wcet_benchmarks", code, level, "tacle.md", 900)
    without = [
        {"count": 1, "reason": f"{outcome['name']}: no bound: {outcome['error'][:160]}"}
        for outcome in result["outcomes"]
        if not outcome["bound"]
    ]
    below = result["below_observed"]
    failures = [f"{name}: the run exceeds the bound" for name in below]
    return Counts(result["programs"], result["analysed"] - len(below), without, failures)


def input_search(code: str, level: str) -> Counts:
    """TACLe programs whose longest run that a search finds stays below their bound for any data."""
    result = _tacle("input_search", code, level, "tacle_searched.md", 300)
    count = sum(bool(outcome["none"]) for outcome in result["outcomes"])
    reason = "no inputs to search, or runs too long: verification/timing/tacle_searched.md"
    excluded = [{"count": count, "reason": reason}] if count else []
    exceeded = result["exceeded"]
    failures = [f"{name}: a run exceeds the bound" for name in exceeded]
    failures += [f"{o['name']}: {o['error']}" for o in result["outcomes"] if o["error"]]
    return Counts(result["programs"], result["bounded"] - len(exceeded), excluded, failures)


def integer_program() -> Counts:
    """Longest paths of the examples' code as an integer program and as the analysis finds them."""
    result = _answer("integer_program")
    different = result["different"]
    return Counts(result["graphs"], result["graphs"] - len(different), failures=different)


def examples() -> Counts:
    """Execution times, responses and stacks of all examples within their bounds; the page, which
    also has worst-case searches and long runs, is left to its own command."""
    from verification.timing.examples import EXAMPLES, analysed, judge

    count, good, failures = 0, 0, []
    for name in EXAMPLES:
        try:
            compared, within = judge(analysed([name]))
        except NoResultError as error:
            compared, within = 1, 0
            failures.append(f"{name}: {error}")
        if within < compared:
            failures.append(f"{name}: {compared - within} of {compared} not within bounds")
        count, good = count + compared, good + within
    return Counts(count, good, failures=failures)


@cache
def _programs() -> dict[str, Any]:
    result: dict[str, Any] = _answer("program_campaign", "--programs", str(PROGRAMS))
    _keep("program_campaign", result)
    return result


def responses_below_bounds() -> Counts:
    """Tasks of generated Ada programs whose response times stay below their bounds."""
    result = _programs()
    failures = [*result["above_bound"], *result["stopped"]]
    return Counts(result["tasks"] + len(result["stopped"]), result["tasks"]
                  - len(result["above_bound"]), failures=failures)  # fmt: skip


def bounds_reached() -> Counts:
    """Programs whose least urgent task comes within 5 % of its bound."""
    result = _programs()
    far = Counter(found["reason"] for found in result["lowest_task_beyond"])
    close = result["lowest_task_within_5_percent"] + far.pop(REACHED, 0)
    longest = max((found["longer"] for found in result["lowest_task_beyond"]), default=0.0)
    shown = (
        f"; with a job longer by at most {longest:.1%} of the response the run meets it and comes "
        "within 5 %, in each"
    )
    excluded = [
        {"count": count, "reason": reason + (shown if reason == MISSED else "")}
        for reason, count in sorted(far.items())
    ]
    return Counts(result["lowest_task_compared"], close, excluded)
