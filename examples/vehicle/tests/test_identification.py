# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors of the vehicle identified on the virtual brick."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

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


@pytest.mark.usefixtures("image")
def test_the_command_writes_the_plant_s_parameters(tmp_path: Path) -> None:
    """Experiment, fit, validation; the file is TOML with the motor's known constants.

    A command is in force up to 0.7 ms later while the co-processor samples, about half a count.
    """
    target = tmp_path / "motor.toml"
    arguments = ["identify", str(VEHICLE), str(EXPERIMENTS / "identify.toml")]
    arguments += [str(EXPERIMENTS / "identify-check.toml"), "--output", str(target), "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    answer = json.loads(done.output)
    assert answer["validation_error_counts"] < 1.1
    written = tomllib.loads(target.read_text())
    assert written["motor"]["inertia"]["value"] == pytest.approx(NXT_MOTOR.inertia, rel=0.02)
    assert written["motor"]["coulomb_friction"]["value"] == pytest.approx(4e-3, rel=0.05)
    assert written["model"]["gain"]["value"] == pytest.approx(2.0294, rel=0.005)
