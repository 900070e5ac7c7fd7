# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The schedule of a task set as a picture: fixed priorities above earliest deadline first."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from ravenbrick.report.plots.style import COLOURS, new_figure, task_colour
from ravenbrick.schedule.model import TaskSet
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.releases import critical_instant, periodic
from ravenbrick.schedule.simulation import Scheduler, Simulation, simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["gantt_figure"]

MOST_JOBS = 120
PANELS: tuple[tuple[Scheduler, str], ...] = (
    ("fixed_priority", "fixed priorities"),
    ("earliest_deadline", "earliest deadline first"),
)


def shown_until(task_set: TaskSet) -> Time:
    """All there is to see, phases included, or as much as a picture can hold."""
    phase = max((task.phase or 0 for task in task_set), default=0)
    whole = phase + task_set.hyperperiod
    rate = sum(Fraction(1) / Fraction(task.period) for task in task_set)
    return exact(min(Fraction(whole), phase + Fraction(MOST_JOBS) / rate))


def gantt_figure(task_set: TaskSet, unit: str, until: Time | None = None) -> Figure:
    """One lane for each task in both schedules, without overheads; arrivals point up, deadlines
    down, missed ones are crosses, execution in a protected object is hatched.

    Without release jitter, tasks are released at their phases; with it, as a critical instant: all
    first jobs are released together, each as late as its jitter allows.
    """
    jitter = any(task.release_jitter for task in task_set)
    pattern = critical_instant if jitter else periodic
    end = shown_until(task_set) if until is None else until
    lanes = {task.name: len(task_set) - 1 - place for place, task in enumerate(task_set)}
    figure, axes = new_figure(11.0, 1.6 + 1.1 * len(lanes), rows=len(PANELS))
    for axis, (scheduler, title) in zip(axes, PANELS, strict=True):
        run = simulate(task_set, end, scheduler=scheduler, releases=pattern)
        _draw(axis, run, lanes, float(end))
        missed = len(run.deadline_misses)
        found = f"{missed} missed deadlines" if missed else "no deadline is missed"
        axis.set_title(f"{title}{', late first releases' if jitter else ''}: {found}", fontsize=10)
        axis.set_yticks(list(lanes.values()), list(lanes))
        axis.set_ylim(-0.6, len(lanes) - 0.4)
        axis.set_xlim(-0.01 * float(end), 1.01 * float(end))
    axes[-1].set_xlabel(f"time ({unit})")
    return figure


def _draw(axis: Axes, run: Simulation, lanes: dict[str, int], end: float) -> None:
    for part in run.intervals:
        lane = lanes[part.task]
        axis.barh(
            lane,
            float(part.end - part.begin),
            left=float(part.begin),
            height=0.5,
            color=task_colour(lane),
            hatch="////" if part.held else None,
            edgecolor="#ffffff" if part.held else task_colour(lane),
            linewidth=0.4,
        )
    arrivals = [(float(job.arrival), lanes[job.task.name]) for job in run.jobs]
    late = set(run.deadline_misses)
    met: list[tuple[float, int]] = []
    missed: list[tuple[float, int]] = []
    for job in run.jobs:
        place = (float(job.absolute_deadline), lanes[job.task.name])
        if place[0] <= end:
            (missed if job in late else met).append(place)
    for places, offset, mark, colour in (
        (arrivals, 0.36, "^", "#000000"),
        (met, -0.36, "v", COLOURS["setpoint"]),
        (missed, -0.36, "x", COLOURS["deadline"]),
    ):
        across = [time for time, _ in places]
        up = [lane + offset for _, lane in places]
        axis.plot(across, up, mark, color=colour, markersize=4, linestyle="none")
