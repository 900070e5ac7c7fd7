# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about schedulers, servers and overload."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
from ravenbrick.project.robot import read_robot
from ravenbrick.schedule import TaskSet, rate_monotonic, simulate
from ravenbrick.schedule.model import Task
from ravenbrick.schedule.report.gantt import gantt_figure
from ravenbrick.schedule.simulation import Scheduler
from ravenbrick.schedule.task_models.servers import Kind, Server
from ravenbrick.schedule.task_models.system import System
from ravenbrick.trace.dynamics import task_dynamics

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, project, run
from tools.docs.lessons import SHEETS, files_of

SHEET = SHEETS / "20-overload.md"


def gantt() -> str:
    """The first task set under both schedulers, over one hyperperiod."""
    of = (("control", 4, Fraction(8, 5)), ("line", 6, 3), ("telemetry", 12, 1))
    tasks = TaskSet(tuple(Task(name, period, wcet, 1, period) for name, period, wcet in of))
    return picture(gantt_figure(rate_monotonic(tasks), "ms", 12))


def _command_bound(kind: Kind, capacity: Fraction) -> float | None:
    """Bound of the command's response time in ms; None when a deadline can be missed."""
    command = Task("command", 60, 4, 1, 60, release="sporadic")
    server = Server("requests", kind, 8, capacity, 1, (command,))
    others = [
        Task("control", 4, 1, 1, 4),
        Task("line", 10, 3, 1, 10),
        Task("display", 40, 6, 1, 40),
    ]
    task_set = rate_monotonic(TaskSet((*others, server.task)))
    server = Server("requests", kind, 8, capacity, task_set.task("requests").priority, (command,))
    solution = System(task_set, servers=(server,)).solution
    bound = solution.served[0].bound
    return float(bound) if solution.schedulable and bound is not None else None


def servers() -> str:
    """Response bound of a request over the budget of its server."""
    figure, (axes,) = new_figure(7.0, 3.4)
    kinds: tuple[Kind, ...] = ("polling", "deferrable", "sporadic")
    for kind, colour, dash in zip(kinds, SERIES, ("-", "--", ":"), strict=False):
        budgets = [Fraction(n, 16) for n in range(16, 65)]
        bounds = [_command_bound(kind, budget) for budget in budgets]
        shown = [(float(c), r) for c, r in zip(budgets, bounds, strict=True) if r is not None]
        axes.step(
            *zip(*shown, strict=True), dash, color=colour, label=kind, linewidth=2, where="post"
        )
    axes.set(xlabel="budget in each 8 ms (ms)", ylabel="bound of the command (ms)")
    legend(axes, "upper right")
    return picture(figure)


def domino() -> str:
    """Missed deadlines of each task over the control task's execution time."""
    figure, axes = new_figure(7.0, 4.6, rows=2)
    times = [n / 4 for n in range(24, 53)]
    schedulers: tuple[Scheduler, ...] = ("fixed_priority", "earliest_deadline")
    titles = ("fixed priorities", "earliest deadline first")
    for axis, scheduler, title in zip(axes, schedulers, titles, strict=True):
        shares = []
        for control in times:
            task_set = TaskSet.of((Fraction(control), 20), (9, 30), (15, 60))
            done = simulate(task_set, 6000, scheduler=scheduler)
            missed = [job.task.name for job in done.deadline_misses]
            shares.append(
                [100 * missed.count(t.name) / len(done.jobs_of(t.name)) for t in task_set]
            )
        for values, name, colour in zip(
            np.array(shares).T, ("control", "line", "guard"), SERIES, strict=False
        ):
            axis.plot(times, values, color=colour, label=name, linewidth=2)
        axis.axvline(9, color="black", linestyle=":", linewidth=1)
        axis.set(ylabel="missed (%)", title=title, ylim=(-5, 105))
        legend(axis, "center left")
    axes[-1].set_xlabel("execution time of control (ms)")
    return picture(figure)


def _edits(transformed: bool) -> Edits:
    """Of the template `blank`: the sheet's program, or the one after the experiment."""
    files = files_of(SHEET)
    bodies = files["lab20/src/tasks.adb"]
    tasks = files["lab20/src/tasks.ads"]
    if transformed:
        bodies = bodies.replace("Compute (15)", "Compute (5)").replace("onds (60)", "onds (20)")
        tasks = re.sub(r"(Guard_Task.*'First) \+ 1", r"\1 + 4", tasks)
    head, link = _robot().split("[[tasks]]")[:2]
    tables = [head.replace("\n[ports.B]", "watchdog = false\n\n[ports.B]"), link]
    guard = ("guard_task", 20 if transformed else 60, 4 if transformed else 1)
    for name, period, priority in (("control_task", 20, 3), ("line_task", 30, 2), guard):
        tables.append(
            f'\nname = "{name}"\nrelease = "cyclic"\nperiod_us = {period}_000\n'
            f"deadline_us = {period}_000\npriority = {priority}\nstack_bytes = 2048\n\n"
        )
    return {
        "src/tasks.ads": tasks,
        "src/tasks.adb": bodies,
        "robot.toml": "[[tasks]]".join(tables),
        "scenarios/overload.toml": files["lab20/scenarios/overload.toml"],
    }


def _robot() -> str:
    return (Path(project("blank")) / "robot.toml").read_text("utf-8")


def guard() -> str:
    """Response times of the guard on the virtual brick, before and after the experiment."""
    figure, (axes,) = new_figure(7.0, 3.2)
    for transformed, name, colour in (
        (False, "15 ms each 60 ms, lowest priority", SERIES[1]),
        (True, "5 ms each 20 ms, highest priority", SERIES[0]),
    ):
        edits = _edits(transformed)
        recording = run("blank", "overload", edits)
        robot = read_robot(project("blank", edits))
        found = next(t for t in task_dynamics(robot, recording) if t.name == "guard_task")
        seconds = [recording.clock.seconds(int(c)) for c in found.response_time_cycles]
        each = 0.020 if transformed else 0.060
        axes.semilogy(
            0.1 + each * np.arange(1, len(seconds)),
            1000 * np.array(seconds)[1:],
            ".-",
            color=colour,
            label=name,
        )
    axes.axvline(1.0, color="black", linestyle=":", linewidth=1)
    axes.set(xlabel="release of the job (s)", ylabel="response time (ms)")
    legend(axes, "upper left")
    return picture(figure)
