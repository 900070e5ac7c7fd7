# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Low, middle and high task on the template `blank`, for the sheets about locks."""

from __future__ import annotations

from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import jobs_of, segments

from tools.docs.figures import project

LANES = ("low_task", "middle_task", "high_task")
# Interrupts and the task of the co-processor link take less than this out of an execution.
GAP_MS = 0.6


def robot_text() -> str:
    """The template's robot with these tasks; a job of any may last longer than its period."""
    head, link = (project("blank") / "robot.toml").read_text("utf-8").split("[[tasks]]")[:2]
    tables = [head.replace("\n[ports.B]", "watchdog = false\n\n[ports.B]"), link]
    for priority, name in enumerate(LANES, 1):
        tables.append(
            f'\nname = "{name}"\nrelease = "background"\npriority = {priority}\n'
            f"stack_bytes = {4096 if priority == 1 else 2048}\n\n"
        )
    return "[[tasks]]".join(tables)


def executions(recording: Recording, name: str, job: int) -> list[tuple[float, float]]:
    """When a task executed, in ms after the release of a job of Low; short gaps are closed."""
    origin = jobs_of(recording, recording.thread_index("low_task"))[job].release_cycles
    found: list[tuple[float, float]] = []
    for segment in segments(recording):
        if segment.owner != recording.thread_index(name):
            continue
        begin, end = (
            1000 * float(recording.clock.seconds(cycles - origin))
            for cycles in (segment.begin_cycles, segment.end_cycles)
        )
        if found and begin - found[-1][1] < GAP_MS:
            begin = found.pop()[0]
        found.append((begin, end))
    return [(begin, end) for begin, end in found if begin > -1]
