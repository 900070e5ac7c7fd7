# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The task around a controller, as text; `cli/test_from_diagram.py` builds and drives it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from ravenbrick.codegen import control_task, generate_c
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, Gain, Inport, Outport

STEP = "Controller.Step (Work, Inputs, Outputs);"


def header() -> str:
    """Of a controller from `speed` and `wanted` to `duty`."""
    diagram = Diagram("functional", 0.004)
    for source, target in (("speed", "duty"), ("wanted", "other")):
        blocks = (Inport(source), Gain(f"K_{source}", gain=2.0), Outport(target))
        diagram.connect_chain(*(diagram.add(block) for block in blocks))
    return generate_c(diagram).files["functional.h"]


def task(period: float = 0.004, **more: Any) -> list[str]:
    """Lines of the task's body, without margins."""
    given: dict[str, Any] = {
        "inputs": {"speed": "motor.A.speed", "wanted": 1.5}, "outputs": {"duty": "motor.A.duty"},
    }  # fmt: skip
    files = control_task(header(), period, **(given | more))
    assert f"--  Every {round(period * 1e6)} us" in files["tasks.ads"]
    return [line.strip() for line in files["tasks.adb"].splitlines()]


@pytest.mark.parametrize("period", [1e-6, 0.004, 0.01, 1 / 3 + 1e-6 - 1 / 3])
def test_a_whole_number_of_microseconds_is_the_period(period: float) -> None:
    """Also where the double is not quite that number."""
    assert f"Period        : constant Time_Span := Microseconds ({round(period * 1e6)});" in task(
        period
    )


@pytest.mark.parametrize("period", [0.0, -0.004, 4e-7, 0.0033335, 1 / 3])
def test_another_period_is_refused(period: float) -> None:
    with pytest.raises(DesignError, match="no whole number of microseconds"):
        task(period)


@pytest.mark.parametrize("window", [1, 2, 8])
def test_a_speed_is_the_difference_over_its_window(window: int) -> None:
    """A ring with as many readings; it turns once in a period, before the step."""
    lines = task(speed_window=window)
    assert f"Per_Count : constant := 1_000_000.0 / (4000.0 * {window}.0);" in lines
    assert f"subtype Reading_Index is Natural range 0 .. {window - 1};" in lines
    turn = lines.index(f"Oldest := (Oldest + 1) mod {window};")
    assert lines.index("Past_A (Oldest) := Now_A;") < turn < lines.index(STEP)


def test_a_window_without_a_sample_is_refused() -> None:
    with pytest.raises(DesignError, match="window is 0 samples"):
        task(speed_window=0)


@pytest.mark.parametrize(
    ("kind", "about", "least", "most", "scale"),
    [
        ("uint8_T", "", 0, 255, 1),
        ("int8_T", "", -128, 127, 1),
        ("int16_T", "sfix16_En4", -32768, 32767, 16),
        ("uint16_T", "ufix16_En2", 0, 65535, 4),
        ("int32_T", "", -(2**31), 2**31 - 1, 1),
        ("uint32_T", "ufix32_En8", 0, 2**32 - 1, 256),
    ],
)
def test_an_input_of_whole_numbers_saturates_at_the_ends_of_its_type(
    kind: str, about: str, least: int, most: int, scale: int
) -> None:
    """Whatever is written into its variable; what comes of it in single precision fits the type."""
    text = header().replace("real32_T speed;", f"{kind} speed; /* {about} */")
    assert kind in text
    body = control_task(text, 0.004, {}, {})["tasks.adb"]
    sentence = r"Inputs\.Speed := Interfaces\.\w+ \(Float'Rounding \(Float'Max \((\S+), "
    sentence += r"Float'Min \((\S+), Speed_Seen\)\)(?: \* (\S+))?\)\);"
    found = re.search(sentence, " ".join(body.split()))
    assert found is not None and float(found[3] or 1.0) == scale
    ends = [float(np.float32(float(end)) * np.float32(scale)) for end in (found[1], found[2])]
    assert ends[0] == least and most * (1 - 2.0**-23) <= ends[1] <= most


def test_devices_are_read_before_the_step_and_driven_after_it() -> None:
    """A number is a variable that starts with it; what nothing drives is still recorded."""
    lines = task()
    assert "Wanted_Seen : Float := 1.5 with" in lines and "Other_Seen : Float := 0.0 with" in lines
    step = lines.index(STEP)
    assert lines.index("Inputs.Speed := Speed_Seen;") < step
    assert lines.index("Other_Seen := Float (Outputs.Other);") > step
    assert lines.index("NXT.Motor_Controls.Drive (Motor_A, To_Duty (Duty_Seen, 100.0));") > step


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"inputs": {"sped": "battery"}}, "no port 'sped' among its inputs; it has speed, wanted"),
        ({"outputs": {"x": "seen"}}, "no port 'x' among its outputs; it has duty, other"),
        ({"inputs": {"speed": "motor.D.angle"}}, "port 'speed': 'motor.D.angle' is not known"),
        ({"inputs": {"speed": "motor.A.duty"}}, "'motor.A.duty' is not known"),
        ({"inputs": {"speed": "touch.5"}}, "'touch.5' is not known"),
        ({"inputs": {"speed": float("nan")}}, "'nan' is not known"),
        ({"outputs": {"duty": "motor.A.speed"}}, "port 'duty': 'motor.A.speed' is not known"),
    ],
)
def test_what_no_port_and_no_device_is_called_is_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        task(**change)
