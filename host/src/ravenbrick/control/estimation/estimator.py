# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""PI gains that meet the specification with the speed estimator and the delay in the loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from ravenbrick.control.analysis.sampled import SampledLoop
from ravenbrick.control.synthesis.tuning import DiscretePi, pi_direct
from ravenbrick.errors import DesignError
from ravenbrick.model import IntegrationMethod, SpeedLoop
from ravenbrick.model.lazy import optimize

__all__ = ["LoopSpecification", "pi_with_estimator"]

_LEAST_SHARE = 0.2
_SCANS = (16, 256)


@dataclass(frozen=True)
class LoopSpecification:
    """What the loop must do and what is in it.

    `settling_time` in s (+-2 %), `overshoot` the largest allowed share, `sample_time` in s,
    `window` in samples (None: ideal speed), `delay` in s from sampling to the motor's new voltage.
    """

    settling_time: float
    overshoot: float
    sample_time: float
    window: int | None
    delay: float


def pi_with_estimator(
    loop: SpeedLoop,
    specification: LoopSpecification,
    method: IntegrationMethod = IntegrationMethod.FORWARD_EULER,
) -> DiscretePi:
    """Gains such that the true speed settles in exactly the specified time.

    The controller's zero stays on the sampled plant's pole; window and delay only slow the loop's
    integrator down, so one gain is left, found by root finding on the exact settling time. Raises
    `DesignError` if the overshoot is larger than specified.
    """
    wanted = specification.settling_time
    sample_time = specification.sample_time
    start = pi_direct(loop, wanted, sample_time, method)
    b0, b1 = start.coefficients

    def scaled(share: float) -> DiscretePi:
        return DiscretePi.from_coefficients(share * b0, share * b1, sample_time, method)

    def sampled(share: float) -> SampledLoop:
        controller = scaled(share).system()
        return SampledLoop(loop, controller, specification.window, specification.delay)

    def excess(share: float) -> float:
        return sampled(share).settling_time() - wanted

    share = _first_root(excess, wanted)
    metrics = sampled(share).step_metrics()
    if metrics.overshoot > specification.overshoot:
        raise DesignError(
            f"a settling time of {wanted} s with a window of {specification.window} samples and a "
            f"delay of {specification.delay} s costs {metrics.overshoot:.2%} overshoot; at most "
            f"{specification.overshoot:.2%} is allowed: shorten the window or allow more time"
        )
    return scaled(share)


def _first_root(excess: Callable[[float], float], wanted: float) -> float:
    """The smallest share of the gain that meets the time: from slow to fast.

    Near the fastest response the time is met between two close gains only, as the overshoot soon
    leaves the band; a second, finer scan finds them.
    """
    if excess(_LEAST_SHARE) <= 0:
        raise DesignError(f"the loop settles faster than {wanted} s even with a very low gain")
    for steps in _SCANS:
        ratio = (1.05 / _LEAST_SHARE) ** (1 / steps)
        left = _LEAST_SHARE
        for _ in range(steps):
            right = left * ratio
            if excess(right) <= 0:
                share = float(optimize.brentq(excess, left, right, xtol=1e-12))
                if math.isclose(excess(share), 0.0, abs_tol=1e-6):
                    return share
            left = right
    raise DesignError(f"no gain lets the loop settle in exactly {wanted} s; allow more time")
