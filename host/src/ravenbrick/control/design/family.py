# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""All gains that a specification leaves open: by damping, by integrator, with and without delay."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ravenbrick.control.analysis.metrics import step_metrics
from ravenbrick.control.analysis.sampled import SampledLoop
from ravenbrick.control.estimation.estimator import LoopSpecification, pi_with_estimator
from ravenbrick.control.synthesis.tuning import PiGains, pi_by_damping, pi_by_lambda, pi_direct
from ravenbrick.model import IntegrationMethod, SpeedLoop

__all__ = ["FamilyMember", "gain_family"]

DAMPINGS = (0.9, 1.0, 1.1, 1.2)


@dataclass(frozen=True)
class FamilyMember:
    """Gains that settle in the specified time, `where`: in which loop they do.

    `settling_time` (s) and `overshoot` (share) are those of that loop.
    """

    design: str
    where: str
    gains: PiGains
    settling_time: float
    overshoot: float

    def row(self) -> dict[str, float | str]:
        """Plain values by name."""
        return {
            "design": self.design,
            "where": self.where,
            "proportional_gain": self.gains.proportional,
            "integral_gain": self.gains.integral,
            "settling_time": self.settling_time,
            "overshoot": self.overshoot,
        }


def gain_family(
    loop: SpeedLoop,
    wanted: LoopSpecification,
    dampings: tuple[float, ...] = DAMPINGS,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[FamilyMember, ...]:
    """Members in continuous time, then for each integrator without and with the loop's delay.

    A damping that needs a negative gain has no member.
    """
    damped = {one: pi_by_damping(loop, one, wanted.settling_time) for one in dampings}
    # With a negative gain the loop settles in time, but first goes the wrong way.
    damped = {one: pi for one, pi in damped.items() if min(pi.proportional, pi.integral) >= 0}
    count = 1 + len(damped) + 2 * len(IntegrationMethod)
    found: list[FamilyMember] = []

    def add(member: FamilyMember) -> None:
        found.append(member)
        if progress is not None:
            progress(len(found), count)

    add(_continuous(loop, "lambda", pi_by_lambda(loop, wanted.settling_time)))
    for damping, gains in damped.items():
        add(_continuous(loop, f"damping {damping:g}", gains))
    for method in IntegrationMethod:
        name = method.name.lower().replace("_", " ")
        direct = pi_direct(loop, wanted.settling_time, wanted.sample_time, method)
        ideal = SampledLoop(loop, direct.system()).step_metrics()
        sampled = "sampled, ideal speed"
        add(FamilyMember(name, sampled, direct.gains, ideal.settling_time, ideal.overshoot))
        own = pi_with_estimator(loop, wanted, method)
        real = SampledLoop(loop, own.system(), wanted.window, wanted.delay).step_metrics()
        inside = "sampled, with estimator and delay"
        add(FamilyMember(name, inside, own.gains, real.settling_time, real.overshoot))
    return tuple(found)


def _continuous(loop: SpeedLoop, name: str, gains: PiGains) -> FamilyMember:
    metrics = step_metrics(gains.closed_loop(loop))
    return FamilyMember(name, "continuous", gains, metrics.settling_time, metrics.overshoot)
