# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sine, cosine, arc tangent and square root of a signal without a C library."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import Assignments, Block, Inputs

__all__ = ["ArcTangent", "SquareRoot", "Trigonometry", "sine_of_turns"]

_DEGREES = {ir.DataType.REAL32: 11, ir.DataType.REAL64: 21}
_MOST_ROUNDS = 160
_ROOT_C = """\
{real} x = (a > 1.0{f}) ? a : 1.0{f};
uint32_T round;
for (round = 0U; round < {rounds}U; round++) {{
  const {real} next = 0.5{f} * (x + (a / x));
  if (next >= x) {{
    break;
  }}
  x = next;
}}
return (a > 0.0{f}) ? x : 0.0{f};"""
_ROOT_ADA = """\
declare
   X : {real} := (if A > 1.0 then A else 1.0);
begin
   for Round in 1 .. {rounds} loop
      declare
         Next : constant {real} := 0.5 * (X + A / X);
      begin
         exit when Next >= X;
         X := Next;
      end;
   end loop;
   return (if A > 0.0 then X else 0.0);
end;"""


def _coefficient(power: int) -> float:
    sign = -1.0 if power % 4 == 3 else 1.0
    return sign * math.tau**power / math.factorial(power)


def sine_of_turns(
    block: Block, angle: ir.Expression, square: ir.Expression, sign: float = 1.0
) -> ir.Expression:
    """`sign` sin(2 pi angle) by Horner's rule, `angle` within a quarter turn, with its square.

    A Taylor polynomial of degree 11 (error below 3e-7) or 21 (below 1e-15).
    """
    degree = _DEGREES[block.data_type]
    total = block._literal(sign * _coefficient(degree))
    for power in range(degree - 2, 0, -2):
        total = ir.Binary(
            "+", block._literal(sign * _coefficient(power)), ir.Binary("*", square, total)
        )
    return ir.Binary("*", angle, total)


@dataclass(frozen=True)
class Trigonometry(Block):
    """The sine ("sin") or cosine ("cos") of an angle in rad.

    The angle is reduced to one turn first, so that its rounding counts: the error is below
    6e-7 (single precision) for angles within one turn and grows with their size.
    """

    function: str = "sin"

    def __post_init__(self) -> None:
        if self.function not in ("sin", "cos"):
            raise ValueError(
                f"block '{self.name}': the function must be sin or cos, not '{self.function}'"
            )

    def intermediates(self, inputs: Inputs) -> Assignments:
        """Turns, the part within half a turn, folded into a quarter, and the square."""
        names = ("turns", "part", "angle", "square")
        turns, part, angle, square = (self._local(name) for name in names)
        scaled: ir.Expression = ir.Binary("*", self._literal(1 / math.tau), inputs[0])
        if self.function == "cos":
            scaled = ir.Binary("+", scaled, self._literal(0.25))
        value, quarter, half = ir.Read(part), self._literal(0.25), self._literal(0.5)
        low = ir.Select(
            ir.Comparison("<", value, self._literal(-0.25)),
            ir.Binary("-", self._literal(-0.5), value),
            value,
        )
        folded = ir.Select(ir.Comparison(">", value, quarter), ir.Binary("-", half, value), low)
        return (
            (turns, scaled),
            (part, ir.Binary("-", ir.Read(turns), ir.Rounded(ir.Read(turns)))),
            (angle, folded),
            (square, ir.Binary("*", ir.Read(angle), ir.Read(angle))),
        )

    def output(self, inputs: Inputs) -> ir.Expression:
        """The polynomial."""
        return sine_of_turns(self, ir.Read(self._local("angle")), ir.Read(self._local("square")))


@dataclass(frozen=True)
class SquareRoot(Block):
    """The square root by Newton's rule from above; 0 for what is not positive.

    The last place may be one off. The number of rounds grows with the distance from 1.
    """

    def output(self, inputs: Inputs) -> ir.Expression:
        """One call."""
        single = self.data_type is ir.DataType.REAL32
        words = {"real": self.data_type.value, "f": "F" if single else "", "rounds": _MOST_ROUNDS}
        ada = {**words, "real": "Float" if single else "Long_Float"}
        name = f"square_root_{32 if single else 64}"
        return ir.Call(name, ("a",), (inputs[0],), self.data_type, _ROOT_C.format(**words),
                    _ROOT_ADA.format(**ada), _root_function(self.data_type))  # fmt: skip


