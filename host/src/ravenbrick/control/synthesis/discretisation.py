# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Continuous controllers made discrete."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["Discretisation", "DiscretisationMethod", "compare_discretisations", "discretise"]


class DiscretisationMethod(Enum):
    """How s is replaced or the response matched; the value is python-control's name if it has one.

    FORWARD_EULER s = (z-1)/Ts; BACKWARD_EULER s = (z-1)/(Ts z); TUSTIN s = 2/Ts (z-1)/(z+1);
    ZERO_ORDER_HOLD step-invariant; FIRST_ORDER_HOLD ramp-invariant, as for an input that is linear
    between the samples; IMPULSE_INVARIANT Ts times the samples of the impulse response; MATCHED
    poles and zeros by z = exp(s Ts).
    """

    FORWARD_EULER = "euler"
    BACKWARD_EULER = "backward_diff"
    TUSTIN = "bilinear"
    ZERO_ORDER_HOLD = "zoh"
    FIRST_ORDER_HOLD = "foh"
    IMPULSE_INVARIANT = "impulse"
    MATCHED = "matched"


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A discrete system beside its original at `frequency` (rad/s).

    `magnitude_ratio` is that of both frequency responses, `phase_difference` in rad.
    """

    method: DiscretisationMethod
    system: control.TransferFunction
    frequency: float
    magnitude_ratio: float
    phase_difference: float


def compare_discretisations(
    system: control.TransferFunction, sample_time: float, frequency: float
) -> tuple[Discretisation, ...]:
    """All methods that the system has, compared at one frequency (rad/s)."""
    rows = []
    wanted = complex(system(1j * frequency))
    for method in DiscretisationMethod:
        try:
            result = discretise(system, sample_time, method)
        except DesignError:
            continue
        ratio = complex(result(np.exp(1j * frequency * sample_time))) / wanted
        rows.append(Discretisation(method, result, frequency, abs(ratio), float(np.angle(ratio))))
    return tuple(rows)


def discretise(
    system: control.TransferFunction,
    sample_time: float,
    method: DiscretisationMethod,
    exact_at: float | None = None,
) -> control.TransferFunction:
    """The discrete system at `sample_time` (s); raises `DesignError` if the result is not finite.

    An impulse response has samples only if the system has more poles than zeros; the others need
    as many. Tustin's method with `exact_at` (rad/s) is pre-warped: the responses agree at that
    frequency.
    `MATCHED` is done here, because python-control 0.10.2 divides 0 by 0 for an integrator.
    """
    if not sample_time > 0:
        raise DesignError(f"the sample time must be > 0 s, not {sample_time}")
    excess = len(system.poles()) - len(system.zeros())
    least = 1 if method is DiscretisationMethod.IMPULSE_INVARIANT else 0
    if excess < least and method is not DiscretisationMethod.MATCHED:
        raise DesignError(
            f"{method.name} discretisation needs a system with "
            f"{'more poles than' if least else 'at least as many poles as'} zeros, not {system}"
        )
    if exact_at is not None:
        _check_prewarping(method, exact_at, sample_time)
        result = control.sample_system(system, sample_time, "bilinear", prewarp_frequency=exact_at)
    elif method is DiscretisationMethod.MATCHED:
        result = _matched(system, sample_time)
    else:
        result = control.sample_system(system, sample_time, method.value)
    coefficients = np.concatenate([result.num[0][0], result.den[0][0]])
    if not np.isfinite(coefficients).all():
        raise DesignError(f"{method.name} discretisation of {system} is not finite")
    return result


def _check_prewarping(method: DiscretisationMethod, frequency: float, sample_time: float) -> None:
    if method is not DiscretisationMethod.TUSTIN:
        raise DesignError(f"only Tustin's method is pre-warped, not {method.name}")
    if not 0 < frequency < np.pi / sample_time:
        raise DesignError(
            f"the frequency to agree at must lie between 0 and {np.pi / sample_time:.6g} rad/s "
            f"(half the sampling rate), not {frequency}"
        )


def _matched(system: control.TransferFunction, sample_time: float) -> control.TransferFunction:
    """Poles and zeros mapped; all but one zero at infinity go to -1; low frequencies agree.

    With m more poles than zeros at 0, s^m C(s) at s = 0 is made equal to ((z-1)/Ts)^m C(z) at
    z = 1.
    """
    poles, zeros = system.poles(), system.zeros()
    flat = int(np.sum(zeros == 0))
    numerator = _polynomial(np.exp(zeros[zeros != 0] * sample_time))
    for _ in range(len(poles) - len(zeros) - 1):
        numerator = np.polymul(numerator, [1.0, 1.0])
    integrators = int(np.sum(poles == 0))
    finite = _polynomial(np.exp(poles[poles != 0] * sample_time))
    denominator = np.polymul(finite, _polynomial(np.ones(integrators)))
    num, den = system.num[0][0], system.den[0][0]
    wanted = num[len(num) - 1 - flat] / den[len(den) - 1 - integrators]
    span = sample_time ** (integrators - flat)
    present = np.polyval(numerator, 1.0) / (np.polyval(finite, 1.0) * span)
    numerator = np.polymul(numerator, _polynomial(np.ones(flat)))
    return control.tf(np.real(numerator * (wanted / present)), np.real(denominator), sample_time)


def _polynomial(roots: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.atleast_1d(np.poly(roots))
