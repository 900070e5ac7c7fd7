# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step metrics and margins of linear systems, continuous or sampled."""

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
_MOST_SAMPLES = 200_000


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
    """Gain margin (ratio), phase margin (deg) and gain crossover (rad/s) of an open loop.

    The gain margin is the factor nearest to 1 in dB with which the loop is at the edge of
    stability, at `phase_crossover` (rad/s). The loop keeps its stability, or lack of it, for
    factors between `lowest_gain` and `highest_gain`.
    """

    gain_margin: float
    phase_margin_deg: float
    crossover: float
    phase_crossover: float = math.nan
    lowest_gain: float = 0.0
    highest_gain: float = math.inf


def step_metrics(
    system: control.lti.LTI | LinearSystem, band: float = SETTLING_BAND
) -> StepMetrics:
    """Exact metrics of a stable system with one input and one output.

    The response is evaluated by matrix exponentials; extrema and the last crossing of the band are
    found as roots, to better than 1e-9 s. Of a discrete system the samples are taken: the settling
    time is the first sample from which all lie in the band. Raises `DesignError` for unstable
    systems and for several inputs or outputs.
    """
    realised = LinearSystem.of(system)
    matrix = realised.A
    outputs, inputs = realised.D.shape
    if (outputs, inputs) != (1, 1):
        raise DesignError(
            f"the system has {inputs} inputs and {outputs} outputs; choose one channel, such as "
            "system[0, 0] (output, input)"
        )
    if realised.isdtime():
        return _metrics_at_samples(realised, band)
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


def _metrics_at_samples(system: LinearSystem, band: float) -> StepMetrics:
    radius = float(np.abs(np.linalg.eigvals(system.A)).max()) if system.nstates else 0.0
    if radius >= 1:
        raise DesignError(
            f"the system is not stable (a pole at distance {radius:.4g} from 0), so it does not "
            "settle; change the gains"
        )
    count = system.nstates + (math.ceil(math.log(_REMAINDER) / math.log(radius)) if radius else 0)
    if count > _MOST_SAMPLES:
        raise DesignError(f"the system needs {count} samples to settle (pole at {radius:.7f})")
    gain = np.linalg.solve(np.eye(system.nstates) - system.A, system.B[:, 0])
    final = float(system.C[0] @ gain + system.D[0, 0])
    if final == 0.0:
        raise DesignError("the step response ends at 0, so there is no band to settle into")
    state, values = np.zeros(system.nstates), []
    for _ in range(count + 1):
        values.append(float(system.C[0] @ state + system.D[0, 0]) / final)
        state = system.A @ state + system.B[:, 0]
    outside = [k for k, value in enumerate(values) if abs(value - 1) > band * (1 + _REMAINDER)]
    settled = (outside[-1] + 1 if outside else 0) * system.dt
    excess = max(values) - 1
    return StepMetrics(settled, excess if excess > 10 * _REMAINDER else 0.0, final, settled)


def margins(open_loop: control.lti.LTI | LinearSystem) -> Margins:
    """Margins of the loop with unit negative feedback around `open_loop`.

    A discrete loop is searched from 0 up to and including half the sampling frequency; at both
    its response is real: a phase crossover there counts.
    """
    if open_loop.isdtime(strict=True):
        return _discrete_margins(open_loop)
    system = LinearSystem.of(open_loop).for_control()
    found = control.stability_margins(system, returnall=True)
    edges = [(float(gain), float(at)) for gain, at in zip(found[0], found[3], strict=True)]
    _, phase, _, crossover = control.margin(system)
    return _margins(edges, float(phase), float(crossover))


def _margins(edges: list[tuple[float, float]], phase: float, crossover: float) -> Margins:
    """From the edges of stability: factors with their frequencies."""
    edges = [(gain, at) for gain, at in edges if 0 < gain < 1 / _REMAINDER]
    nearest = min(edges, key=lambda edge: abs(math.log(edge[0])), default=(math.inf, math.nan))
    lowest = max((gain for gain, _ in edges if gain < 1), default=0.0)
    highest = min((gain for gain, _ in edges if gain >= 1), default=math.inf)
    return Margins(nearest[0], phase, crossover, nearest[1], lowest, highest)


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


def crossovers(open_loop: control.lti.LTI | LinearSystem) -> list[tuple[float, float]]:
    """All gain crossovers of a discrete loop: rad/s, and the phase above -180 degrees there, from 0
    to 360, which is what more delay may take away before the loop gets unstable. None of one in
    continuous time."""
    found: list[tuple[float, float]] = []
    if not open_loop.isdtime(strict=True):
        return found
    response = _Sampled(open_loop)
    for (left, right), (first, last) in zip(
        pairwise(response.grid), pairwise(response.values), strict=True
    ):
        if (abs(first) > 1) != (abs(last) > 1):
            root = response.crossover(left, right)
            found.append((root, math.degrees(cmath.phase(-response(root))) % 360))
    return found


def _discrete_margins(open_loop: control.lti.LTI | LinearSystem) -> Margins:
    response = _Sampled(open_loop)
    nyquist, grid, values = response.nyquist, response.grid, response.values
    phase, crossover = math.inf, math.nan
    edges = []
    for frequency in (0.0, nyquist):
        real = _real_value(response, frequency)
        if real < -_REMAINDER:
            edges.append((-1 / real, frequency))
    for (left, right), (first, last) in zip(pairwise(grid), pairwise(values), strict=True):
        if (abs(first) > 1) != (abs(last) > 1):
            root = response.crossover(left, right)
            own = math.degrees(cmath.phase(-response(root)))
            if abs(own) < abs(phase):
                phase, crossover = own, root
        if (first.imag > 0) != (last.imag > 0) and first.real < 0:
            root = float(optimize.brentq(lambda w: response(w).imag, left, right))
            edges.append((-1 / response(root).real, root))
    return _margins(edges, phase, crossover)


def _real_value(response: _Sampled, frequency: float) -> float:
    """The response where it is real; 0 where a pole makes it infinite."""
    lowest = response.grid[0]
    if frequency == 0.0 and abs(response(lowest / 10)) > 2 * abs(response(lowest)):
        return 0.0
    with np.errstate(all="ignore"):
        try:
            value = response(frequency).real
        except np.linalg.LinAlgError:
            return 0.0
    return value if math.isfinite(value) else 0.0
