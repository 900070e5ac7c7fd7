# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Motor parameters from voltages and encoder counts, with confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model import Encoder
from ravenbrick.model.lazy import optimize, stats

__all__ = [
    "IdentifiedMotor",
    "MotorData",
    "PredictionBand",
    "Validation",
    "fit_motor",
    "predict_counts",
    "simulate_counts",
    "validate_motor",
]

Array = npt.NDArray[np.float64]

NAMES = ("gain", "time_constant", "friction_voltage")
_UNITS = ("rad/s/V", "s", "V")
_START = (2.0, 0.05, 0.1)
_LOWEST = (1e-3, 1e-3, 0.0)
_HIGHEST = (1e3, 10.0, 50.0)
_LEAST_TURNS = 1.0
_LONGEST_DELAY = 0.005
# Lags of the covariance as a share of the samples, and what so many cost in the critical value
# (Kiefer and Vogelsang, Econometric Theory 21, 2005: 1.96 + 2.9694 b + 0.4160 b^2 for b lags).
_LAG_SHARE = 0.1
_LAG_CORRECTION = (1.96 + 2.9694 * _LAG_SHARE + 0.4160 * _LAG_SHARE**2) / 1.96
_WORST_CONDITION = 1e7
# How large what is fitted is: parameters, phase, delay; and the steps of its derivatives.
_SCALE = np.array([1.0, 0.02, 0.1, 0.5, 0.001])
_STEPS = 1e-4 * _SCALE
# Places of the three parameters and the delay in what is fitted; the phase is each run's own.
_PREDICTING = (0, 1, 2, 4)


@dataclass(frozen=True, eq=False)
class MotorData:
    """A run from rest: `time` (s) and `count` at each sample, shapes (n,);

    the motor has `voltage[i]` (V) from `change[i]` (s) on, shapes (m,), and none before.
    """

    time: Array
    count: Array
    change: Array
    voltage: Array

    def __post_init__(self) -> None:
        if len(self.time) != len(self.count) or len(self.change) != len(self.voltage):
            raise DesignError("times and counts, changes and voltages must have the same lengths")
        if len(self.time) < 100 or not len(self.change):
            raise DesignError("too little data: at least 100 samples and one voltage are needed")
        if (np.diff(self.time) <= 0).any() or (np.diff(self.change) < 0).any():
            raise DesignError("the instants must rise")


@dataclass(frozen=True)
class Interval95:
    """A parameter's `value` with the ends of its interval: the extent of the joint 95 % confidence

    ellipsoid of everything that is fitted (Scheffe), so that all intervals hold at once.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float

    def holds(self, true_value: float) -> bool:
        """Whether the interval contains the value."""
        return bool(self.low <= true_value <= self.high)


@dataclass(frozen=True, eq=False)
class IdentifiedMotor:
    """speed' = (gain (u - friction_voltage sign(speed)) - speed) / time_constant, in rad/s and V.

    The friction is Coulomb's, stated as the voltage that it takes. `phase` (counts) of the encoder
    and `delay` (s) from a command to the motor are fitted besides. `error` is the root mean
    square difference of the fit in counts, `largest_error` the largest; 0.29 and 0.5 are what an
    ideal encoder rounds. `axes` are the half axes of the joint 95 % confidence ellipsoid of the
    three parameters and the delay, shape (4, 4), one a column.
    """

    parameters: tuple[Interval95, ...]
    phase: float
    delay: float
    error: float
    largest_error: float
    axes: Array

    def values(self) -> dict[str, float]:
        """The parameters by name."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    def constants(self, known: Mapping[str, float]) -> dict[str, float]:
        """Friction and inertia as the plant takes them.

        `known` holds `resistance` (ohm), `torque_constant` (N m/A) and `electric_constant`
        (V s/rad), which voltage and angle alone do not show: a meter does. Raises `DesignError` if
        they do not allow the gain that was found.
        """
        resistance, torque = known["resistance"], known["torque_constant"]
        found = self.values()
        damping = torque / found["gain"]
        friction = (damping - torque * known["electric_constant"]) / resistance
        if friction < 0:
            raise DesignError(
                f"a gain of {found['gain']:.4g} rad/s per V needs an electric_constant below "
                f"{1 / found['gain']:.4g} V s/rad, and robot.toml has "
                f"{known['electric_constant']:.4g}; measure it: turn the shaft, and divide the "
                "voltage between the open wires by the speed"
            )
        return {
            "viscous_friction": friction,
            "inertia": found["time_constant"] * damping / resistance,
            "coulomb_friction": found["friction_voltage"] * torque / resistance,
        }


