# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Response times of all jobs of a run, a lane per task, beside deadlines and bounds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.report.chart import COLOURS, Drawing, Panel, task_colour
from ravenbrick.trace.measures import RunMeasures
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import TaskMeasures, by_priority, jobs_of

__all__ = ["responses_drawing"]

WIDTH, LEFT, LANE, TOP, RIGHT = 930, 150, 46, 26, 160
BARS = 150


def _range(
    recording: Recording, tasks: list[TaskMeasures], bounds: Mapping[str, int]
) -> tuple[float, float]:
    """From below the shortest response to above the latest deadline or bound; µs."""
    cycles: list[int] = []
    for task in tasks:
        named = (task.response_time_cycles_min, task.response_time_cycles_max)
        cycles += [c for c in (*named, task.deadline_cycles, bounds.get(task.name)) if c]
    low, high = (1e6 * recording.clock.seconds(c) for c in (min(cycles), max(cycles)))
    return 0.7 * low, 1.6 * high


def _density(
    panel: Panel,
    microseconds: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    base: float,
    colour: str,
) -> None:
    """Bars whose heights grow with the logarithm of the number of jobs."""
    places = panel.at_x(microseconds)
    width = panel.width / BARS
    columns, counts = np.unique(((places - panel.left) / width).astype(int), return_counts=True)
    most = math.log(1 + int(counts.max()))
    panel.drawing.rectangles(
        [
            (panel.left + column * width, base - height, width, height)
            for column, count in zip(columns.tolist(), counts.tolist(), strict=True)
            for height in (4 + 22 * math.log(1 + count) / most,)
        ],
        colour,
    )


def _mark(panel: Panel, value: float, base: float, colour: str) -> None:
    x = float(panel.at_x(value))
    panel.drawing.path(f"M{x:.1f} {base + 4:.1f}v-34", colour, 2.4)


def _shown(microseconds: float) -> str:
    small = microseconds < 999.5
    return f"{microseconds:.3g} µs" if small else f"{microseconds / 1000:.3g} ms"


def _share(task: TaskMeasures, seconds: Callable[[int], float]) -> str:
    if task.deadline_cycles is None or task.response_time_cycles_max is None:
        return "no deadline"
    share = 100 * task.response_time_cycles_max / task.deadline_cycles
    return f"{share:.2g} % of {1000 * seconds(task.deadline_cycles):.4g} ms"


def responses_drawing(
    recording: Recording, measures: RunMeasures, bounds: Mapping[str, int]
) -> Drawing | None:
    """Bars: jobs, more of them the higher (logarithmic); None when no job was completed.

    `bounds`: response time of tasks in cycles, as `ravenbrick analyse` left them.
    """
    clock = recording.clock
    shown = [
        (task, thread, task_colour(rank))
        for rank, (task, thread) in enumerate(
            zip(measures.tasks, by_priority(recording), strict=True)
        )
        if task.completions
    ]
    tasks = [task for task, _thread, _colour in shown]
    if not tasks:
        return None
    height = LANE * len(tasks)
    drawing = Drawing(WIDTH, TOP + height + 40, "Response times of all jobs, by task")
    x = _range(recording, tasks, bounds)
    panel = Panel(drawing, LEFT, TOP, WIDTH - LEFT - RIGHT, height, x, (0, 1), log=True)
    decades = range(math.ceil(math.log10(x[0])), math.floor(math.log10(x[1])) + 1)
    panel.x_axis("response time (µs), logarithmic", [10.0**n for n in decades])
    legend = (
        [("deadline", COLOURS["deadline"], "")] if any(t.deadline_cycles for t in tasks) else []
    )
    legend += [("bound of analyse", COLOURS["bound"], "")] if bounds else []
    panel.legend(legend)
    for number, (task, thread, colour) in enumerate(shown):
        base = TOP + LANE * (number + 1) - 8
        jobs = jobs_of(recording, thread)
        cycles = [r for job in jobs if (r := job.response_time_cycles) is not None]
        microseconds = 1e6 * np.array(cycles) / float(clock.hertz)
        drawing.path(f"M{LEFT} {base}h{panel.width:g}", COLOURS["grid"], 1)
        drawing.text(LEFT - 10, base - 8, task.name, anchor="end")
        jobs_text = f"{len(cycles)} job{'s' if len(cycles) > 1 else ''}"
        drawing.text(LEFT - 10, base + 5, jobs_text, anchor="end", colour=COLOURS["faint"], size=10)
        _density(panel, microseconds, base, colour)
        for due, name in ((bounds.get(task.name), "bound"), (task.deadline_cycles, "deadline")):
            if due:
                _mark(panel, 1e6 * clock.seconds(due), base, COLOURS[name])
        longest = float(microseconds.max())
        drawing.text(WIDTH - RIGHT + 12, base - 8, f"at most {_shown(longest)}")
        drawing.text(
            WIDTH - RIGHT + 12,
            base + 5,
            _share(task, clock.seconds),
            size=10,
            colour=COLOURS["faint"],
        )
    return drawing
