# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Random task sets: our bounds beside those of outside tools.

`python -m verification.timing.random_sets --sets 10000 [--simso 1000] [--seed 1]`

The crate `response-time-analysis` (0.3.2, built on demand) must give equal bounds. SimSo (0.8.5,
`pip install simso==0.8.5`) must never run longer than a bound and must reach it from the critical
instant. pyCPA (1.2) must give equal bounds too; it is compared when it is installed.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import math
import os
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

from ravenbrick.schedule.edf import earliest_deadline_bounds
from ravenbrick.schedule.model import Task, TaskSet
from ravenbrick.schedule.releases import critical_instant
from ravenbrick.schedule.response_time import response_time_bound
from ravenbrick.schedule.simulation import simulate

from verification.support.paths import ROOT

CRATE = ROOT / "verification" / "timing" / "crate_bounds"
Bounds = list[int | None]
NO_COLLECTION = SimpleNamespace(collect=lambda: 0)
"""pyCPA collects garbage after each task, which takes most of its time."""


def utilizations(dice: random.Random, count: int, total: float) -> list[float]:
    """UUniFast (Bini, Buttazzo 2005)."""
    found = []
    for left in range(count - 1, 0, -1):
        rest = total * dice.random() ** (1 / left)
        found.append(total - rest)
        total = rest
    return [*found, total]


