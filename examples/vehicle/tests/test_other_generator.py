# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A controller in Embedded Coder's conventions in place of ours: same application, same files."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import virtual_brick
from ravenbrick.cli.app import app
from ravenbrick.project.templates import create_project
from typer.testing import CliRunner, Result

from verification.support.bricks.observe import Brick, bench
from verification.support.codegen.coder_models import FORMS, Form, coder_files

VEHICLE = Path(__file__).resolve().parent.parent
ROOT = VEHICLE.parent.parent

VOLTS = ("Input_Voltage", "Real_Voltage", "Corrected_Voltage", "Saturation")
BINDING = f"""
package = "Speed_Controller"
[types]
{"".join(f'{name} = "Quantities.Volts"{chr(10)}' for name in VOLTS)}
[inputs]
Input_Voltage = {{ Input_Voltage = 1 }}
Real_Voltage = {{ Real_Voltage = 1 }}
[outputs]
Corrected_Voltage = {{ correctedvoltage = 1 }}
"""


def command(*words: object) -> Result:
    """A command of the program that succeeds."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result


def bind(folder: Path, form: Form, generated: Path) -> None:
    """Write a model as Embedded Coder would, and bind it into a folder."""
    model = folder / "pid_control_ert_rtw"
    model.mkdir()
    for name, text in coder_files(form, "pid_control").items():
        (model / name).write_text(text)
    (folder / "binding.toml").write_text(BINDING)
    command("bind", model, folder / "binding.toml", "--output", generated)


def in_a_new_project(folder: Path) -> bytes:
    """The documented way, from `ravenbrick new` on."""
    project = create_project(folder / "rover", "vehicle").project
    script = project / "design.py"
    bind(folder, FORMS[1], project / "generated")
    names = {file.name for file in (project / "generated").iterdir()}
    assert "pid_control.c" in names and not names & {"functional.c", "functional.h"}
    script.write_text(script.read_text() + "\n# A change, after which it would be run.\n")
    command("build", project)
    assert not (project / "generated" / "functional.c").exists()
    refused = CliRunner().invoke(app, ["design", str(project)])
    assert refused.exit_code == 10 and "bound from 'pid_control_ert_rtw'" in refused.output
    return (project / "build" / "rover" / "ram" / "rover.elf").read_bytes()


def beside_the_own_one(folder: Path) -> bytes:
    """The vehicle's sources with another folder of generated files, by make."""
    generated = folder / "generated"
    generated.mkdir()
    shutil.copy(VEHICLE / "generated" / "controller_design.ads", generated)
    bind(folder, FORMS[2], generated)
    own = {"GENERATED": str(generated), "RAVENBRICK_BUILD": str(folder / "build")}
    program = f'RAVENBRICK="{sys.executable}" -c "from ravenbrick.cli import main; main()"'
    make = ["make", "-C", str(VEHICLE), "ram", program]
    done = subprocess.run(make, capture_output=True, text=True, check=False, env=os.environ | own)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return (folder / "build" / "vehicle" / "ram" / "vehicle.elf").read_bytes()


@pytest.fixture(scope="module", params=[in_a_new_project, beside_the_own_one])
def other_image(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The vehicle's sources with another controller."""
    image: bytes = request.param(tmp_path_factory.mktemp("other"))
    assert b"pid_control_step" in image and b"functional_step" not in image
    return image


def test_the_vehicle_drives_with_the_other_controller(other_image: bytes) -> None:
    """Both wheels reach their set-points, each with a state of its own; a turn slows one."""
    device = Brick(virtual_brick.VirtualBrick(json.dumps(bench()), other_image))
    device.set(600, "touch.1", 1)
    device.set(700, "touch.1", 0)
    device.set(1_600, "motor.A.hand_angle", 0.5)
    device.run(1_500)
    wanted = 0.8 * (8.0 - 2.0)
    speeds = [device.number(f"vehicle_speed_{side}") for side in ("left", "right")]
    assert speeds == pytest.approx([wanted, wanted], abs=0.3)
    device.run(2_800)
    left, right = (device.number(f"vehicle_speed_{side}") for side in ("left", "right"))
    assert right == pytest.approx(wanted, abs=0.3)
    assert left < 0.8 * right
