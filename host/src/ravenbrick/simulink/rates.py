# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sample times of blocks, stated or inherited."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from functools import reduce

from ravenbrick.simulink.matlab.linear_systems import is_lti, lti_rate
from ravenbrick.simulink.network import Network, Site

__all__ = ["base_rate", "block_rates", "own_rate"]


def own_rate(site: Site) -> float | None:
    """The sample time that a block gives itself, in s; None if it inherits it."""
    if is_lti(site.block.parameters.get("SourceBlock", "")):
        return lti_rate(site.block.parameters.get("sys", "1"), site.variables)
    noise = site.block.parameters.get("SourceBlock", "").endswith("White Noise")
    text = (
        site.block.parameters.get("Ts" if noise else "SampleTime", "-1")
        .strip()
        .strip("[]")
        .replace(",", " ")
    )
    first = text.split()[0] if text.split() else "-1"
    if site.kind == "Constant" or first in ("-1", "0", "inf", "Inf"):
        return None
    found = site.variables.sure(first)
    if found is None or found.size != 1:
        return None
    value = float(found[0, 0])
    return value if value > 0 and math.isfinite(value) else None


def block_rates(network: Network, sample_time: float) -> Mapping[str, float]:
    """The sample time of each block: its own, else the shortest of its inputs'."""
    rates: dict[str, float] = {}
    free: list[tuple[str, list[str]]] = []
    for path, site in network.sites.items():
        own = own_rate(site)
        if own is not None:
            rates[path] = own
            continue
        ends = (network.source(path, port) for port in range(1, network.inputs(path) + 1))
        sources = [end[0] for end in ends if end is not None]
        if site.kind == "Inport" and not site.system:
            rates[path] = sample_time
        else:
            free.append((path, sources))
    for _ in range(len(free)):
        changed = False
        for path, sources in free:
            known = [rates[source] for source in sources if source in rates]
            if known and rates.get(path, math.inf) > min(known):
                rates[path] = min(known)
                changed = True
        if not changed:
            break
    return rates


def base_rate(network: Network, given: float) -> float | None:
    """The longest time of which all sample times are multiples; None if nothing is sampled."""
    sites = (site for site in network.sites.values() if not site.commented)
    rates = {rate for site in sites if (rate := own_rate(site)) is not None}
    rates |= {given} if given > 0 else set()
    if not rates:
        return None
    exact = [Fraction(f"{rate:.9g}") for rate in rates]

    def common(one: Fraction, two: Fraction) -> Fraction:
        return Fraction(
            math.gcd(one.numerator * two.denominator, two.numerator * one.denominator),
            one.denominator * two.denominator,
        )

    return float(reduce(common, exact))
