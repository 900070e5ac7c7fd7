# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Elementary functions of signals, and the blocks that are one of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from ravenbrick.model import Abs, ArcTangent, Block, MinMax, RoundingFunction, Sign, SquareRoot
from ravenbrick.model import Trigonometry as Wave
from ravenbrick.model.blocks.continuous import SmoothFunction
from ravenbrick.simulink.blocks.functions import exponential, logarithm, power
from ravenbrick.simulink.builder import Builder, ContinuousForm
from ravenbrick.simulink.signals import Wire, plain

__all__ = ["ELEMENTARY", "ONE", "TWO", "root"]

OfOne = Callable[[Builder, Wire], Wire]
OfTwo = Callable[[Builder, Wire, Wire], Wire]


def _block(block: Block, name: str) -> OfOne:
    return lambda b, wire: b.add(block, wire, ending=f"_{name}")


def _smooth(block: Block, name: str, function: Callable[..., float]) -> Callable[..., Wire]:
    """The block; in continuous time the function itself, whose folds no solver has to find."""

    def make(b: Builder, *wires: Wire) -> Wire:
        solved = b.form is ContinuousForm.SOLVED
        own = SmoothFunction("B", function=function, ports=len(wires)) if solved else block
        return b.add(own, *wires, ending=f"_{name}")

    return make


def root(value: float) -> float:
    """Zero for what is not positive."""
    return math.sqrt(value) if value > 0.0 else 0.0


def _tangent(b: Builder, wire: Wire) -> Wire:
    return b.product(ONE["sin"](b, wire), ONE["cos"](b, wire), operators="*/")


def _inverse(name: str) -> OfOne:
    """asin or acos by the arc tangent."""

    def make(b: Builder, wire: Wire) -> Wire:
        inside = b.sum(b.constant(1.0), b.product(wire, wire), signs="+-")
        other = ONE["sqrt"](b, inside)
        return TWO["atan2"](b, *((wire, other) if name == "asin" else (other, wire)))

    return make


def _hyperbolic(sign: str) -> OfOne:
    """sinh or cosh: half the sum of exp(u) and its reciprocal, or half their difference."""

    def make(b: Builder, wire: Wire) -> Wire:
        high = exponential(b, wire)
        return b.scaled(0.5, b.sum(high, _reciprocal(b, high), signs=f"+{sign}"))

    return make


def _hyperbolic_tangent(b: Builder, wire: Wire) -> Wire:
    """1 - 2 / (exp(2 u) + 1), within 2e-7."""
    above = b.sum(exponential(b, b.scaled(2.0, wire)), b.constant(1.0))
    return b.sum(b.constant(1.0), b.scaled(2.0, _reciprocal(b, above)), signs="+-")


def _reciprocal(b: Builder, wire: Wire) -> Wire:
    return b.product(b.constant(1.0), wire, operators="*/")


def _sinc(b: Builder, wire: Wire) -> Wire:
    """sin(pi u) / (pi u), 1 at 0."""
    angle = b.scaled(math.pi, wire)
    share = b.product(ONE["sin"](b, angle), angle, operators="*/")
    return b.choose(b.compare(wire, "==", 0.0), b.constant(1.0), share)


def _remainder(rounding: str) -> OfTwo:
    def make(b: Builder, top: Wire, bottom: Wire) -> Wire:
        share = b.product(top, bottom, operators="*/")
        whole = b.add(RoundingFunction("B", function=rounding), share, ending="_whole")
        rest = b.sum(top, b.product(bottom, whole), signs="+-")
        return b.choose(b.compare(bottom, "~=", 0.0), rest, top)

    return make


def _hypotenuse(b: Builder, left: Wire, right: Wire) -> Wire:
    squares = b.sum(b.product(left, left), b.product(right, right))
    return ONE["sqrt"](b, squares)


def _extreme(kind: str) -> OfTwo:
    return lambda b, left, right: b.add(MinMax("B", function=kind, ports=2), left, right)


