# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program in fixed point: formats from ranges, exact accumulators, proved free of overflow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram
from ravenbrick.model.fidelity import fixed_point_errors
from ravenbrick.model.fixed_point.rewriting import FixedPointOptions, Rewriting, TooFineError
from ravenbrick.model.fixed_point.wide import WideRewriting
from ravenbrick.model.integer_ranges import Key, expression_range, integer_ranges
from ravenbrick.model.number_format import FixedFormat, Interval
from ravenbrick.model.ranges import real_ranges

__all__ = ["FixedPoint", "FixedPointOptions", "to_fixed_point"]

_FINEST, _COARSEST = 30, 4
_MOST_HEADROOM = 10


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """A fixed-point `program`, the `source` it computes, and what was found out on the way.

    `raw_ranges` bounds every variable for all 16-bit inputs, in raw units; no intermediate result
    exceeds the accumulator. `ranges` are those of the source for the declared inputs; `constants`
    gives the value that a literal of a block was rounded from.
    """

    program: ir.Program
    source: ir.Program
    options: FixedPointOptions
    ranges: Mapping[Key, Interval]
    raw_ranges: Mapping[Key, Interval]
    constants: Mapping[tuple[str, ir.Literal], float]

    def format(self, kind: ir.Kind, name: str) -> FixedFormat:
        """The format of a variable."""
        program = self.program
        slots = program.inputs + program.outputs + program.parameters + program.states
        for slot in slots + program.signals:
            if (slot.kind, slot.name) == (kind, name):
                assert isinstance(slot.data_type, FixedFormat)
                return slot.data_type
        raise KeyError(f"no {kind.value} '{name}'")


def to_fixed_point(diagram: Diagram | ir.Program, options: FixedPointOptions) -> FixedPoint:
    """Choose formats, rewrite the program with integers, prove that nothing overflows.

    Inputs, outputs and gains have 16 bits, sums and states 32, and the accumulator is as fine as
    the widest sum allows; or, where that is not enough, gains and states have 32 bits with
    fractions of their own, and sums 64. Both for every value that the 16-bit inputs can have.
    Raises `DesignError` that names the block without a range or without a fixed-point form.
    """
    source = diagram.lower() if isinstance(diagram, Diagram) else diagram
    known = {slot.block for slot in source.inputs + source.states}
    named = {slot.name for slot in source.states}
    for name in options.ranges:
        if name not in known | named:
            raise DesignError(
                f"a range is given for '{name}', which is not an Inport and has no state; "
                f"there are: {', '.join(sorted(known))}"
            )
    ranges = real_ranges(source, options.intervals())
    attempts = {32: _narrow_form, 64: _wide_form}
    if options.accumulator_bits is not None:
        if options.accumulator_bits not in attempts:
            raise DesignError(f"an accumulator has 32 or 64 bits, not {options.accumulator_bits}")
        attempts = {options.accumulator_bits: attempts[options.accumulator_bits]}
    refused: DesignError | None = None
    for attempt in attempts.values():
        try:
            return _checked(attempt(source, options, ranges), options.tolerance)
        except DesignError as error:
            refused = refused or error
    assert refused is not None
    raise refused


def _checked(fixed: FixedPoint, tolerance: float | None) -> FixedPoint:
    """Refused where the gains as held change a block's frequency response by more."""
    if tolerance is None:
        return fixed
    for block, error in fixed_point_errors(fixed.source, fixed.program).items():
        if not error <= tolerance:
            raise DesignError(
                f"block '{block}': its numbers as held change its frequency response by "
                f"{100 * error:.3g} % (allowed: {100 * tolerance:.3g} %); use accumulators of 64 "
                "bits, or another form"
            )
    return fixed


def _narrow_form(
    source: ir.Program, options: FixedPointOptions, ranges: Mapping[Key, Interval]
) -> FixedPoint:
    reason = ""
    for fraction in range(_FINEST, _COARSEST - 1, -1):
        try:
            return _rewritten(Rewriting(source, options, ranges, fraction), source, options, ranges)
        except (TooFineError, OverflowError) as error:
            reason = str(error)
    raise DesignError(
        f"diagram '{source.name}': no accumulator of 32 bits holds all sums ({reason}); "
        "lower the ranges or the gains"
    )


def _wide_form(
    source: ir.Program, options: FixedPointOptions, ranges: Mapping[Key, Interval]
) -> FixedPoint:
    reason = ""
    for headroom in range(_MOST_HEADROOM + 1):
        try:
            rewriting = WideRewriting(source, options, ranges, headroom)
            return _rewritten(rewriting, source, options, ranges)
        except (TooFineError, OverflowError) as error:
            reason = str(error)
    raise DesignError(
        f"diagram '{source.name}': no accumulator of 64 bits holds all sums ({reason}); "
        "lower the ranges or the gains"
    )


def _rewritten(
    rewriting: Rewriting,
    source: ir.Program,
    options: FixedPointOptions,
    ranges: Mapping[Key, Interval],
) -> FixedPoint:
    program = rewriting.program()
    raw_ranges = integer_ranges(program)
    program = _without_idle_limits(program, raw_ranges)
    return FixedPoint(program, source, options, ranges, raw_ranges, rewriting.constants)


def _without_idle_limits(program: ir.Program, ranges: Mapping[Key, Interval]) -> ir.Program:
    """Leave out limits that no value reaches; beside one that is reached stands the range's."""

    def without(expression: ir.Expression) -> ir.Expression:
        if not isinstance(expression, ir.Bounded):
            return expression
        allowed = Interval(expression.low, expression.high)
        reached = expression_range(expression.value, ranges, program.name)
        if reached.within(allowed):
            return expression.value
        low, high = int(reached.low), int(reached.high)
        return replace(expression, low=max(expression.low, low), high=min(expression.high, high))

    return replace(program, statements=ir.mapped(program.statements, without))
