# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about the Ravenscar profile."""

from __future__ import annotations

import tomllib

import numpy as np
from ravenbrick.trace.recording import EventKind

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, run
from tools.docs.lessons import SHEETS

SCENARIO = SHEETS / "rubrics" / "dead-man.toml"
RELATIVE = ("Next_Release := Next_Release + Control", "Next_Release := Clock + Control")
#  A program without a period has no cyclic task; the run would refuse a period it does not keep.
BACKGROUND = (
    'release = "cyclic"\nperiod_us = 20_000\ndeadline_us = 20_000',
    'release = "background"',
)


def drift() -> str:
    """Releases of the control task against whole periods, with and without a relative wait."""
    figure, (axes,) = new_figure(7.0, 3.2)
    for name, edits, colour in (
        ("Clock + Period", {"src/tasks.adb": [RELATIVE], "robot.toml": [BACKGROUND]}, SERIES[1]),
        ("Next_Release + Period", {}, SERIES[0]),
    ):
        recording = run("blank", "press", edits)
        task = recording.thread_index("control_task")
        events = recording.of_kind(EventKind.RELEASE)
        released = events["value"][events["subject"] == task].astype(np.int64)
        released = released[released > 0.1 * float(recording.clock.hertz)]
        late = (released - released[0]) / float(recording.clock.hertz)
        late -= 0.020 * np.arange(late.size)
        axes.plot(1e3 * late, color=colour, label=name, linewidth=2)
    axes.set(xlabel="job", ylabel="late against whole periods (ms)")
    legend(axes, "upper left")
    return picture(figure)


def _within_the_profile() -> Edits:
    """The program asked for: the instant of the last press is a variable of the cyclic task."""
    press = "            Presses.Add;"
    before = "      Before       :"
    rule = "(if Next_Release < Last_Press + Milliseconds (500) then 50 else 0)"
    return {
        "src/tasks.adb": [
            (before, f"      Last_Press   : Time := Time_First;\n{before}"),
            (press, f"{press}\n            Last_Press := Next_Release;"),
            ("(if Now then 50 else 0)", rule),
        ],
        "scenarios/dead-man.toml": SCENARIO.read_text("utf-8"),
    }


def dead_man() -> str:
    """Presses and speed of the motor with the program asked for."""
    recording = run("blank", "dead-man", _within_the_profile())
    inputs = tomllib.loads(SCENARIO.read_text("utf-8"))["inputs"]
    figure, axes = new_figure(7.0, 3.6, rows=2)
    instants = [0.0, *(step["at_ms"] / 1000 for step in inputs), 4.0]
    values = [0, *(step["value"] for step in inputs), inputs[-1]["value"]]
    axes[0].step(instants, values, where="post", color=SERIES[1], linewidth=2)
    axes[0].set(ylabel="touch sensor", yticks=(0, 1))
    seconds, speed = recording.signal("motor.B.angular_velocity")
    axes[1].plot(seconds, speed, color=SERIES[0], linewidth=2)
    axes[1].set(xlabel="time (s)", ylabel="motor (rad/s)")
    return picture(figure)
