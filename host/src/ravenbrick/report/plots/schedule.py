# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedule: a lane per task and one for interrupts, releases and deadlines marked."""

from __future__ import annotations

from dataclasses import dataclass

from ravenbrick.project.robot import Robot
from ravenbrick.report.chart import COLOURS, Drawing, Panel, task_colour
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import (
    INTERRUPT_OWNER,
    KERNEL_OWNER,
    Job,
    all_jobs,
    by_priority,
    cyclic_begin_cycles,
    jobs_of,
    stretches,
)

__all__ = [
    "Window",
    "close_up",
    "overview",
    "schedule_drawing",
    "slowest_job",
]

WIDTH, LEFT, LANE, TOP = 930, 150, 34, 14
LEAST_WIDTH = 1.2
# Periods that one sees as tasks at work; a task of a longer period is shown with its first job.
LONGEST_PERIOD_US, SHORTEST_US, PERIODS = 50_000, 10_000, 2.5
TOGETHER_US = 10


@dataclass(frozen=True)
class Window:
    """A part of a run, in cycles."""

    begin: int
    end: int


def overview(robot: Robot, recording: Recording) -> Window:
    """Some periods of the tasks, from the instant at which all of them are at work.

    The whole run when it ended before that.
    """
    periods = [task.period_us for task in robot.tasks if task.release == "cyclic"]
    shown = max((p for p in periods if p is not None and p <= LONGEST_PERIOD_US), default=0)
    length = recording.clock.cycles_of_us(max(round(PERIODS * shown), SHORTEST_US))
    begin = cyclic_begin_cycles(robot, recording)
    if not begin:
        begin = min((jobs[0].release_cycles for jobs in all_jobs(recording) if jobs), default=0)
    end = min(begin + length, recording.stop.at_cycles)
    return Window(max(end - length, 0), end)


def close_up(recording: Recording, window: Window) -> Window:
    """From the beginning of a window until all jobs released at about that instant are done."""
    at = window.begin + recording.clock.cycles_of_us(TOGETHER_US)
    ends = [
        job.completion_cycles
        for jobs in all_jobs(recording)
        for job in jobs
        if window.begin <= job.release_cycles <= at and job.completion_cycles is not None
    ]
    last = max((end for end in ends if end <= window.end), default=window.end)
    around = max(last - window.begin, 1) // 12
    return Window(max(window.begin - around, 0), min(last + around, recording.stop.at_cycles))


def slowest_job(robot: Robot, recording: Recording) -> tuple[int, int, Job] | None:
    """Thread, number and job of the longest response, measured by its deadline.

    Of tasks of the task set without deadline when there is no other; None without a job.
    """
    found: tuple[tuple[bool, float], tuple[int, int, Job]] | None = None
    for index, thread in enumerate(recording.threads):
        task = robot.task(thread.name)
        deadline = task.deadline_us if task is not None else None
        for number, job in enumerate(jobs_of(recording, index), 1):
            response = job.response_time_cycles
            if response is None or task is None:
                continue
            rank = deadline is not None, response / (deadline or 1)
            if found is None or rank > found[0]:
                found = rank, (index, number, job)
    return None if found is None else found[1]


def _bars(recording: Recording, window: Window) -> dict[int, list[tuple[int, int]]]:
    """Owner -> what it ran in the window: begin and end in cycles."""
    bars: dict[int, list[tuple[int, int]]] = {}
    for first, last, owner in stretches(recording).within(window.begin, window.end):
        bars.setdefault(owner, []).append((first, last))
    return bars


def _lanes(recording: Recording, window: Window, ran: set[int]) -> list[int]:
    """Owners from the top: interrupts, tasks by falling priority, the kernel; none that is idle."""
    active = [
        index
        for index in by_priority(recording)
        if index in ran
        or any(window.begin <= j.release_cycles < window.end for j in jobs_of(recording, index))
    ]
    ends = [o for o in (INTERRUPT_OWNER, KERNEL_OWNER) if o in ran]
    return [
        *(o for o in ends if o == INTERRUPT_OWNER),
        *active,
        *ends[ends.count(INTERRUPT_OWNER) :],
    ]


def _label(recording: Recording, owner: int) -> tuple[str, str, str]:
    """Name, what stands below it, and colour of a lane."""
    if owner == INTERRUPT_OWNER:
        return "interrupts", "", COLOURS["interrupts"]
    if owner == KERNEL_OWNER:
        return "start-up, idle loop", "", COLOURS["kernel"]
    thread = recording.threads[owner]
    return (
        thread.name,
        f"priority {thread.base_priority}",
        task_colour(by_priority(recording).index(owner)),
    )


def _releases(
    panel: Panel, robot: Robot, recording: Recording, thread: int, window: Window, middle: float
) -> None:
    """An arrow for each release and a red tick for each deadline in the window."""
    clock = recording.clock
    task = robot.task(recording.threads[thread].name)
    deadline = None if task is None or task.deadline_us is None else task.deadline_us
    for job in jobs_of(recording, thread):
        if window.begin <= job.release_cycles <= window.end:
            x = float(panel.at_x(clock.seconds(job.release_cycles - window.begin)))
            head = f"M{x:.1f} {middle + 12:.1f}v-27m-3 5l3 -5l3 5"
            panel.drawing.path(head, COLOURS["text"], 1)
        due = None if deadline is None else job.release_cycles + clock.cycles_of_us(deadline)
        if due is not None and window.begin < due <= window.end:
            x = float(panel.at_x(clock.seconds(due - window.begin)))
            panel.drawing.path(f"M{x:.1f} {middle + 14:.1f}v-9", COLOURS["deadline"], 2.4)


def schedule_drawing(robot: Robot, recording: Recording, window: Window) -> Drawing:
    """Who had the processor; arrows are releases, red ticks deadlines."""
    clock = recording.clock
    bars = _bars(recording, window)
    lanes = _lanes(recording, window, set(bars))
    height = LANE * max(len(lanes), 1)
    seconds = clock.seconds(max(window.end - window.begin, 1))
    unit, scale = ("µs", 1e6) if seconds < 2e-3 else ("ms", 1e3)
    begin_text = f"{clock.seconds(window.begin):.6f} s"
    drawing = Drawing(WIDTH, TOP + height + 40, f"Schedule from {begin_text} on")
    place = (LEFT, TOP, WIDTH - LEFT - 12, height)
    Panel(drawing, *place, (0.0, scale * seconds), (0, 1)).x_axis(
        f"time after {begin_text} ({unit}); arrow: release, red tick: deadline"
    )
    panel = Panel(drawing, *place, (0.0, seconds), (0, 1))
    for number, owner in enumerate(lanes):
        middle = TOP + LANE * (number + 0.5)
        name, below, colour = _label(recording, owner)
        drawing.path(f"M{LEFT} {middle + 12:g}h{panel.width:g}", COLOURS["grid"], 1)
        drawing.text(LEFT - 10, middle + (1 if below else 5), name, anchor="end")
        drawing.text(LEFT - 10, middle + 14, below, anchor="end", colour=COLOURS["faint"], size=10)
        boxes = []
        for first, last in bars.get(owner, ()):
            left, right = (
                float(panel.at_x(clock.seconds(at - window.begin))) for at in (first, last)
            )
            boxes.append((left, middle - 9, max(right - left, LEAST_WIDTH), 21.0))
        drawing.rectangles(boxes, colour)
        if owner >= 0:
            _releases(panel, robot, recording, owner, window, middle)
    return drawing
