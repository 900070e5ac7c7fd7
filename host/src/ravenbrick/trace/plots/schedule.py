# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedule: a lane per task and one for interrupts, releases and deadlines marked."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ravenbrick.target.robot import Robot
from ravenbrick.trace.plots.style import COLOURS, new_figure, task_colour
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import (
    INTERRUPT_OWNER,
    KERNEL_OWNER,
    all_jobs,
    jobs_of,
    stretches,
)

__all__ = ["cyclic_begin_cycles", "first_release_cycles", "schedule_figure"]

SHOWN_US = 50_000


def first_release_cycles(recording: Recording) -> int:
    """The first release of any task: before it, the brick starts up."""
    firsts = [jobs[0].release_cycles for jobs in all_jobs(recording) if jobs]
    return min(firsts, default=0)


def cyclic_begin_cycles(robot: Robot, recording: Recording) -> int:
    """When the last cyclic task begins its cycle: its first job only waits for that instant."""
    begins = [
        jobs[1].release_cycles
        for thread, jobs in zip(recording.threads, all_jobs(recording), strict=True)
        if len(jobs) > 1 and (task := robot.task(thread.name)) and task.release == "cyclic"
    ]
    return max(begins, default=0)


def _lanes(recording: Recording) -> dict[int, int]:
    """Thread index -> lane, the highest priority on top; interrupts above, kernel below."""
    order = sorted(
        range(len(recording.threads)), key=lambda i: (recording.threads[i].base_priority, -i)
    )
    lanes = {KERNEL_OWNER: 0}
    lanes |= {index: lane for lane, index in enumerate(order, 1)}
    lanes[INTERRUPT_OWNER] = len(lanes)
    return lanes


def _colour(owner: int) -> str:
    if owner == INTERRUPT_OWNER:
        return COLOURS["interrupts"]
    return COLOURS["kernel"] if owner == KERNEL_OWNER else task_colour(owner)


def _plot_execution(axis: Axes, recording: Recording, lanes: dict[int, int], begin: int) -> None:
    clock = recording.clock
    end = begin + clock.cycles_of_us(SHOWN_US)
    bars: dict[int, list[tuple[float, float]]] = {owner: [] for owner in lanes}
    for first, last, owner in stretches(recording).within(begin, end):
        if owner in lanes:
            bars[owner].append(
                (1000 * clock.seconds(first - begin), 1000 * clock.seconds(last - first))
            )
    for owner, pieces in bars.items():
        axis.broken_barh(
            pieces,
            (lanes[owner] - 0.32, 0.64),
            facecolor=_colour(owner),
            linewidth=0.3,
            edgecolor=_colour(owner),
        )


def _plot_releases(
    axis: Axes, robot: Robot, recording: Recording, lane: int, thread: int, begin: int
) -> None:
    clock = recording.clock
    end = begin + clock.cycles_of_us(SHOWN_US)
    task = robot.task(recording.threads[thread].name)
    for job in jobs_of(recording, thread):
        if not begin <= job.release_cycles < end:
            continue
        at = 1000 * clock.seconds(job.release_cycles - begin)
        axis.annotate(
            "",
            (at, lane + 0.46),
            xytext=(at, lane - 0.36),
            arrowprops={
                "arrowstyle": "-|>",
                "color": "#222222",
                "linewidth": 0.7,
                "mutation_scale": 6,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )
        if task is not None and task.deadline_us is not None:
            due = at + task.deadline_us / 1000
            if due <= SHOWN_US / 1000:
                axis.plot([due, due], [lane - 0.42, lane - 0.3], color="#b3372f", linewidth=1.2)


def schedule_figure(robot: Robot, recording: Recording, begin: int) -> Figure:
    """50 ms from the cycle `begin` on; arrows are releases, red ticks deadlines."""
    lanes = _lanes(recording)
    figure, (axis,) = new_figure(10.0, 0.9 + 0.55 * len(lanes))
    _plot_execution(axis, recording, lanes, begin)
    for thread in range(len(recording.threads)):
        _plot_releases(axis, robot, recording, lanes[thread], thread, begin)
    names = {INTERRUPT_OWNER: "interrupts", KERNEL_OWNER: "start-up, idle loop"}
    labels = {lane: names.get(owner) or _label(recording, owner) for owner, lane in lanes.items()}
    axis.set_yticks(sorted(labels), [labels[lane] for lane in sorted(labels)])
    axis.set_xlim(0, SHOWN_US / 1000)
    axis.set_ylim(-0.6, len(lanes) - 0.4)
    axis.grid(axis="y", visible=False)
    start = recording.clock.seconds(begin)
    axis.set_xlabel(f"time after {start:.6f} s (ms); arrow: release, red tick: deadline")
    return figure


def _label(recording: Recording, thread: int) -> str:
    found = recording.threads[thread]
    return f"{found.name}\npriority {found.base_priority}"
