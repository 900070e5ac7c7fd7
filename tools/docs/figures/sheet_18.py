# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet on timing faults: a hung job with two detectors, in one phase and in all."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import jobs_of

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, project
from tools.docs.lessons import SHEETS, edited, files_of, steps, teaching_page

SHEET = SHEETS / "18-faults.md"
DETECTORS = {"supervision alone": SHEET, "monitor": teaching_page(SHEET)}
FAULT_MS = 1_000


def _edits(detector: str) -> Edits:
    """Of the template `blank`: the program of the sheet, or that of the solution."""
    files = files_of(SHEET)
    robot = (project("blank") / "robot.toml").read_text("utf-8")
    for step in steps(SHEET.read_text("utf-8")):
        if step.kind == "edit":
            robot = edited(robot, step.content)
    return {
        "robot.toml": robot,
        "src/tasks.ads": files["lab18/src/tasks.ads"],
        "src/tasks.adb": files_of(DETECTORS[detector])["lab18/src/tasks.adb"],
        "scenarios/fault.toml": files["lab18/scenarios/fault.toml"],
    }


@cache
def _run(detector: str, fault_ms: int) -> Recording:
    folder = project("blank", _edits(detector))
    robot = read_robot(folder)
    image = read_image(Workspace.of(folder).image("ram", robot.name))
    scenario = read_scenario(scenario_path(folder, "fault"), robot)
    inputs = tuple(replace(one, at_ms=fault_ms) for one in scenario.inputs)
    return VirtualTarget().run(robot, replace(scenario, inputs=inputs), image)


def _released(recording: Recording) -> float:
    """When the job that hangs was released, in seconds."""
    control = [thread.name.lower() for thread in recording.threads].index("control_task")
    longest = max(
        jobs_of(recording, control), key=lambda job: job.response_time_cycles or 1_000_000_000
    )
    return recording.clock.seconds(longest.release_cycles)


def duty() -> str:
    """Duty cycle from the release of the hung job on."""
    figure, (axes,) = new_figure(7.0, 3.0)
    for detector, colour in zip(DETECTORS, (SERIES[1], SERIES[0]), strict=True):
        recording = _run(detector, FAULT_MS)
        seconds, share = recording.signal("motor.B.duty")
        since = 1000 * (seconds - _released(recording))
        axes.step(since, 100 * share, where="post", color=colour, label=detector, linewidth=2)
    axes.axvline(20, color="black", linestyle=":", linewidth=1, label="deadline")
    axes.set(xlabel="time since the release of the job that hangs (ms)", ylabel="duty cycle (%)")
    axes.set(xlim=(-20, 160), ylim=(-3, 60))
    legend(axes, "center")
    return picture(figure)


def phases() -> str:
    """Time from the fault to the motor's stop over the instant of the fault."""
    figure, (axes,) = new_figure(7.0, 3.0)
    instants = range(FAULT_MS, FAULT_MS + 21, 2)
    for detector, colour in zip(DETECTORS, (SERIES[1], SERIES[0]), strict=True):
        latencies = []
        for instant in instants:
            seconds, share = _run(detector, instant).signal("motor.B.duty")
            off = seconds[(seconds > instant / 1000) & (share == 0)]
            latencies.append(1000 * float(off[0]) - instant)
        after = np.array(instants) - FAULT_MS
        axes.plot(after, latencies, "o-", color=colour, label=detector)
    axes.set(xlabel="instant of the fault after 1 s (ms)", ylabel="until the motor is off (ms)")
    axes.set(ylim=(0, 160))
    legend(axes, "center right")
    return picture(figure)