ONE: Mapping[str, OfOne] = {
    "abs": _block(Abs("B"), "abs"),
    "acos": _inverse("acos"),
    "asin": _inverse("asin"),
    "atan": lambda b, wire: TWO["atan2"](b, wire, b.constant(1.0)),
    "cos": _smooth(Wave("B", function="cos"), "cos", math.cos),
    "cosh": _hyperbolic("+"),
    "deg2rad": lambda b, wire: b.scaled(math.pi / 180, wire),
    "exp": exponential,
    "ln": logarithm,
    "log": logarithm,
    "log10": lambda b, wire: b.scaled(1 / math.log(10), logarithm(b, wire)),
    "not": lambda b, wire: b.logic("NOT", wire),
    "rad2deg": lambda b, wire: b.scaled(180 / math.pi, wire),
    "sgn": _block(Sign("B"), "sgn"),
    "sign": _block(Sign("B"), "sign"),
    "sin": _smooth(Wave("B"), "sin", math.sin),
    "sinc": _sinc,
    "sinh": _hyperbolic("-"),
    "sqrt": _smooth(SquareRoot("B"), "sqrt", root),
    "tan": _tangent,
    "tanh": _hyperbolic_tangent,
    **{name: _block(RoundingFunction("B", function=name), name)
       for name in ("ceil", "fix", "floor", "round")},
}  # fmt: skip
TWO: Mapping[str, OfTwo] = {
    "atan2": _smooth(ArcTangent("B"), "angle", math.atan2),
    "hypot": _hypotenuse,
    "max": _extreme("max"),
    "min": _extreme("min"),
    "mod": _remainder("floor"),
    "pow": power,
    "rem": _remainder("fix"),
}
_MATH: Mapping[str, OfOne] = {
    **{name: ONE[name] for name in ("exp", "log", "log10", "sqrt")},
    "10^u": lambda b, wire: exponential(b, b.scaled(math.log(10), wire)),
    "conj": lambda b, wire: wire,
    "magnitude^2": lambda b, wire: b.product(wire, wire),
    "reciprocal": _reciprocal,
    "square": lambda b, wire: b.product(wire, wire),
}
_WAVES = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")


def _pairs(b: Builder, kind: str) -> None:
    width = b.width()
    pairs = zip(b.inputs(1, width), b.inputs(2, width), strict=True)
    b.out([TWO[kind](b, *pair) for pair in pairs])


def _trigonometry(b: Builder) -> None:
    kind = b.dialog().text("Operator", b.dialog().text("Function", "sin"))
    if kind == "sincos":
        b.out([ONE["sin"](b, wire) for wire in b.inputs()])
        b.out([ONE["cos"](b, wire) for wire in b.inputs()], 2)
    elif kind == "atan2":
        _pairs(b, kind)
    elif kind in _WAVES:
        b.out([ONE[kind](b, wire) for wire in b.inputs()])
    else:
        raise ValueError(f"the function '{kind}'")


def _math(b: Builder) -> None:
    kind = b.dialog().text("Operator", b.dialog().text("Function", "exp"))
    if kind in ("transpose", "hermitian"):
        _transpose(b)
    elif kind in ("mod", "rem", "pow", "hypot"):
        _pairs(b, kind)
    elif kind in _MATH:
        b.out([_MATH[kind](b, wire) for wire in b.inputs()])
    else:
        raise ValueError(f"the function '{kind}'")


def _transpose(b: Builder) -> None:
    shape, wires = plain(b.input_shape()), b.inputs()
    rows = shape[0] if len(shape) == 2 else len(wires)
    columns = math.ceil(len(wires) / rows)
    b.out([wires[column * rows + row] for row in range(rows) for column in range(columns)])


def _square_root(b: Builder) -> None:
    kind = b.dialog().text("Operator", "sqrt")
    if kind not in ("sqrt", "signedSqrt", "rSqrt"):
        raise ValueError(f"the function '{kind}'")
    found: list[Wire] = []
    for wire in b.inputs():
        size = b.add(Abs("B"), wire, ending="_size") if kind == "signedSqrt" else wire
        root = ONE["sqrt"](b, size)
        if kind == "signedSqrt":
            root = b.product(root, b.add(Sign("B"), wire, ending="_sign"))
        if kind == "rSqrt":
            root = b.product(b.constant(1.0), root, operators="*/")
        found.append(root)
    b.out(found)


ELEMENTARY: Mapping[str, Callable[[Builder], None]] = {
    "Math": _math,
    "Sqrt": _square_root,
    "Trigonometry": _trigonometry,
}
