# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A script for the proof assistant Gappa: the one-step rounding error of a fixed-point program."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping
from fractions import Fraction

from ravenbrick.errors import DesignError, ToolMissingError
from ravenbrick.model import program as ir
from ravenbrick.model.fixed_point import FixedPoint
from ravenbrick.model.flattening import flattened
from ravenbrick.model.linearisation import fraction_of
from ravenbrick.model.number_format import FixedFormat, Rounding

__all__ = ["NO_GOAL", "check_with_gappa", "gappa_script"]

NO_GOAL = (
    "no outport has a bound for the error of one step, because a block before it decides or "
    "rounds; there is no goal for Gappa"
)

_TIMEOUT_SECONDS = 120
_DIRECTIONS = {Rounding.ZERO: "zr", Rounding.NEAREST: "nu"}


def gappa_script(fixed: FixedPoint, bounds: Mapping[str, float]) -> str:
    """Goals |fixed-point - real-number| <= bound for the outports in `bounds`.

    Limits are left out on both sides: limiting both values does not let their difference grow.
    Raises `DesignError` if there is no bound, so nothing to prove.
    """
    if not bounds:
        raise DesignError(f"diagram '{fixed.program.name}': {NO_GOAL}")
    return _Script(fixed, bounds).text(bounds)


def check_with_gappa(script: str) -> None:
    """Let Gappa prove the script; raises `DesignError` with its words if it cannot.

    Raises `ToolMissingError` if Gappa is not installed.
    """
    program = shutil.which("gappa")
    if program is None:
        raise ToolMissingError("gappa is not installed; on Debian: apt-get install gappa")
    done = subprocess.run(
        [program], input=script, capture_output=True, text=True, timeout=_TIMEOUT_SECONDS
    )
    if done.returncode != 0:
        raise DesignError("gappa cannot prove the one-step bound", detail=done.stderr)


class _Script:
    def __init__(self, fixed: FixedPoint, bounds: Mapping[str, float]) -> None:
        self._fixed = fixed
        self._goals = set(bounds)
        self._block = ""
        self._real = {slot.name: slot.initial for slot in fixed.source.parameters}
        self._needed = self._reachable()

    def _reachable(self) -> set[tuple[ir.Kind, str]]:
        """What the outputs depend on in this step."""
        program = flattened(self._fixed.program)
        needed = {(s.kind, s.name) for s in program.outputs if s.name in self._goals}
        for statement in reversed(list(ir.statements(program.statements))):
            if statement.target.kind is ir.Kind.STATE:
                continue
            if (statement.target.kind, statement.target.name) in needed:
                for node in ir.nodes(statement.expression):
                    if isinstance(node, ir.Read):
                        needed.add((node.slot.kind, node.slot.name))
        return needed

    def text(self, bounds: Mapping[str, float]) -> str:
        """The whole script."""
        program = flattened(self._fixed.program)
        lines = [
            "# SPDX-FileCopyrightText: 2026 Ravenbrick contributors",
            "# SPDX-License-Identifier: Apache-2.0",
            f"# One-step rounding error of '{program.name}'; _g given,",
            "# _f as the C computes it, _r in real numbers.",
        ]
        for statement in ir.statements(program.statements):
            target = statement.target
            if target.kind is ir.Kind.STATE or (target.kind, target.name) not in self._needed:
                continue
            self._block = statement.block
            lines.append(f"{target.name}_f = {self._fixed_text(statement.expression)};")
            lines.append(f"{target.name}_r = {self._real_text(statement.expression)};")
        givens = []
        for slot in program.inputs + program.states:
            if (slot.kind, slot.name) in self._needed:
                interval = self._fixed.ranges[slot.kind, slot.name]
                assert isinstance(slot.data_type, FixedFormat)
                ends = f"[{_decimal(interval.low)}, {_decimal(interval.high)}]"
                givens.append(f"{slot.name}_g in {ends}")
                givens.append(f"@FIX({slot.name}_g, {-slot.data_type.fraction})")
        goals = [
            f"|{name}_f - {name}_r| in [0, {_decimal(bound)}]" for name, bound in bounds.items()
        ]
        separator = " /\\\n  "
        lines.append(f"{{ {separator.join(givens)} ->\n  {separator.join(goals)} }}")
        return "\n".join(lines) + "\n"

    def _variable(self, slot: ir.Slot, suffix: str) -> str:
        given = slot.kind in (ir.Kind.INPUT, ir.Kind.STATE)
        return f"{slot.name}_g" if given else f"{slot.name}{suffix}"

    def _fixed_text(self, expression: ir.Expression) -> str:
        match expression:
            case ir.Read(slot=slot) if slot.kind is ir.Kind.PARAMETER:
                return f"{int(slot.initial)}b{-fraction_of(expression)}"
            case ir.Read(slot=slot):
                return self._variable(slot, "_f")
            case ir.Literal(value=value):
                return f"{int(value)}b{-fraction_of(expression)}"
            case ir.Binary(operator=operator, left=left, right=right):
                if _is_one(right):
                    return self._fixed_text(left)
                return f"({self._fixed_text(left)} {operator} {self._fixed_text(right)})"
            case ir.Rescale(value=value, rounding=rounding):
                fraction = -fraction_of(expression)
                form = f"fixed<{fraction}, {_DIRECTIONS[rounding]}>"
                return f"{form}({self._fixed_text(value)})"
            case _:
                return self._fixed_text(ir.children(expression)[0])

    def _real_text(self, expression: ir.Expression) -> str:
        match expression:
            case ir.Read(slot=slot) if slot.kind is ir.Kind.PARAMETER:
                return _decimal(self._real[slot.name])
            case ir.Read(slot=slot):
                return self._variable(slot, "_r")
            case ir.Literal(value=value, data_type=form):
                assert isinstance(form, FixedFormat)
                own = form.real(int(value))
                return _decimal(self._fixed.constants.get((self._block, expression), own))
            case ir.Binary(operator=operator, left=left, right=right):
                if _is_one(right):
                    return self._real_text(left)
                return f"({self._real_text(left)} {operator} {self._real_text(right)})"
            case _:
                return self._real_text(ir.children(expression)[0])


def _is_one(expression: ir.Expression) -> bool:
    """Whether the expression only shifts: the literal 1 with fractional bits."""
    return isinstance(expression, ir.Literal) and (
        expression.value == 1 << max(fraction_of(expression), 0)
    )


def _decimal(value: float) -> str:
    """The exact value: mantissa and power of two."""
    fraction = Fraction(value)
    return f"{fraction.numerator}b{-(fraction.denominator.bit_length() - 1)}"