def _root_function(data_type: ir.DataType):  # type: ignore[no-untyped-def]
    real = data_type.scalar

    def root(a: np.floating) -> np.floating:
        x, half = max(a, real(1.0)), real(0.5)
        for _ in range(_MOST_ROUNDS):
            following = half * (x + a / x)
            if following >= x:
                break
            x = following
        return x if a > real(0.0) else real(0.0)

    return root


@dataclass(frozen=True)
class ArcTangent(Block):
    """The angle in rad of the point (input 1, input 0), as atan2(y, x); 0 at the origin.

    By a Taylor polynomial within 15 degrees; the error is below 3e-7 or 1e-15.
    """

    @property
    def input_types(self) -> tuple[ir.DataType, ...]:
        """y and x."""
        return (self.data_type,) * 2

    def _choose(
        self,
        left: ir.Expression,
        right: float | ir.Expression,
        yes: ir.Expression,
        no: ir.Expression,
    ) -> ir.Select:
        """`yes` where left > right."""
        other = self._literal(right) if isinstance(right, float) else right
        return ir.Select(ir.Comparison(">", left, other), yes, no)

    def _quotient(self, top: ir.Expression, bottom: ir.Expression) -> ir.Expression:
        name = f"quotient_{self.data_type.value.removesuffix('_T')}"
        return ir.Call(name, ("a", "b"), (top, bottom), self.data_type,
                    "return a / b;", "return A / B;", lambda a, b: a / b)  # fmt: skip

    def intermediates(self, inputs: Inputs) -> Assignments:
        """Sizes, their ratio within 0 and 1, the ratio within 15 degrees, and the angle in it."""
        height, width = inputs
        names = ("high", "wide", "ratio", "small", "square", "angle", "steep")
        high, wide, ratio, small, square, angle, steep = (self._local(name) for name in names)
        zero, one, root = self._literal(0.0), self._literal(1.0), self._literal(math.sqrt(3.0))
        swapped = self._quotient(ir.Read(wide), ir.Read(high))
        flat = self._quotient(ir.Read(high), self._choose(ir.Read(wide), 0.0, ir.Read(wide), one))
        turned = self._quotient(
            ir.Binary("-", ir.Binary("*", root, ir.Read(ratio)), one),
            ir.Binary("+", root, ir.Read(ratio)),
        )
        limit = math.tan(math.pi / 12)
        base = self._choose(ir.Read(ratio), limit, self._literal(math.pi / 6), zero)
        right = self._literal(math.pi / 2)
        steeper = ir.Binary("-", right, ir.Read(angle))
        return (
            (high, self._choose(height, 0.0, height, ir.Binary("-", zero, height))),
            (wide, self._choose(width, 0.0, width, ir.Binary("-", zero, width))),
            (ratio, self._choose(ir.Read(high), ir.Read(wide), swapped, flat)),
            (small, self._choose(ir.Read(ratio), limit, turned, ir.Read(ratio))),
            (square, ir.Binary("*", ir.Read(small), ir.Read(small))),
            (angle, ir.Binary("+", base, self._series(ir.Read(small), ir.Read(square)))),
            (steep, self._choose(ir.Read(high), ir.Read(wide), steeper, ir.Read(angle))),
        )

    def _series(self, value: ir.Expression, square: ir.Expression) -> ir.Expression:
        degree = _DEGREES[self.data_type]
        total = self._literal((-1.0) ** (degree // 2) / degree)
        for power in range(degree - 2, 0, -2):
            coefficient = self._literal((-1.0) ** (power // 2) / power)
            total = ir.Binary("+", coefficient, ir.Binary("*", square, total))
        return ir.Binary("*", value, total)

    def output(self, inputs: Inputs) -> ir.Expression:
        """Into the quadrant."""
        height, width = inputs
        zero, steep = self._literal(0.0), ir.Read(self._local("steep"))
        behind = ir.Binary("-", self._literal(math.pi), steep)
        upper = ir.Select(ir.Comparison("<", width, zero), behind, steep)
        return ir.Select(ir.Comparison("<", height, zero), ir.Binary("-", zero, upper), upper)
