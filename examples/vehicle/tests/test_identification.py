# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors of the vehicle identified on the virtual brick."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.errors import UsageError
from ravenbrick.image.elf import read_image
from ravenbrick.model import NXT_MOTOR
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.trace.sample_timing import sample_timing
from typer.testing import CliRunner

VEHICLE = Path(__file__).resolve().parent.parent
EXPERIMENTS = VEHICLE / "experiments"
IMAGE = VEHICLE.parent.parent / "build" / "vehicle" / "ram" / "vehicle.elf"


@pytest.mark.usefixtures("image")
def test_a_run_tells_when_the_controller_samples_and_acts() -> None:
    """Releases within 60 us of the period's begin; the motor answers some 2.3 ms later."""
    robot = read_robot(VEHICLE)
    experiment = read_scenario(EXPERIMENTS / "identify.toml", robot)
    recording = VirtualTarget().run(robot, experiment, read_image(IMAGE))
    timing = sample_timing(recording, "control_task", 1)
    assert len(timing.release) > 500
    assert 0 <= timing.release.min() <= timing.release.max() < 60e-6
    assert 2.0e-3 < timing.delay.min() <= timing.delay.max() < 4.0e-3
    with pytest.raises(UsageError, match="no task 'nobody'"):
        sample_timing(recording, "nobody", 1)


def _identified(target: Path, fit: Path, check: Path) -> dict[str, Any]:
    """The command's answer."""
    arguments = ["identify", str(VEHICLE), str(fit), str(check), "--output", str(target)]
    done = CliRunner().invoke(app, [*arguments, "--json"])
    assert done.exit_code == 0, done.output
    answer: dict[str, Any] = json.loads(done.output)
    return answer


def _with_weak_magnets(experiment: str, folder: Path) -> Path:
    """The experiment with another left motor."""
    constants = ("torque_constant", "electric_constant")
    deviations = "".join(f"{name} = {{ factor = 0.93 }}\n" for name in constants)
    text = (
        (EXPERIMENTS / experiment)
        .read_text()
        .replace("[[inputs]]", f"[deviations.B]\n{deviations}\n[[inputs]]", 1)
    )
    (folder / experiment).write_text(text)
    return folder / experiment


@pytest.mark.usefixtures("image")
def test_a_motor_that_is_faster_than_robot_toml_allows_gets_its_model(tmp_path: Path) -> None:
    """Gain and time constant by the motor's equations; no viscous friction below zero."""
    target = tmp_path / "motor.toml"
    fit, check = (_with_weak_magnets(f"identify{end}.toml", tmp_path) for end in ("", "-check"))
    assert _identified(target, fit, check)["constants"] is None
    written = tomllib.loads(target.read_text())
    assert "motor" not in written and "needs an electric_constant below" in target.read_text()
    torque, electric = 0.93 * NXT_MOTOR.torque_constant, 0.93 * NXT_MOTOR.electric_constant
    damping = NXT_MOTOR.resistance * NXT_MOTOR.viscous_friction + torque * electric
    time_constant = NXT_MOTOR.resistance * NXT_MOTOR.inertia / damping
    assert written["model"]["gain"]["value"] == pytest.approx(torque / damping, rel=0.005)
    assert written["model"]["time_constant"]["value"] == pytest.approx(time_constant, rel=0.02)


@pytest.mark.usefixtures("image")
def test_the_command_writes_the_plant_s_parameters(tmp_path: Path) -> None:
    """Experiment, fit, validation; the file is TOML with the motor's known constants.

    A command is in force up to 0.7 ms later while the co-processor samples, about half a count.
    """
    target = tmp_path / "motor.toml"
    answer = _identified(target, EXPERIMENTS / "identify.toml", EXPERIMENTS / "identify-check.toml")
    assert answer["validation_error_counts"] < 1.1
    written = tomllib.loads(target.read_text())
    assert written["motor"]["inertia"]["value"] == pytest.approx(NXT_MOTOR.inertia, rel=0.02)
    assert written["motor"]["coulomb_friction"]["value"] == pytest.approx(4e-3, rel=0.05)
    assert written["model"]["gain"]["value"] == pytest.approx(2.0294, rel=0.005)
