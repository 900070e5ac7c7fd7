# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Continuous controllers made discrete."""

from __future__ import annotations

from enum import Enum
from typing import Any

import control
import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError

__all__ = ["DiscretisationMethod", "discretise"]


class DiscretisationMethod(Enum):
    """How s is replaced or the response matched; the value is python-control's name if it has one.

    FORWARD_EULER s = (z-1)/Ts; BACKWARD_EULER s = (z-1)/(Ts z); TUSTIN s = 2/Ts (z-1)/(z+1);
    ZERO_ORDER_HOLD step-invariant; MATCHED poles and zeros by z = exp(s Ts).
    """

    FORWARD_EULER = "euler"
    BACKWARD_EULER = "backward_diff"
    TUSTIN = "bilinear"
    ZERO_ORDER_HOLD = "zoh"
    MATCHED = "matched"


def discretise(
    system: control.TransferFunction, sample_time: float, method: DiscretisationMethod
) -> control.TransferFunction:
    """The discrete system at `sample_time` (s); raises `DesignError` if the result is not finite.

    `MATCHED` is done here, because python-control 0.10.2 divides 0 by 0 for an integrator.
    """
    if not sample_time > 0:
        raise DesignError(f"the sample time must be > 0 s, not {sample_time}")
    if method is DiscretisationMethod.MATCHED:
        result = _matched(system, sample_time)
    else:
        result = control.sample_system(system, sample_time, method.value)
    coefficients = np.concatenate([result.num[0][0], result.den[0][0]])
    if not np.isfinite(coefficients).all():
        raise DesignError(f"{method.name} discretisation of {system} is not finite")
    return result


def _matched(system: control.TransferFunction, sample_time: float) -> control.TransferFunction:
    """Poles and zeros mapped; all but one zero at infinity go to -1; low frequencies agree.

    With m poles at 0, s^m C(s) at s = 0 is made equal to ((z-1)/Ts)^m C(z) at z = 1.
    """
    poles, zeros = system.poles(), system.zeros()
    if np.any(zeros == 0):
        raise DesignError("a matched system with a zero at s = 0 has no low-frequency gain")
    numerator = _polynomial(np.exp(zeros * sample_time))
    for _ in range(len(poles) - len(zeros) - 1):
        numerator = np.polymul(numerator, [1.0, 1.0])
    integrators = int(np.sum(poles == 0))
    finite = _polynomial(np.exp(poles[poles != 0] * sample_time))
    denominator = np.polymul(finite, _polynomial(np.ones(integrators)))
    num, den = system.num[0][0], system.den[0][0]
    wanted = num[-1] / den[len(den) - 1 - integrators]
    present = np.polyval(numerator, 1.0) / (np.polyval(finite, 1.0) * sample_time**integrators)
    return control.tf(np.real(numerator * (wanted / present)), np.real(denominator), sample_time)


def _polynomial(roots: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.atleast_1d(np.poly(roots))
