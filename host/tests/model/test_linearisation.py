# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The linear system of a program in fixed point, with an input for each rounding, by hand."""

from __future__ import annotations

from ravenbrick.model import FixedFormat, Rounding
from ravenbrick.model.linearisation import ErrorSource, linearise_with_errors
from ravenbrick.model.program import Binary, Kind, Literal, Program, Read, Rescale, Slot, Statement

FORMAT = FixedFormat(32, 4)


def rounded(slot: Slot, factor: int, bits: int) -> Rescale:
    """The variable times factor / 2**bits, in the same format, to the nearest."""
    product = Binary("*", Read(slot), Literal(factor, FixedFormat(16, bits)))
    return Rescale(product, bits, Rounding.NEAREST)


def test_every_rounding_is_an_input_where_it_enters() -> None:
    """y = x + 3/4 u + v + 5 + e0, then x = 1/2 x + u + e1, and what rounding the state would cost.

    All in raw units, of which one stands for 1/16; the last input is the constant 1.
    """
    u = Slot(Kind.INPUT, "In", FORMAT, "In")
    v = Slot(Kind.INPUT, "Other", FORMAT, "Other")
    y = Slot(Kind.OUTPUT, "Out", FORMAT, "Out")
    x = Slot(Kind.STATE, "Lag_DSTATE", FORMAT, "Lag")
    offset = Slot(Kind.PARAMETER, "offset", FORMAT, "Sum", initial=5)
    sum_ = Binary("+", Binary("+", Read(x), rounded(u, 3, 2)), Read(offset))
    statements = (
        Statement(y, Binary("+", sum_, Read(v)), "Sum", "Sum"),
        Statement(x, Binary("+", rounded(x, 1, 1), Read(u)), "Lag", "Lag"),
    )
    program = Program("made", 0.01, (u, v), (y,), (offset,), (x,), (), statements)
    system, sources = linearise_with_errors(program, constants=True)
    assert system.A.tolist() == [[0.5]]
    assert system.B.tolist() == [[1.0, 0.0, 0.0, 1.0, 1.0, 0.0]]
    assert system.C.tolist() == [[1.0]]
    assert system.D.tolist() == [[0.75, 1.0, 1.0, 0.0, 0.0, 5.0]]
    assert sources == (
        ErrorSource("Sum", "output", 1 / 16, 0.5, True),
        ErrorSource("Lag", "update", 1 / 16, 0.5, True),
        ErrorSource("Lag", "state", 1 / 16, 0.0, True),
    )
