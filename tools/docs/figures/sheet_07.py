# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about response times."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from ravenbrick.project.robot import read_robot
from ravenbrick.schedule import TaskSet, rate_monotonic
from ravenbrick.schedule.model import Task
from ravenbrick.schedule.report.gantt import gantt_figure
from ravenbrick.trace.dynamics import TaskDynamics, task_dynamics

from tools.docs.figures import SERIES, legend, new_figure, picture, project, run

# The tasks of the sheet's example: name, period and execution time in ms.
EXAMPLE = (("fast", 4, 1), ("middle", 6, 2), ("slow", 12, 3))


def _example() -> TaskSet:
    return rate_monotonic(TaskSet(tuple(Task(name, t, c, 1, t) for name, t, c in EXAMPLE)))


def _demand(w: float) -> int:
    """The right side of the recurrence of `slow` at a time in ms."""
    return 3 + sum(int(-(-Fraction(w) // t)) * c for _, t, c in EXAMPLE[:2])


def recurrence() -> str:
    """Both sides of the recurrence over the length of the window, and the iteration."""
    figure, (axes,) = new_figure(7.0, 4.2)
    times = np.linspace(0.001, 13, 2601)
    axes.plot(times, [_demand(t) for t in times], color=SERIES[0], label="work released by then")
    axes.plot([0, 13], [0, 13], color="black", linewidth=1, label="time that has passed")
    steps = [3]
    while (after := _demand(steps[-1])) != steps[-1]:
        steps.append(after)
    for before, after in zip(steps, [*steps[1:], steps[-1]], strict=True):
        axes.plot([before, before, after], [before, after, after], ":", color=SERIES[1])
    axes.plot(steps, [_demand(w) for w in steps], "o", color=SERIES[1], label="iteration")
    axes.set(xlabel="window w (ms)", ylabel="work (ms)", xlim=(0, 13), ylim=(0, 14))
    legend(axes, "upper left")
    return picture(figure)


def gantt() -> str:
    """The example under both schedulers, over one hyperperiod."""
    return picture(gantt_figure(_example(), "ms", 12))


def _control() -> TaskDynamics:
    robot = read_robot(project("motor"))
    return next(t for t in task_dynamics(robot, run("motor", "load")) if t.name == "control_task")


def jobs() -> str:
    """Response times of the control task in the order of its jobs."""
    clock = run("motor", "load").clock
    found = 1e6 * np.array([clock.seconds(int(c)) for c in _control().response_time_cycles])
    figure, (axes,) = new_figure(7.0, 3.2)
    axes.plot(found[1:], ".", markersize=2, color=SERIES[0])
    axes.set(xlabel="job of control_task", ylabel="response time (us)", ylim=(0, 100))
    return picture(figure)


def pieces() -> str:
    """The mean pieces of the responses while the motor stands, and while it is controlled."""
    task, clock = _control(), run("motor", "load").clock
    whole = task.response_time_cycles[1:]
    driving = whole > 0.5 * (whole.min() + whole.max())
    parts = {
        "execution": task.execution_cycles[1:],
        "tasks above": task.interference_cycles[1:],
        "interrupts": task.interrupt_cycles[1:],
    }
    figure, (axes,) = new_figure(7.0, 2.4)
    for row, chosen in enumerate((~driving, driving)):
        left = 0.0
        for (name, cycles), colour in zip(parts.items(), SERIES, strict=False):
            mean = 1e6 * clock.seconds(round(float(cycles[chosen].mean())))
            axes.barh(row, mean, left=left, color=colour, label=name if row == 0 else None)
            left += mean
    axes.set_yticks(
        [0, 1], [f"{int((~driving).sum())} jobs, stopped", f"{int(driving.sum())} jobs, driving"]
    )
    axes.set(xlabel="mean of the pieces (us)", xlim=(0, 130))
    legend(axes, "center right")
    return picture(figure)