def random_set(dice: random.Random) -> TaskSet:
    """2 to 12 tasks, log-uniform periods, utilisation below 1; half with J, half with B."""
    while True:
        count = dice.randint(2, 12)
        shares = utilizations(dice, count, dice.uniform(0.3, 0.98))
        jittered, blocked = dice.random() < 0.5, dice.random() < 0.5
        periods = [round(math.exp(dice.uniform(math.log(20), math.log(5000)))) for _ in shares]
        if dice.random() < 0.5:
            periods.sort()
        tasks = []
        for index, (share, period) in enumerate(zip(shares, periods, strict=True)):
            wcet = max(1, round(share * period))
            tasks.append(
                Task(
                    f"t{index + 1}",
                    period,
                    wcet,
                    count - index,
                    deadline=max(wcet, round(period * dice.uniform(0.5, 1.5))),
                    release_jitter=dice.randint(0, period * 3 // 2) if jittered else 0,
                    blocking=dice.randint(0, period // 4) if blocked else 0,
                )
            )
        task_set = TaskSet(tuple(tasks))
        if task_set.utilization <= Fraction(995, 1000):
            return task_set


def plain(task_set: TaskSet, **fields: int) -> TaskSet:
    """The set with the same value of a field in each task."""
    return TaskSet(tuple(replace(task, **fields) for task in task_set))  # type: ignore[arg-type]


def ours(task_set: TaskSet) -> tuple[Bounds, Bounds, Bounds]:
    """Bounds from the release without and with blocking, and under earliest deadline first."""
    unblocked = plain(task_set, blocking=0)
    independent = plain(unblocked, release_jitter=0)
    return (
        [whole(response_time_bound(unblocked, task).from_release) for task in unblocked],
        [whole(response_time_bound(task_set, task).from_release) for task in task_set],
        [whole(found.bound) for found in earliest_deadline_bounds(independent)],
    )


def whole(value: int | Fraction | None) -> int | None:
    """Bounds of sets of whole numbers are whole."""
    return None if value is None else int(value)


def crate_bounds(sets: list[TaskSet]) -> Iterator[list[Bounds]]:
    """Three lists of bounds for each set, from the crate."""
    command = ["cargo", "run", "--quiet", "--release", "--locked"]
    lines = [
        ";".join(
            f"{task.wcet} {task.period} {task.deadline} {task.release_jitter} {task.blocking}"
            for task in task_set
        )
        for task_set in sets
    ]
    result = subprocess.run(
        command,
        cwd=CRATE,
        env={"CARGO_TARGET_DIR": str(ROOT / "build" / "crate_bounds"), **os.environ},
        input="\n".join(lines),
        capture_output=True,
        text=True,
    )
    if result.returncode:
        raise SystemExit(
            f"{' '.join(command)} in {CRATE}: exit code {result.returncode}: "
            f"{result.stderr[-2000:] or 'no message'}"
        )
    for line in result.stdout.splitlines():
        yield [
            [None if text == "-" else int(text) for text in part.split()]
            for part in line.split(";")
        ]


def pycpa_bounds(task_set: TaskSet) -> Bounds:
    """Bounds from the release without blocking, from pyCPA."""
    from pycpa import analysis, model, options, schedulers

    analysis.gc = NO_COLLECTION
    for option in ("max_iterations", "max_wcrt"):
        options.set_opt(option, 10**9)
    system = model.System()
    resource = system.bind_resource(model.Resource("cpu", schedulers.SPPScheduler()))
    tasks = []
    for index, task in enumerate(task_set):
        bound = resource.bind_task(
            model.Task(task.name, wcet=task.wcet, bcet=task.wcet, scheduling_parameter=index + 1)
        )
        bound.in_event_model = model.PJdEventModel(P=task.period, J=task.release_jitter)
        tasks.append(bound)
    results = analysis.analyze_system(system)
    return [int(results[task].wcrt) for task in tasks]


def simso_worst(task_set: TaskSet, end: int) -> list[int]:
    """Longest response times from the arrival in a SimSo run from the critical instant."""
    from simso.configuration import Configuration
    from simso.core import Model

    configuration = Configuration()
    configuration.cycles_per_ms = 1
    configuration.duration = end
    configuration.scheduler_info.clas = "simso.schedulers.FP"
    configuration.add_processor(name="cpu", identifier=1)
    jitter = {}
    for index, task in enumerate(task_set):
        dates = []
        for _, release in critical_instant(task):
            if release > end:
                break
            dates.append(release)
        configuration.add_task(
            name=task.name,
            identifier=index + 1,
            task_type="Sporadic",
            list_activation_dates=dates,
            period=task.period,
            wcet=task.wcet,
            deadline=10 * end,
            abort_on_miss=False,
            data={"priority": task.priority},
        )
        jitter[task.name] = task
    configuration.check_all()
    run = Model(configuration)
    run.run_model()
    worst = []
    for found in run.results.tasks.values():
        task = jitter[found.task.name]
        arrivals = critical_instant(task)
        times = []
        for job, (arrival, _) in zip(found.jobs, arrivals, strict=False):
            if job.end_date is not None:
                times.append(round(job.end_date) - int(arrival))
        worst.append(max(times, default=0))
    return worst


def busy_end(task_set: TaskSet) -> int:
    """End of the busy period of the least urgent task."""
    found = response_time_bound(task_set, task_set.by_priority()[-1]).busy_period
    return int(found or 0)


def with_simso(task_set: TaskSet, counts: Counter[str]) -> None:
    """Compare a set without blocking with SimSo and with our simulator."""
    independent = plain(task_set, blocking=0)
    end = busy_end(independent) + 1
    bounds = [response_time_bound(independent, task).bound for task in independent]
    run = simulate(independent, end, releases=critical_instant)
    own = [run.response_time_max(task.name) for task in independent]
    outside = simso_worst(independent, end)
    for bound, observed, simso in zip(bounds, own, outside, strict=True):
        counts["simulator tasks"] += 1
        counts["simulator equal"] += observed == bound
        counts["simso above bound"] += bound is not None and simso > bound
        counts["simso equal"] += simso == bound


def compare(counts: Counter[str], name: str, left: Bounds, right: Bounds) -> bool:
    """Count equal and different bounds; False when one differs."""
    equal = sum(a == b for a, b in zip(left, right, strict=True))
    counts[f"{name} equal"] += equal
    counts[f"{name} different"] += len(left) - equal
    return equal == len(left)


def installed(module: str) -> bool:
    """Whether a Python module can be imported."""
    return importlib.util.find_spec(module) is not None


def campaign(sets: list[TaskSet], simso_sets: int) -> dict[str, Any]:
    """Run all comparisons; differing sets are written out in full."""
    counts: Counter[str] = Counter()
    different: list[str] = []
    names = ("crate fixed priority", "crate with blocking", "crate earliest deadline")
    pycpa = installed("pycpa")
    for number, (task_set, theirs) in enumerate(zip(sets, crate_bounds(sets), strict=True)):
        found = ours(task_set)
        pairs = [*zip(names, found, theirs, strict=True)]
        if pycpa:
            pairs.append(("pyCPA", found[0], pycpa_bounds(task_set)))
        for name, left, right in pairs:
            if not compare(counts, name, left, right):
                different.append(f"{name}: {left} {right} {task_set}")
        if number < simso_sets:
            with_simso(task_set, counts)
        if number % 500 == 0:
            print(f"{number} of {len(sets)} sets", file=sys.stderr, flush=True)
    return {"sets": len(sets), "counts": dict(sorted(counts.items())), "different": different}


def main() -> int:
    """Print the counts as JSON; 1 when a bound differs or a run exceeds one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=10_000)
    parser.add_argument("--simso", type=int, default=0, help="sets also simulated with SimSo")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.simso and not installed("simso"):
        raise SystemExit("SimSo is missing; 'pip install simso==0.8.5' or leave out --simso")
    dice = random.Random(options.seed)
    result = campaign([random_set(dice) for _ in range(options.sets)], options.simso)
    print(json.dumps(result, indent=1))
    return 1 if result["different"] or result["counts"].get("simso above bound") else 0


if __name__ == "__main__":
    sys.exit(main())
