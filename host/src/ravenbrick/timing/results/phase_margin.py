# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a delay costs a loop: its phase margin, from the open loop of design.py."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.errors import DesignError
from ravenbrick.json_values import json_values
from ravenbrick.timing.chain import ChainDelay
from ravenbrick.timing.results.result import microseconds

__all__ = ["Loop", "margin_words", "margins_of", "phase_margin", "read_loop"]


@dataclass(frozen=True)
class Loop:
    """Gain crossovers of an open loop: rad/s and the phase above -180 degrees, from 0 to 360.

    `designed_delay` (s), from a sample to the output, is in these phases already.
    """

    crossovers: tuple[tuple[float, float], ...]
    designed_delay: float


def read_loop(design_file: Path) -> Loop | None:
    """The loop of a design; None when there is no design, or one without a sampled open loop.

    Raises `DesignError` for a file that is no design.
    """
    if not design_file.is_file():
        return None
    try:
        content = json_values(design_file.read_text("utf-8"))
        pairs = content["loop"]["crossovers"] if "loop" in content else ()
        found = tuple((float(frequency), float(phase)) for frequency, phase in pairs)
        delay = float(content["figures"].get("actuator_delay", 0.0))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise DesignError(
            f"{design_file}: not a design ({type(error).__name__}: {error}); run 'ravenbrick "
            "design' again"
        ) from None
    return Loop(found, delay) if found else None


def phase_margin(loop: Loop, delay: float) -> float:
    """Phase margin in degrees with another delay (s) than the designed: a delay turns the open
    loop's phase by its product with the crossover frequency and leaves the gain alone."""
    more = delay - loop.designed_delay
    return min(margin - math.degrees(frequency * more) for frequency, margin in loop.crossovers)


def margins_of(loop: Loop, chain: ChainDelay) -> dict[str, float | None]:
    """Phase margins in degrees: as designed, with the longest observed delay, with the bound."""

    def at(cycles: int | None) -> float | None:
        return None if cycles is None else phase_margin(loop, microseconds(cycles) / 1e6)

    return {
        "designed_deg": phase_margin(loop, loop.designed_delay),
        "seen_deg": at(chain.sample_max_cycles),
        "bound_deg": at(chain.sample_bound_cycles),
    }


def margin_words(margins: dict[str, Any]) -> str:
    """The margins in a line."""
    names = (("designed", "designed_deg"), ("with the longest observed delay", "seen_deg"))
    parts = [(text, margins[key]) for text, key in (*names, ("with the bound", "bound_deg"))]
    text = ", ".join(f"{value:.1f} degrees {what}" for what, value in parts if value is not None)
    lost = margins["bound_deg"] is not None and margins["bound_deg"] <= 0
    return f"phase margin: {text}" + ("; the loop may become unstable" if lost else "")
