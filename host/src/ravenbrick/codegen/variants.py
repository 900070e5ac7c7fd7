# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One controller in several number formats, so that a user can choose with the cost in sight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ravenbrick.codegen.proofs.fixed_point import prove
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, FixedPointOptions, Rounding, to_fixed_point
from ravenbrick.model.lazy import control
from ravenbrick.model.program import Program, with_constants

if TYPE_CHECKING:
    from ravenbrick.control import Design, PlantInLoop

__all__ = ["NumberChoice", "Variant", "number_variants"]

# Beyond what a loaded motor does to its speed, as a share of the battery's voltage.
_SPEED_RESERVE = 1.25


@dataclass(frozen=True)
class NumberChoice:
    """What fixed point needs to know besides the diagram; `plant` for the bound in the loop."""

    diagram: Diagram
    options: FixedPointOptions
    plant: PlantInLoop | None = None

    @classmethod
    def of_design(cls, design: Design) -> NumberChoice:
        """Ranges from the battery's voltage."""
        from ravenbrick.control import PlantInLoop  # slow to load

        supply = design.supply_voltage
        states = {slot.block: supply for slot in design.controller.lower().states}
        ranges = {"Input_Voltage": supply, "Real_Voltage": _SPEED_RESERVE * supply, **states}
        motor = control.ss(
            control.sample_system(design.loop.plant(), design.specification.sample_time, "zoh")
        )
        plant = PlantInLoop(motor, ("Real_Voltage",), 1.0, "V")
        options = FixedPointOptions(ranges, rounding=Rounding.NEAREST)
        return cls(design.controller, options, plant)


@dataclass(frozen=True)
class Variant:
    """A program under a C name; `bound` of the error in the loop for all time, `unit` its unit."""

    name: str
    title: str
    program: Program
    bound: float | None = None
    unit: str = ""


def number_variants(choice: NumberChoice) -> tuple[Variant, ...]:
    """Single precision, and fixed point with tunable and with constant gains.

    Raises `DesignError` if a block of the diagram has no fixed-point form.
    """
    single = choice.diagram.lower()
    fixed = to_fixed_point(choice.diagram, choice.options)
    bound, unit = None, ""
    if choice.plant is not None:
        loop = prove(fixed, choice.plant).closed_loop
        if loop is None or not math.isfinite(loop.total):
            raise DesignError("the fixed-point loop has no bound")
        bound, unit = loop.total, loop.unit
    constant = with_constants(fixed.program)
    return (
        Variant("single", "single precision, tunable", single),
        Variant("fixed", "fixed point, tunable", fixed.program, bound, unit),
        Variant("fixed_constant", "fixed point, constant gains", constant, bound, unit),
    )
