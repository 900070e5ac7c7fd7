# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of sheet 1: who runs after a common release, a long display task, releases that drift."""

from __future__ import annotations

import numpy as np
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import INTERRUPT_OWNER, Job, jobs_of, stretches

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run

_SWAPPED: Edits = {
    "src/tasks.ads": [
        ("'First + 2", "'First + 9"),
        ("'First + 1", "'First + 2"),
        ("'First + 9", "'First + 1"),
    ],
    "robot.toml": [
        ("\npriority = 2\n", "\npriority = 9\n"),
        ("\npriority = 1\n", "\npriority = 2\n"),
        ("\npriority = 9\n", "\npriority = 1\n"),
    ],
}
_LONG: Edits = {
    "src/tasks.adb": [
        (
            "   --  Shared by both",
            "   Counter : Natural := 0 with Volatile;\n\n   --  Shared by both",
        ),
        (
            "         Screen_Update;\n",
            "         Screen_Update;\n         for Round in 1 .. 30 * 6_500 loop\n"
            "            Counter := Round;\n         end loop;\n",
        ),
    ]
}
_RELATIVE: Edits = {
    "src/tasks.adb": [("Next_Release + Control_Period", "Clock + Control_Period")],
    "robot.toml": [("period_us = 20_000", "period_us = 20_012")],
}
_NAMES = ("coprocessor_task", "control_task", "display_task")


def _index(recording: Recording, name: str) -> int:
    return [thread.name for thread in recording.threads].index(name)


def _control_jobs(recording: Recording) -> list[Job]:
    """Periodic jobs of the control task; the first one belongs to its start."""
    return jobs_of(recording, _index(recording, "control_task"))[1:]


def order() -> str:
    """Who has the processor after a common release, with both orders of priorities."""
    figure, axes = new_figure(7, 4.4, rows=2)
    titles = ("control above display", "display above control")
    orders: tuple[Edits, ...] = ({}, _SWAPPED)
    for axis, edits, title in zip(axes, orders, titles, strict=True):
        recording = run("blank", "press", edits)
        release = jobs_of(recording, _index(recording, "display_task"))[2].release_cycles
        found = stretches(recording)
        owners = [_index(recording, name) for name in _NAMES] + [INTERRUPT_OWNER]
        for lane, owner in enumerate(reversed(owners)):
            mine = found.owner == owner
            begin = [1e6 * recording.clock.seconds(int(c) - release) for c in found.begin[mine]]
            end = [1e6 * recording.clock.seconds(int(c) - release) for c in found.end[mine]]
            for first, last in zip(begin, end, strict=True):
                if first < 250 and last > 0:
                    axis.barh(lane, last - first, left=first, height=0.6, color=SERIES[lane % 4])
        axis.set_yticks(range(4), ["interrupts", "display", "control", "co-processor"])
        axis.set(title=title, xlim=(0, 250), ylim=(-0.6, 3.6))
    axes[-1].set_xlabel("time since the common release (us)")
    return picture(figure)


def long() -> str:
    """Response times of control beside a display task of 30 ms, with both orders of priorities."""
    figure, (axes,) = new_figure(7, 3)
    orders: tuple[tuple[str, Edits], ...]
    orders = (("control below display", _SWAPPED), ("control above display", {}))
    for (name, edits), colour, mark in zip(orders, SERIES[1::-1], ("x", "."), strict=True):
        recording = run("blank", "press", {**edits, **_LONG})
        jobs = [j for j in _control_jobs(recording) if j.response_time_cycles is not None]
        at = [recording.clock.seconds(j.release_cycles) for j in jobs]
        took = [1000 * recording.clock.seconds(j.response_time_cycles or 0) for j in jobs]
        axes.semilogy(at, took, mark, color=colour, label=name)
    axes.axhline(20, color="0.4", linestyle=":", label="deadline")
    axes.set(xlabel="release of the job (s)", ylabel="response time (ms)", ylim=(0.02, 300))
    legend(axes, "upper right", columns=3)
    return picture(figure)


def drift() -> str:
    """Deviation of the releases from multiples of the period."""
    figure, (axes,) = new_figure(7, 2.8)
    kinds: tuple[tuple[str, Edits, str], ...]
    kinds = (("from the present time", _RELATIVE, "--"), ("until the next multiple", {}, "-"))
    for (name, edits, style), colour in zip(kinds, SERIES[1::-1], strict=True):
        recording = run("blank", "press", edits)
        releases = [recording.clock.seconds(j.release_cycles) for j in _control_jobs(recording)]
        error = np.array(releases) - releases[0] - 0.020 * np.arange(len(releases))
        axes.plot(releases, 1000 * error, style, color=colour, label=name)
    axes.set(xlabel="time (s)", ylabel="deviation (ms)")
    legend(axes, "upper left")
    return picture(figure)
