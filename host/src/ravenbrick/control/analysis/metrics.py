# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step metrics and margins of continuous linear systems."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ravenbrick.control.analysis.flow import FlowMatrix, Segment, largest_value, settling_time
from ravenbrick.errors import DesignError
from ravenbrick.model import LinearSystem
from ravenbrick.model.lazy import control, optimize

__all__ = ["SETTLING_BAND", "Margins", "StepMetrics", "crossovers", "margins", "step_metrics"]

SETTLING_BAND = 0.02
_REMAINDER = 1e-10
_FREQUENCIES = 2000


@dataclass(frozen=True)
class StepMetrics:
    """Of a unit step: `settling_time` in s (last entry into the band around the final value),

    `overshoot` as a share of the final value, `final_value` in output units, and for sampled loops
    `settling_time_at_samples`, the first sample from which all samples lie in the band.
    """

    settling_time: float
    overshoot: float
    final_value: float
    settling_time_at_samples: float | None = None


@dataclass(frozen=True)
class Margins:
    """Gain margin (ratio), phase margin (deg) and gain crossover (rad/s) of an open loop."""

    gain_margin: float
    phase_margin_deg: float
    crossover: float


def step_metrics(
    system: control.lti.LTI | LinearSystem, band: float = SETTLING_BAND
) -> StepMetrics:
    """Exact metrics of a stable, continuous, single-input single-output system.

    The response is evaluated by matrix exponentials; extrema and the last crossing of the band are
    found as roots, to better than 1e-9 s. Raises `DesignError` for unstable systems.
    """
    realised = LinearSystem.of(system)
    matrix = realised.A
    if matrix.size == 0:
        return StepMetrics(0.0, 0.0, float(np.real(realised.D[0, 0])))
    poles = np.linalg.eigvals(matrix)
    if poles.real.max() >= 0:
        raise DesignError(
            f"the system is not stable (pole at {poles[poles.real.argmax()]:.4g}), so it does not "
            "settle; change the gains"
        )
    rest = np.asarray(-np.linalg.solve(matrix, realised.B[:, 0]), dtype=float)
    final = float(realised.C[0] @ rest + realised.D[0, 0])
    if final == 0.0:
        raise DesignError("the step response ends at 0, so there is no band to settle into")
    horizon = -math.log(_REMAINDER) / float(-poles.real.max())
    flow = FlowMatrix(matrix, horizon)
    segment = Segment(flow, 0.0, -rest, np.asarray(realised.C[0] / final))
    excess = largest_value([segment])
    overshoot = excess if excess > _REMAINDER * 10 else 0.0
    return StepMetrics(settling_time([segment], band), overshoot, final)


def margins(open_loop: control.lti.LTI | LinearSystem) -> Margins:
    """Margins of the loop with unit negative feedback around `open_loop`.

    A discrete loop is searched up to and including half the sampling frequency, where its response
    is real: a phase crossover there counts.
    """
    if open_loop.isdtime(strict=True):
        return _discrete_margins(open_loop)
    gain, phase, _, crossover = control.margin(open_loop)
    return Margins(float(gain), float(phase), float(crossover))


class _Sampled:
    """Frequency response of a discrete loop, and its values on a grid up to half the sampling
    frequency."""

    def __init__(self, open_loop: control.lti.LTI | LinearSystem) -> None:
        self._loop, self._period = open_loop, float(open_loop.dt)
        self.nyquist = math.pi / self._period
        self.grid = np.geomspace(self.nyquist * 1e-5, self.nyquist * (1 - 1e-9), _FREQUENCIES)
        self.values = np.squeeze(open_loop(np.exp(1j * self.grid * self._period)))

    def __call__(self, frequency: float) -> complex:
        return complex(np.squeeze(self._loop(cmath.exp(1j * frequency * self._period))))

    def crossover(self, left: float, right: float) -> float:
        """The gain crossover (rad/s) between these two."""
        return float(optimize.brentq(lambda w: abs(self(w)) - 1, left, right))


def crossovers(open_loop: control.lti.LTI) -> tuple[tuple[float, float], ...]:
    """All gain crossovers of a discrete loop: rad/s, and the phase above -180 degrees there, from 0
    to 360, which is what more delay may take away before the loop gets unstable."""
    found = []
    response = _Sampled(open_loop)
    for (left, right), (first, last) in zip(
        pairwise(response.grid), pairwise(response.values), strict=True
    ):
        if (abs(first) > 1) != (abs(last) > 1):
            root = response.crossover(left, right)
            found.append((root, math.degrees(cmath.phase(-response(root))) % 360))
    return tuple(found)


def _discrete_margins(open_loop: control.lti.LTI | LinearSystem) -> Margins:
    response = _Sampled(open_loop)
    nyquist, grid, values = response.nyquist, response.grid, response.values
    gain, phase, crossover = math.inf, math.inf, math.nan
    at_nyquist = response(nyquist).real
    if at_nyquist < -_REMAINDER:
        gain = -1 / at_nyquist
    for (left, right), (first, last) in zip(pairwise(grid), pairwise(values), strict=True):
        if (abs(first) > 1) != (abs(last) > 1):
            root = response.crossover(left, right)
            own = math.degrees(cmath.phase(-response(root)))
            if abs(own) < abs(phase):
                phase, crossover = own, root
        if (first.imag > 0) != (last.imag > 0) and first.real < 0:
            root = float(optimize.brentq(lambda w: response(w).imag, left, right))
            gain = min(gain, -1 / response(root).real)
    return Margins(gain, phase, crossover)
