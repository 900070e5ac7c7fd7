# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What stays tunable in an imported model, under which name; limits from outside; callbacks."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.simulink_files import FIRST, block, line, run, single_file

from ravenbrick.codegen import generate_c
from ravenbrick.model import Diagram, Execution
from ravenbrick.simulink import import_simulink

MODELS = Path(__file__).resolve().parents[3] / "examples" / "paper" / "models"


def imported(path: Path, middle: str, **variables: float) -> Diagram:
    """A block with number 2 between inport 1 and outport 9."""
    root = block("Inport", "u", 1) + middle + block("Outport", "y", 9)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "9#in:1")
    return import_simulink(single_file(path, root), 0.01, variables)


CASES = {
    "a variable has its own name": (block("Gain", "K", 2, Gain="Kp"), {"Kp": 2.0}),
    "an expression has the block's": (block("Gain", "K", 2, Gain="2*Kp"), {"K_Gain": 4.0}),
    "a number has the block's": (block("Gain", "My gain", 2, Gain="3"), {"My_gain_Gain": 3.0}),
    "a field of a structure": (block("Gain", "K", 2, Gain="pid.P"), {"pid_P": 5.0}),
    "symmetric limits are one": (
        block("Saturate", "S", 2, UpperLimit="battery", LowerLimit="-battery"), {"battery": 7.0}),
    "other limits are two": (block("Saturate", "S", 2, UpperLimit="battery", LowerLimit="0"),
                             {"battery": 7.0, "S_LowerLimit": 0.0}),
    "infinite limits are none": (block("Saturate", "S", 2, UpperLimit="inf", LowerLimit="0"),
                                 {"S_LowerLimit": 0.0}),
    "vectors are none": (block("Gain", "K", 2, Gain="[1 2]"), {}),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_scalars_stay_tunable_under_the_names_of_embedded_coder(name: str, tmp_path: Path) -> None:
    """Name and value in the parameters' structure."""
    middle, expected = CASES[name]
    diagram = imported(tmp_path / "m.slx", middle, **{"Kp": 2.0, "battery": 7.0, "pid.P": 5.0})
    found = diagram.lower().parameters
    assert {slot.name: slot.initial for slot in found} == expected


def test_a_mask_s_variable_is_not_the_workspace_s(tmp_path: Path) -> None:
    """Two masked subsystems with different gains `k` have a field each."""
    inner = block("Inport", "a", 11) + block("Gain", "G", 12, Gain="k") + block("Outport", "b", 13)
    inner += line("11#out:1", "12#in:1") + line("12#out:1", "13#in:1")
    system = f"<System>{inner}</System>"

    def masked(name: str, number: int, value: int) -> str:
        mask = f'<Mask><MaskParameter Name="k"><Value>{value}</Value></MaskParameter></Mask>'
        return block("SubSystem", name, number, mask + system)

    middle = masked("A", 3, 2) + masked("B", 2, 5) + line("1#out:1", "3#in:1")
    middle += block("Outport", "z", 8) + line("3#out:1", "8#in:1")
    found = imported(tmp_path / "m.slx", middle, k=1.0).lower().parameters
    assert {slot.name: slot.initial for slot in found} == {"G_Gain": 2.0, "B_G_Gain": 5.0}


def test_a_changed_gain_and_battery_take_effect_at_once() -> None:
    """As an application sets them; both limits follow the battery."""
    execution = Execution(import_simulink(MODELS / "figure5.slx", 0.004))
    far = {"input_voltage": 100.0, "real_voltage": 0.0}
    assert float(execution.step(far)["corrected_voltage"]) == 8.0
    execution.set_parameter("battery", 6.5)
    assert float(execution.step(far)["corrected_voltage"]) == 6.5
    back = {"input_voltage": -100.0, "real_voltage": 0.0}
    assert float(execution.step(back)["corrected_voltage"]) == -6.5
    execution.set_parameter("Kp", 0.0)
    execution.set_parameter("Ki", 0.0)
    execution.reset()
    assert float(execution.step(far)["corrected_voltage"]) == 0.0


def test_a_pid_takes_its_limits_from_its_ports(tmp_path: Path) -> None:
    """Ports up and lo, with clamping: the integral waits at the limit."""
    pid = block("Reference", "PID", 4, SourceBlock="simulink/Continuous/PID Controller",
                Ports="[3, 1]", TimeDomain="Discrete-time", SampleTime="0.01", Controller="PI",
                P="0", I="100", LimitOutput="on", SatLimitsSource="external",
                AntiWindupMode="clamping")  # fmt: skip
    root = block("Inport", "e", 1) + block("Inport", "up", 2, Port="2")
    root += block("Inport", "lo", 3, Port="3") + pid + block("Outport", "y", 5)
    root += "".join(line(f"{n}#out:1", f"4#in:{n}") for n in (1, 2, 3)) + line("4#out:1", "5#in:1")
    diagram = import_simulink(single_file(tmp_path / "m.slx", root), 0.01)
    error = np.array([1.0, 1, 1, 1, 1, -1, -1, -1, -1, -1])
    high, low = np.full(10, 2.5), np.full(10, -1.0)
    expected = [0, 1, 2, 2.5, 2.5, 2.5, 2, 1, 0, -1]
    assert run(diagram, error, high, low) == pytest.approx(expected, abs=1e-6)


def test_callbacks_give_variables_and_set_comes_before_them(tmp_path: Path) -> None:
    """In one file, in a file for each system; programs are read, not run."""
    root = block("Inport", "u", 1) + block("Gain", "K", 2, Gain="Kp") + block("Outport", "y", 3)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    callback = '<P Name="PreLoadFcn">Kp = 3; % gain\nopen_system(x)</P>'
    one, two = tmp_path / "one.slx", tmp_path / "two.slx"
    for path, inside in ((one, f"<System>{root}</System>"), (two, '<System Ref="system_root"/>')):
        with zipfile.ZipFile(path, "w") as archive:
            text = f"<ModelInformation><Model>{callback}{inside}</Model></ModelInformation>"
            archive.writestr("simulink/blockdiagram.xml", FIRST + text)
            if path == two:
                text = f"{FIRST}<System>{root}</System>"
                archive.writestr("simulink/systems/system_root.xml", text)
    for path in (one, two):
        assert import_simulink(path, 0.01).lower().parameters[0].initial == 3.0
    assert import_simulink(one, 0.01, {"Kp": 4.0}).lower().parameters[0].initial == 4.0


def test_a_block_s_name_cannot_end_a_comment_of_the_c(tmp_path: Path) -> None:
    """Its description is made of letters and digits."""
    text = generate_c(imported(tmp_path / "m.slx", block("Gain", "a*/b", 2, Gain="3"))).files["m.h"]
    assert "Gain of 'a_b'" in text and "*/b" not in text


def test_the_script_writes_the_models_of_the_paper(tmp_path: Path) -> None:
    """The files in the tree are what it writes, byte for byte."""
    subprocess.run([sys.executable, str(MODELS / "write_models.py"), str(tmp_path)], check=True)
    for name in ("figure4.slx", "figure5.slx"):
        assert (tmp_path / name).read_bytes() == (MODELS / name).read_bytes()