@dataclass(frozen=True, eq=False)
class PredictionBand:
    """Lowest and highest count at each sample, shapes (n,), for all samples at once with 95 %."""

    low: Array
    high: Array

    def covers(self, count: Array) -> bool:
        """Whether all of a manoeuvre's counts lie inside."""
        return bool((self.low <= count).all() and (count <= self.high).all())

    @property
    def half_width(self) -> float:
        """Half of the largest distance between the two ends, in counts."""
        return float((self.high - self.low).max() / 2)


@dataclass(frozen=True)
class Validation:
    """How well the model foretells other data.

    `error` is the root mean square difference in counts, `share` that part of the counts'
    variation that the model explains.
    """

    error: float
    share: float


def _segments(data: MotorData, delay: float = 0.0) -> list[tuple[float, float, float, Array]]:
    """(begin, end, voltage, samples within) of each stretch of constant voltage."""
    changes = data.change + delay
    ends = np.append(changes[1:], data.time[-1] + 1e-9)
    found = []
    for begin, end, voltage in zip(changes, ends, data.voltage, strict=True):
        if end > begin:
            first, last = np.searchsorted(data.time, (begin, end))
            found.append((float(begin), float(end), float(voltage), data.time[first:last]))
    return found


def _angles(segments: list[tuple[float, float, float, Array]], values: Array) -> Array:
    """Angles (rad) at all samples after the first change; exact between changes."""
    gain, tau, friction = (float(value) for value in values[:3])
    angle = speed = 0.0
    parts: list[Array] = []
    for begin, end, voltage, times in segments:
        now, waiting = begin, times
        while now < end:
            angle, speed, now, waiting = _piece(
                (gain, tau, friction, voltage), (angle, speed, now), end, waiting, parts
            )
    return np.concatenate(parts)


def _piece(
    model: tuple[float, float, float, float],
    state: tuple[float, float, float],
    end: float,
    waiting: Array,
    parts: list[Array],
) -> tuple[float, float, float, Array]:
    """Move on to `end` or to where the shaft stops; the samples on the way go into `parts`."""
    gain, tau, friction, voltage = model
    angle, speed, now = state
    direction = math.copysign(1.0, speed if speed else voltage)
    if speed == 0.0 and abs(voltage) <= friction:
        parts.append(np.full(len(waiting), angle))
        return angle, 0.0, end, waiting[:0]
    final = gain * (voltage - friction * direction)
    until = end
    if speed * final < 0:
        until = min(end, now + tau * math.log1p(-speed / final))
    inside = int(np.searchsorted(waiting, until)) if until < end else len(waiting)
    after = waiting[:inside] - now
    decay = np.exp(-after / tau)
    parts.append(angle + final * after + (speed - final) * tau * (1 - decay))
    span = until - now
    last = math.exp(-span / tau)
    angle += final * span + (speed - final) * tau * (1 - last)
    speed = 0.0 if until < end else final + (speed - final) * last
    return angle, speed, until, waiting[inside:]


def simulate_counts(
    data: MotorData, parameters: Mapping[str, float], phase: float = 0.0, delay: float = 0.0
) -> Array:
    """Counts (not rounded) of a motor with these parameters under the data's voltages."""
    values = np.array([parameters[name] for name in NAMES])
    per_radian = Encoder().counts_per_turn / math.tau
    angles = _angles(_segments(data, delay), values) * per_radian
    before = np.zeros(len(data.time) - len(angles))
    return np.concatenate([before, angles]) + phase


def predict_counts(motor: IdentifiedMotor, data: MotorData) -> PredictionBand:
    """The band of the counts under the data's voltages; of its counts, the first alone is used.

    Parameters and delay run through their joint confidence ellipsoid, each axis to both ends
    (Scheffe's band, which holds for all samples at once). The phase of the encoder is unknown in
    another run, the count is rounded, and what the fit left beyond the rounding counts twice: the
    parameters have taken up part of what the model lacks in the record, and the other manoeuvre
    has its own.
    """
    values = np.array([*motor.values().values(), motor.delay])

    def simulated(at: Array) -> Array:
        within = np.clip(at, [*_LOWEST, -_LONGEST_DELAY], [*_HIGHEST, _LONGEST_DELAY])
        parameters = dict(zip(NAMES, map(float, within), strict=False))
        return simulate_counts(data, parameters, delay=float(within[-1]))

    middle = simulated(values)
    square = np.zeros(len(middle))
    for axis in motor.axes.T:
        ends = [np.abs(simulated(values + sign * axis) - middle) for sign in (-1.0, 1.0)]
        square += np.maximum(*ends) ** 2
    left = max(motor.largest_error - 0.5, 0.0)
    half = np.sqrt(square) + 1.0 + 2.0 * left
    middle += float(data.count[0])
    return PredictionBand(middle - half, middle + half)


