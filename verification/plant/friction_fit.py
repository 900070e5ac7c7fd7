# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Least squares of friction and winding over the published points, in steady state.

`python -m verification.plant.friction_fit` prints the optimum beside the catalogue's `nxt_fitted`,
which has these values rounded. The friction is common to sets A and C, whose windings stay, and to
a third motor whose winding is fitted with it. The equations stand here a second time, apart from
the plant's: steady speeds are roots of the torques' balance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from ravenbrick.catalogue import part_values
from scipy.integrate import quad
from scipy.optimize import brentq, least_squares

Array = npt.NDArray[np.float64]
Winding = tuple[float, float, float]

NAMES = (
    "static_friction", "coulomb_friction", "stribeck_velocity", "viscous_friction", "gear_friction",
    "resistance", "torque_constant", "electric_constant",
)  # fmt: skip
LOWEST = (0.004, 0.0, 0.5, 0.0, 0.0, 4.2, 0.28, 0.46)
HIGHEST = (0.03, 0.01, 6.0, 1.5e-3, 0.4, 6.5, 0.38, 0.53)
# Resistance, torque constant, electric constant; C's inertia for its time constant.
SET_A: Winding = (5.262773292, 0.3233728703, 0.4952900056)
SET_C: Winding = (5.516, 0.3408, 0.4870)
INERTIA_C = 0.00307
RPM, DEGREE = math.pi / 30, math.pi / 180
# Volts, load (N m), published speed (rad/s), share that it is trusted to.
SPEEDS = (
    (9.0, 0.0, 170 * RPM, 0.015), (9.0, 0.167, 117 * RPM, 0.02), (8.16, 0.0, 900 * DEGREE, 0.05),
    (8.16, 0.080, 850 * DEGREE, 0.05), (8.16, 0.201, 525 * DEGREE, 0.05),
    (8.16, 0.402, 50 * DEGREE, 1.0),
)  # fmt: skip
# Volts, load, published current (A), share.
CURRENTS = ((9.0, 0.0, 0.06, 0.1), (9.0, 0.167, 0.55, 0.02))
# Volts, published torque at stall (N m), share.
STALLS = ((9.0, 0.50, 0.1), (8.16, 0.43, 0.07))
WORST = 5.0


def friction(values: Array, speed: float, torque: float) -> float:
    """Torque (N m) that is lost at a speed (rad/s) with this torque in the gear train."""
    at_rest, coulomb, stribeck, viscous, gear = values[:5]
    excess = at_rest - coulomb + gear * torque
    return float(coulomb + excess * math.exp(-speed / stribeck) + viscous * speed)


def steady(values: Array, winding: Winding, volts: float, load: float) -> tuple[float, float]:
    """Highest steady speed (rad/s) and its current (A); at rest, if no motion is steady."""
    resistance, torque, electric = winding

    def excess(speed: float) -> float:
        driving = torque * (volts - electric * speed) / resistance
        return driving - load - friction(values, speed, driving)

    grid = np.linspace(volts / electric, 1e-6, 200)
    signs = np.array([excess(speed) for speed in grid]) > 0
    if not signs.any():
        return 0.0, volts / resistance
    first = int(np.argmax(signs))
    speed = float(brentq(excess, grid[first], grid[first - 1]))
    return speed, (volts - electric * speed) / resistance


def turning_share(values: Array, winding: Winding, volts: float, load: float) -> float:
    """Duty cycle from which the motor turns behind the brick's bridge."""
    bridge = part_values("motors", "nxt_fitted")
    current = (load + values[0]) / (1 - values[4]) / winding[1]
    resistance = winding[0] + bridge["driver_resistance"]
    return float((current * resistance + bridge["driver_drop"]) / volts)


def time_constant(values: Array, winding: Winding, inertia: float) -> float:
    """Time (s) from rest on 9 V to 1 - 1/e of the final speed, without inductance."""
    resistance, torque, electric = winding

    def slowness(speed: float) -> float:
        driving = torque * (9.0 - electric * speed) / resistance
        return inertia / (driving - friction(values, speed, driving))

    return float(quad(slowness, 0.0, steady(values, winding, 9.0, 0.0)[0] * (1 - math.exp(-1)))[0])


def residuals(values: Array) -> Array:
    """Differences in units of what a point is trusted to; none counts more than `WORST`."""
    found: list[float] = []
    fitted: Winding = (float(values[5]), float(values[6]), float(values[7]))
    for winding in (fitted, SET_A, SET_C):
        for volts, load, speed, share in SPEEDS:
            found.append((steady(values, winding, volts, load)[0] / speed - 1) / share)
        for volts, load, current, share in CURRENTS:
            found.append((steady(values, winding, volts, load)[1] / current - 1) / share)
        for volts, torque, share in STALLS:
            most = winding[1] * volts / winding[0] * (1 - values[4]) - values[0]
            found.append((most / torque - 1) / share)
        # Philo's motor turned from about 40 %, Muntoo's, without load, from 5 % or less.
        found.append((turning_share(values, winding, 9.0, 0.115) - 0.40) / 0.05)
        found.append(max(0.0, turning_share(values, winding, 8.0, 0.0) - 0.046) / 0.002)
    # The published inertias end at 105 ms; half a millisecond is left for the inductance.
    found.append(max(0.0, time_constant(values, SET_C, INERTIA_C) - 0.1045) / 2e-4)
    return np.clip(found, -WORST, WORST)


def catalogue() -> Array:
    """The constants of `nxt_fitted`."""
    constants = part_values("motors", "nxt_fitted")
    return np.array([constants[name] for name in NAMES])


def optimum(start: Sequence[float] | Array) -> Array:
    """The values with the least sum of squares near `start`."""
    inside = np.clip(start, np.array(LOWEST) + 1e-9, np.array(HIGHEST) - 1e-9)
    scale = np.array([0.015, 5e-4, 5.0, 1e-3, 0.14, 5.5, 0.33, 0.49])
    found = least_squares(
        residuals, inside, bounds=(LOWEST, HIGHEST), x_scale=scale, diff_step=1e-3, max_nfev=60
    )
    return np.asarray(found.x)


def cost(values: Array) -> float:
    """Sum of squares."""
    return float(np.sum(residuals(values) ** 2))


def main() -> None:
    """Print both."""
    own = catalogue()
    best = optimum(own)
    for name, rounded, value in zip(NAMES, own, best, strict=True):
        print(f"{name:20} {rounded:10.5g} {value:10.5g}")
    print(f"{'sum of squares':20} {cost(own):10.5g} {cost(best):10.5g}")


if __name__ == "__main__":
    main()
