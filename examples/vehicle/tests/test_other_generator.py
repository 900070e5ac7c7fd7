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
from ravenbrick.codegen import AdaBinding, read_coder_model

from drivers.tests.observe import Brick, bench
from host.tests.support.coder_models import FORMS, coder_files

VEHICLE = Path(__file__).resolve().parent.parent
ROOT = VEHICLE.parent.parent

BINDING = AdaBinding(
    "Speed_Controller",
    types=dict.fromkeys(
        ("Input_Voltage", "Real_Voltage", "Corrected_Voltage", "Saturation"), "Quantities.Volts"
    ),
    inputs={name: {name: 1} for name in ("Input_Voltage", "Real_Voltage")},
    outputs={"Corrected_Voltage": {"correctedvoltage": 1}},
)


@pytest.fixture(scope="module", params=FORMS[1:3], ids=str)
def other_image(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The vehicle's sources with another folder of generated files."""
    folder = tmp_path_factory.mktemp("other")
    model, generated = folder / "model", folder / "generated"
    for path in (model, generated):
        path.mkdir()
    for name, text in coder_files(request.param).items():
        (model / name).write_text(text)
    shutil.copy(VEHICLE / "generated" / "controller_design.ads", generated)
    for name, text in read_coder_model(model).files_with_binding(BINDING).items():
        (generated / name).write_text(text)
    command = ["make", "-C", str(VEHICLE), "ram", f"PYTHON={sys.executable}"]
    own = {"GENERATED": str(generated), "RAVENBRICK_BUILD": str(folder / "build")}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | own
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return (folder / "build" / "vehicle" / "ram" / "vehicle.elf").read_bytes()


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
