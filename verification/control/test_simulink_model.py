# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A public model and the C that Embedded Coder made of it: the imported parts do the same.

RAVENBRICK_SLX_MODELS names a folder with a copy of the repository EFeru/bldc-motor-control-FOC,
which holds both (`python -m verification.outside simulink-models`).
The model computes with fixed-point types and cuts its outputs to whole numbers, the import computes
with real numbers: the difference must stay below one whole number.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from ravenbrick.model import Execution
from ravenbrick.simulink import import_simulink, read_workspace

FOLDER = Path(os.environ.get("RAVENBRICK_SLX_MODELS", "")) / "EFeru" / "bldc-motor-control-FOC"
pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="RAVENBRICK_SLX_MODELS has no EFeru/bldc-motor-control-FOC"
)
MODEL = "BLDCmotor_FOC_R2017b_fixdt.slx"
POSITIONS = (5, 4, 6, 2, 3, 1)  # Hall signals 4 A + 2 B + C over one electrical turn
# The C asks for a long of 32 bits, which it never uses.
SHIM = """
#include <limits.h>
#undef ULONG_MAX
#undef LONG_MAX
#define ULONG_MAX 0xFFFFFFFFU
#define LONG_MAX 0x7FFFFFFF
#include "BLDC_controller.c"
#include "BLDC_controller_data.c"
#define main example_main
#include "ert_main.c"
static DW work; static ExtU given; static ExtY taken;
void begin(void)
{
  rtMPtr->defaultParam = &rtP; rtMPtr->inputs = &given; rtMPtr->outputs = &taken;
  rtMPtr->dwork = &work;
  BLDC_controller_initialize(rtMPtr);
}
void one_step(int a, int b, int c, int *speed, int *angle)
{
  given.b_hallA = (uint8_T)a; given.b_hallB = (uint8_T)b; given.b_hallC = (uint8_T)c;
  BLDC_controller_step(rtMPtr);
  *speed = taken.n_mot; *angle = taken.a_elecAngle;
}
"""


def hall_signals(steps: int) -> np.ndarray:
    """Standing, speeding up, slowing down, turning back; shape (steps, 3)."""
    rates = np.concatenate([
        np.zeros(200), np.linspace(0.004, 0.05, steps // 2 - 200),
        np.linspace(0.05, -0.04, steps - steps // 2),
    ])  # fmt: skip
    sectors = np.floor(np.cumsum(rates)).astype(int) % 6
    codes = np.array(POSITIONS)[sectors]
    return np.stack([codes >> 2 & 1, codes >> 1 & 1, codes & 1], axis=1)


def coder_outputs(folder: Path, signals: np.ndarray) -> np.ndarray:
    """Speed (rpm) and electrical angle (deg) as Embedded Coder's C gives them."""
    source = FOLDER / "BLDC_controller_ert_rtw"
    (folder / "shim.c").write_text(SHIM)
    library = folder / "coder.so"
    command = ["gcc", "-O1", "-w", "-shared", "-fPIC", f"-I{source}", str(folder / "shim.c")]
    subprocess.run([*command, "-o", str(library)], check=True)
    code = ctypes.CDLL(str(library))
    code.begin()
    speed, angle = ctypes.c_int(), ctypes.c_int()
    found = []
    for row in signals:
        code.one_step(*map(int, row), ctypes.byref(speed), ctypes.byref(angle))
        found.append((speed.value, angle.value))
    return np.array(found, float)


def imported_outputs(signals: np.ndarray) -> np.ndarray:
    """The same of the imported subsystem."""
    variables = read_workspace(FOLDER / "init_model.m")
    libraries = [FOLDER / "01_Libraries"]
    diagram = import_simulink(
        FOLDER / MODEL, 6e-5, variables, libraries, "BLDC_controller/F01_Estimations"
    )
    execution = Execution(diagram)
    found = []
    for a, b, c in signals:
        given = {"b_hallA": a, "b_hallB": b, "b_hallC": c, "a_mechAngle": 0.0}
        outputs = execution.step(given)
        found.append((float(outputs["n_mot"]), float(outputs["a_elecAngle"])))
    return np.array(found)


def test_speed_and_angle_are_those_of_embedded_coders_c(tmp_path: Path) -> None:
    """Conditional subsystems, counters with reset, tables, a relay: 12,000 steps."""
    signals = hall_signals(12_000)
    theirs, ours = coder_outputs(tmp_path, signals), imported_outputs(signals)
    assert theirs[:, 0].max() > 200 and theirs[:, 0].min() < -100
    speed = np.abs(theirs[:, 0] - ours[:, 0])
    angle = np.abs((theirs[:, 1] - ours[:, 1] + 180) % 360 - 180)
    print(f"speed: {speed.max():.3f} rpm, angle: {angle.max():.3f} deg")
    assert max(speed.max(), angle.max()) < 1.01
