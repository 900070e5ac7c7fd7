# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""PID by margin and by poles, beside what python-control says of the loop."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest

from ravenbrick.control import pid_by_margin, pid_by_poles
from ravenbrick.errors import DesignError

SPEED = control.tf([1.002183], [0.037, 1.0])
ANGLE = control.tf([40.0], [1.0, 20.0, 0.0])


@pytest.mark.parametrize(
    ("plant", "kind", "margin", "crossover", "delay", "pole"),
    [
        (SPEED, "PI", 65.0, 20.0, 0.0, math.inf),
        (SPEED, "PI", 60.0, 20.0, 0.006, math.inf),
        (ANGLE, "PD", 60.0, 30.0, 0.0, 300.0),
        (ANGLE, "PD", 50.0, 25.0, 0.002, math.inf),
        (ANGLE, "PID", 55.0, 20.0, 0.0, 400.0),
        (ANGLE, "PID", 60.0, 30.0, 0.002, 500.0),
    ],
)
def test_the_loop_has_the_margin_at_the_crossover(
    plant: control.TransferFunction,
    kind: str,
    margin: float,
    crossover: float,
    delay: float,
    pole: float,
) -> None:
    """python-control's margin of the loop without the delay, less the delay's phase."""
    gains = pid_by_margin(plant, margin, crossover, kind, delay, pole)
    _, found, _, at = control.margin(gains.controller() * plant)
    assert at == pytest.approx(crossover, rel=1e-6)
    assert found - math.degrees(crossover * delay) == pytest.approx(margin, abs=1e-4)
    assert (gains.integral > 0) == (kind != "PD")
    if kind == "PID":
        assert gains.proportional / gains.integral == pytest.approx(
            4 * gains.derivative / gains.proportional
        )


@pytest.mark.parametrize(
    ("plant", "poles"),
    [
        (SPEED, [-12 + 5j, -12 - 5j]),
        (ANGLE, [-30.0, -25.0]),
        (ANGLE, [-8 + 6j, -8 - 6j, -40.0]),
    ],
)
def test_the_closed_loop_has_the_poles(
    plant: control.TransferFunction, poles: list[complex]
) -> None:
    """Of python-control's feedback."""
    loop = control.feedback(pid_by_poles(plant, poles).controller() * plant)
    found = np.sort_complex(control.minreal(loop, verbose=False).poles())
    assert np.allclose(found, np.sort_complex(np.array(poles, complex)), rtol=1e-6)


def test_what_cannot_be_is_said_with_the_phase_that_is_missing() -> None:
    """A PI cannot lead, poles come in pairs, a plant has no zeros."""
    with pytest.raises(DesignError, match=r"turn the phase by 26\.3 deg; a PI turns it by -90"):
        pid_by_margin(ANGLE, 60.0, 30.0, "PI")
    lags = control.tf([40.0], [1.0, 4.0, 5.0, 2.0])
    for kind, least in (("PD", 0), ("PID", -90)):
        sentence = rf"turn the phase by 117\.3 deg; a {kind} turns it by {least} to 90 deg"
        with pytest.raises(DesignError, match=sentence):
            pid_by_margin(lags, 50.0, 10.0, kind)
    with pytest.raises(DesignError, match="must come in pairs"):
        pid_by_poles(SPEED, [-1 + 2j, -3.0])
    with pytest.raises(DesignError, match="3 poles for a plant of order 1"):
        pid_by_poles(SPEED, [-1.0, -2.0, -3.0])
