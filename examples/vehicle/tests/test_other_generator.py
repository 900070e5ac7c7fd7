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
from ravenbrick.codegen import AdaBinding, ada_binding

from drivers.tests.observe import Brick, bench

VEHICLE = Path(__file__).resolve().parent.parent
ROOT = VEHICLE.parent.parent

# Double precision, one instance, variables of its own: what Embedded Coder writes for such a PI
# by its documented conventions, under today's names.
HEADER = """\
#ifndef RTW_HEADER_functional_h_
#define RTW_HEADER_functional_h_
#include "rtwtypes.h"
/* Block states (default storage) for system '<Root>' */
typedef struct {
  real_T Integrator_DSTATE;             /* '<Root>/Integrator' */
} DW_functional_T;
/* External inputs (root inport signals with default storage) */
typedef struct {
  real_T Input_Voltage;                 /* '<Root>/Input_Voltage' */
  real_T Real_Voltage;                  /* '<Root>/Real_Voltage' */
} ExtU_functional_T;
/* External outputs (root outports fed by signals with default storage) */
typedef struct {
  real_T correctedvoltage;              /* '<Root>/correctedvoltage' */
} ExtY_functional_T;
/* Parameters (default storage) */
struct P_functional_T_ {
  real_T Saturation;                    /* Variable: Saturation */
};
typedef struct P_functional_T_ P_functional_T;
extern P_functional_T functional_P;
extern DW_functional_T functional_DW;
extern ExtU_functional_T functional_U;
extern ExtY_functional_T functional_Y;
extern void functional_initialize(void);
extern void functional_step(void);
#endif
"""
SOURCE = """\
#include "functional.h"
P_functional_T functional_P = { 8.0 };
DW_functional_T functional_DW;
ExtU_functional_T functional_U;
ExtY_functional_T functional_Y;
void functional_step(void)
{
  real_T e = functional_U.Input_Voltage - functional_U.Real_Voltage;
  real_T u = 0.314445 * e + functional_DW.Integrator_DSTATE;
  real_T y = u;
  if (y > functional_P.Saturation) {
    y = functional_P.Saturation;
  } else if (y < -functional_P.Saturation) {
    y = -functional_P.Saturation;
  }
  functional_DW.Integrator_DSTATE += 0.032221 * e + 0.10810811 * (y - u);
  functional_Y.correctedvoltage = y;
}
void functional_initialize(void)
{
  functional_DW.Integrator_DSTATE = 0.0;
}
"""
FIELDS = ("Input_Voltage", "Real_Voltage", "correctedvoltage", "Saturation")


@pytest.fixture(scope="module")
def other_image(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The vehicle's sources with another folder of generated files."""
    folder = tmp_path_factory.mktemp("other")
    generated = folder / "generated"
    generated.mkdir()
    (generated / "functional.h").write_text(HEADER)
    (generated / "functional.c").write_text(SOURCE)
    (generated / "rtwtypes.h").write_text("typedef double real_T;\n")
    shutil.copy(VEHICLE / "generated" / "controller_design.ads", generated)
    binding = AdaBinding(
        "Speed_Controller",
        names={"correctedvoltage": "Corrected_Voltage"},
        types=dict.fromkeys(FIELDS, "Quantities.Volts"),
    )
    for name, text in ada_binding(HEADER, binding, "functional.h").items():
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