def fit_motor(data: MotorData) -> IdentifiedMotor:
    """Least squares of simulated against counted angles; intervals as `Interval95` says.

    The covariance allows for residuals that depend on their neighbours, as those of an encoder do
    (Newey and West, Econometrica 55, 1987). Raises `DesignError` if the motor hardly turned or if
    the experiment does not tell the parameters apart.
    """
    first = int(np.searchsorted(data.time, data.change[0] - _LONGEST_DELAY))
    counted = data.count[first:] - data.count[0] + 0.5
    if np.ptp(counted) < _LEAST_TURNS * Encoder().counts_per_turn:
        raise DesignError(
            f"the motor turned by {np.ptp(counted):.0f} degrees only; apply higher voltages"
        )
    per_radian = Encoder().counts_per_turn / math.tau

    def residuals(values: Array) -> Array:
        angles = _angles(_segments(data, float(values[4])), values) * per_radian
        before = np.zeros(len(counted) - len(angles))
        return np.asarray(np.concatenate([before, angles]) + values[3] - counted)

    low, high = [*_LOWEST, -1.0, -_LONGEST_DELAY], [*_HIGHEST, 1.0, _LONGEST_DELAY]

    def slopes(values: Array) -> Array:
        """With steps that do not shrink where a friction is 0."""
        here, steps = residuals(values), np.where(values + _STEPS > high, -_STEPS, _STEPS)
        moved = [residuals(values + step) - here for step in np.diag(steps)]
        return np.asarray(np.array(moved).T / steps)

    found = optimize.least_squares(
        residuals, [*_START, 0.0, 0.0], slopes, bounds=(low, high), x_scale=_SCALE
    )
    covariance = _covariance(np.asarray(found.jac), np.asarray(found.fun))
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    factor = math.sqrt(stats.chi2.ppf(0.95, len(found.x))) * _LAG_CORRECTION
    parameters = tuple(
        Interval95(name, unit, value, max(value - factor * s, 0.0), value + factor * s)
        for name, unit, value, s in zip(NAMES, _UNITS, map(float, found.x), spread, strict=False)
    )
    error = float(np.sqrt(np.mean(found.fun**2)))
    largest = float(np.abs(found.fun).max())
    axes = factor * _half_axes(covariance[np.ix_(_PREDICTING, _PREDICTING)])
    phase, delay = float(found.x[3]), float(found.x[4])
    return IdentifiedMotor(parameters, phase, delay, error, largest, axes)


def _half_axes(covariance: Array) -> Array:
    """Axes of the ellipsoid of one standard deviation, found with all parameters at one scale."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-30))
    squares, directions = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, np.newaxis] * directions * np.sqrt(np.maximum(squares, 0.0)))


def _covariance(jacobian: Array, residuals: Array) -> Array:
    """Covariance of everything that is fitted."""
    scale = np.linalg.norm(jacobian, axis=0)
    if not scale.all() or np.linalg.cond(jacobian / scale) > _WORST_CONDITION:
        raise DesignError(
            "the experiment does not tell gain, time constant and friction apart; let the voltage "
            "change between several levels, each held for some time constants"
        )
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    scores = jacobian * residuals[:, np.newaxis]
    lags = int(_LAG_SHARE * len(residuals))
    middle = scores.T @ scores
    for lag in range(1, lags + 1):
        part = scores[lag:].T @ scores[:-lag]
        middle += (1 - lag / (lags + 1)) * (part + part.T)
    return np.asarray(inverse @ middle @ inverse)


def validate_motor(motor: IdentifiedMotor, data: MotorData) -> Validation:
    """The identified model on data that it was not fitted to."""
    counted = data.count - data.count[0] + 0.5
    predicted = simulate_counts(data, motor.values())
    moving = slice(int(np.searchsorted(data.time, data.change[0])), None)
    difference = (predicted - counted)[moving]
    error = float(np.sqrt(np.mean(difference**2)))
    return Validation(error, 1 - float(np.var(difference) / np.var(counted[moving])))
