# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper's vehicle: figure 5 is the designed controller, and all telemetry arrives."""

from __future__ import annotations

import json
import runpy
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ravenbrick.cli.app import app
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.design_script import design_is_due
from ravenbrick.image.elf import read_image
from ravenbrick.model.simulation.execution import Execution
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace
from ravenbrick.simulink import import_simulink
from typer.testing import CliRunner

from tools.docs.live_steps import PAPER, monitored_steps, steps_and_design

PROJECT = PAPER.project
SAMPLE_TIME_S = 0.004
WINDOW_QUANTUM_V = 0.269


def command(*words: object) -> dict[str, Any]:
    """The JSON answer of a command that must succeed."""
    result = CliRunner().invoke(app, [*(str(word) for word in words), "--json"])
    assert result.exit_code == 0, result.output
    answer: dict[str, Any] = json.loads(result.output)
    return answer


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    """What design.py defines."""
    return runpy.run_path(str(PROJECT / "design.py"))


def test_the_numbers_of_the_paper(script: dict[str, Any]) -> None:
    """Figure 4 from table 1, 400 ms with almost no overshoot; periods; listing 1."""
    figures = script["design"]().figures()
    assert (figures["plant_gain"], figures["plant_time_constant"]) == (2.029, 0.037)
    loop = command("simulate", PROJECT / "models" / "figure4.slx")
    step = next(s["step"] for s in loop["signals"] if s["step"])
    assert step["settling_time"] == pytest.approx(0.4, abs=0.001)
    assert step["overshoot"] < 0.005
    robot = read_robot(PROJECT)
    periods = {"control_task": 4, "coprocessor_task": 2, "display_task": 500}
    assert {name: robot.period_ms(name) for name in periods} == periods
    listing = " ".join((PROJECT / "src" / "tasks.ads").read_text().split())
    for task, priority in (("Control_Task", 2), ("Display_Task", 1)):
        assert (
            f"task {task} is pragma Priority (System.Priority'First + {priority}); "
            f"pragma Storage_Size (4096); end {task};"
        ) in listing


def test_figure_5_gives_the_outputs_of_the_designed_controller(script: dict[str, Any]) -> None:
    """Sample by sample, while no limit is reached: the same PI, its gains folded otherwise."""
    design = script["design"]()
    gains = design.discrete.gains
    variables = {"Kp": gains.proportional, "Ki": gains.integral, "battery": 8.0}
    imported = Execution(import_simulink(script["FIGURE_5"], SAMPLE_TIME_S, variables))
    designed = Execution(design.controller)
    largest = 0.0
    for wanted, real in np.random.default_rng(4).uniform(-3, 3, (1000, 2)):
        ours = designed.step({"Input_Voltage": wanted, "Real_Voltage": real})["correctedvoltage"]
        theirs = imported.step({"input_voltage": wanted, "real_voltage": real})
        assert theirs["corrected_voltage"] == pytest.approx(ours, abs=2e-5)
        largest = max(largest, abs(ours))
    assert 2.0 < largest < 8.0


def test_the_command_imports_the_c_that_the_design_generates(
    script: dict[str, Any], tmp_path: Path
) -> None:
    """With the design's gains `ravenbrick import` writes the same files, so the Ada fits both."""
    gains = script["design"]().discrete.gains
    values = {"Kp": gains.proportional, "Ki": gains.integral, "battery": 8.0}
    given = [word for name, value in values.items() for word in ("--set", f"{name}={value!r}")]
    options = ("--sample-time", SAMPLE_TIME_S, "--name", "functional", "--output", tmp_path)
    command("import", script["FIGURE_5"], *options, *given)
    for name in ("functional.c", "functional.h", "rtwtypes.h"):
        assert (tmp_path / name).read_text() == (PROJECT / "generated" / name).read_text(), name


def test_every_control_period_is_seen_over_bluetooth_and_gains_change_on_the_way() -> None:
    """250 samples per second of eight signals, none dropped; top speed and gain are in force."""
    image = read_image(Path(command("build", PROJECT)["image"]))
    session = monitored_steps(image, (4.0, 2.0, 4.5, 3.0), 1_500, PAPER, {"kp": 0.3})
    run = session.run
    assert run is not None and run.missing == 0
    assert session.status.dropped == 0
    values = {p.name: session.values[i] for i, p in session.parameters.items()}
    assert values["kp"] == pytest.approx(0.3) and values["top_speed"] == 3.0
    times = np.array(run.groups[1].times_us)
    assert len(times) > 1_500
    assert np.all(np.abs(np.diff(times) - 4_000) < 200)
    recording = run.recording()
    assert recording.signal("battery")[1][-1] == pytest.approx(8_000, abs=100)
    assert recording.signal("joystick")[1][-1] == 0
    for side in ("left", "right"):
        _, real = recording.signal(f"real_{side}")
        assert np.mean(real[-250:]) == pytest.approx(3.0, abs=0.05)
        assert np.max(np.abs(recording.signal(f"out_{side}")[1])) < 8.1


def test_live_steps_of_the_paper_lie_on_its_design() -> None:
    """Averaged over eight samples, four steps follow the sampled design."""
    steps, design = steps_and_design(each_ms=600, example=PAPER)
    assert [round(step.height, 3) for step in steps] == [4.0, -2.0, 2.5, -1.5]
    sampled = design.responses["sampled"]
    for step in steps:
        designed = np.interp(step.times, sampled.times, sampled.values)
        off = step.values - designed
        assert abs(np.mean(off)) < 0.03
        assert np.mean(np.abs(off)) < WINDOW_QUANTUM_V / abs(step.height)


def test_a_changed_model_is_designed_again(tmp_path: Path) -> None:
    """The C is one of figure 5, so `build` runs the design again when Simulink has changed it."""
    project = tmp_path / "remodelled"
    shutil.copytree(PROJECT, project)
    command("design", project)
    workspace, settings = Workspace.of(project), Settings.of(read_robot(project), {})
    assert not design_is_due(workspace, settings)
    (project / "models" / "figure5.slx").write_bytes(b"another model")
    assert design_is_due(workspace, settings)


def test_the_window_of_eight_periods_is_a_choice_in_the_design(tmp_path: Path) -> None:
    """One number in design.py: gains, program and step response follow it."""
    project = tmp_path / "windowed"
    shutil.copytree(PROJECT, project)
    design = project / "design.py"
    text = design.read_text()
    assert "SPEED_WINDOW = 1\n" in text
    design.write_text(text.replace("SPEED_WINDOW = 1\n", "SPEED_WINDOW = 8\n"))
    command("design", project)
    command("build", project)
    constants = (project / "generated" / "controller_design.ads").read_text()
    assert "Speed_Window : constant := 8;" in constants
    answer = command("run", project, "step")
    assert all(criterion["met"] for criterion in answer["criteria"])
