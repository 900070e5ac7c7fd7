# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sums, products, comparisons, logic and number formats, element by element and over vectors."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from ravenbrick.model import (
    LogicalOperator,
    MinMax,
    Parameter,
    Quantiser,
    RelationalOperator,
    RoundingFunction,
    Saturation,
)
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.counts import count_of
from ravenbrick.simulink.matlab.arrays import Arrays, array_of
from ravenbrick.simulink.numbers import matrix, value_of
from ravenbrick.simulink.shapes import as_matrix
from ravenbrick.simulink.signals import Bus, Wire, plain, size_of

__all__ = ["ARITHMETIC"]

_FIXED = re.compile(r"fixdt\(\s*([01])\s*,\s*(\d+)\s*(?:,\s*(-?\d+)\s*)?\)\Z")
_WHOLE = re.compile(r"(u?)int(8|16|32|64)\Z")
_ROUNDINGS = {
    "Zero": "fix", "Floor": "floor", "Ceiling": "ceil", "Nearest": "round", "Round": "round",
    "Simplest": "floor", "Convergent": "round",
}  # fmt: skip
_MOST_TERMS = 4096


def _elements(b: Builder, width: int, count: int = 0) -> list[list[Wire]]:
    """For each element the wires of all inputs."""
    ports = [b.inputs(port, width) for port in range(1, (count or b.ports()) + 1)]
    return [list(wires) for wires in zip(*ports, strict=True)]


def _signs(b: Builder, sign: str, spacer: str = " ") -> str:
    """As the block's dialog lists them, or as many of this one as it says, else two."""
    text = b.dialog().text("Inputs").replace(" ", "").replace(spacer, "")
    count = count_of(text)
    return text or 2 * sign if count is None else count * sign


def _sum(b: Builder) -> None:
    signs = _signs(b, "+", spacer="|")
    if len(signs) == 1:
        wires = b.inputs()
        b.out([b.sum(*wires, signs=signs * len(wires))])
        return
    b.out([b.sum(*wires, signs=signs) for wires in _elements(b, b.width(), len(signs))])


def _product(b: Builder) -> None:
    signs = _signs(b, "*")
    if b.dialog().text("Multiplication").startswith("Matrix"):
        sizes = [size_of(b.input_shape(port)) for port in range(1, b.ports() + 1)]
        if "/" in signs and max(sizes) > 1:
            _matrix_quotient(b, signs)
            return
        if sum(size > 1 for size in sizes) > 1:
            _matrix_product(b, signs)
            return
    if len(signs) == 1:
        wires = b.inputs()
        product = b.product(*wires)
        one = (b.constant(1.0), product)
        b.out([b.product(*one, operators="*/") if signs == "/" else product])
        return
    found = []
    for wires in _elements(b, b.width(), len(signs)):
        pairs = list(zip(signs, wires, strict=True))
        pairs.sort(key=lambda pair: pair[0])  # the factors first
        if pairs[0][0] == "/":
            pairs.insert(0, ("*", b.constant(1.0)))
        kinds = "".join(kind for kind, _ in pairs)
        found.append(b.product(*(wire for _, wire in pairs), operators=kinds))
    b.out(found)


def _matrix_quotient(b: Builder, signs: str) -> None:
    """Matrices from left to right, the inverse of those with a `/`."""
    own, total = Arrays(b), None
    for port, sign in enumerate(signs, 1):
        rows, columns = as_matrix(b.input_shape(port))
        one = array_of(list(b.inputs(port)), rows, columns)
        one = own.inverse(one) if sign == "/" else one
        total = one if total is None else own.infix("*", total, one)
    assert total is not None
    b.out([b.element(element) for element in total.ravel(order="F")])


def _matrix_product(b: Builder, signs: str) -> None:
    """Matrices stored by columns, from left to right."""
    total, (rows, inner) = b.inputs(1), _as_matrix(b, 1, first=True)
    for port in range(2, len(signs) + 1):
        wires, (height, columns) = b.inputs(port), _as_matrix(b, port, first=False)
        if 1 in (len(total), len(wires)):
            long, short = (total, wires[0]) if len(wires) == 1 else (wires, total[0])
            total = [b.product(short, wire) for wire in long]
            rows, inner = (rows, inner) if len(wires) == 1 else (height, columns)
            continue
        if inner != height:
            raise ValueError(f"a matrix with {inner} columns times one with {height} rows")
        total = [
            b.sum(*(b.product(total[k * rows + row], wires[column * height + k])
                    for k in range(inner)))
            for column in range(columns) for row in range(rows)
        ]  # fmt: skip
        inner = columns
    b.out(total)


def _as_matrix(b: Builder, port: int, *, first: bool) -> tuple[int, int]:
    shape = plain(b.input_shape(port))
    if len(shape) == 2:
        return shape[0], shape[1]
    following = plain(b.input_shape(port + 1)) if first else (1,)
    row = first and following[0] == shape[0] and shape[0] > 1
    return (1, shape[0]) if row else (shape[0], 1)


def _dot_product(b: Builder) -> None:
    pairs = _elements(b, b.width(), 2)
    b.out([b.sum(*(b.product(*pair) for pair in pairs))])


def _gain(b: Builder) -> None:
    d = b.dialog()
    if d.text("Multiplication", "Element").startswith("Matrix") and not d.guesses("Gain"):
        _matrix_gain(b)
        return
    wires = b.inputs(1, b.width("Gain"))
    factor = b.tunable("Gain", "1")
    factors = [
        factor if isinstance(factor, Parameter) else b.dialog(element=e).number("Gain", "1")
        for e in range(len(wires))
    ]
    b.out([b.scaled_block(factor, wire) for factor, wire in zip(factors, wires, strict=True)])


def _matrix_gain(b: Builder) -> None:
    d, wires = b.dialog(), b.inputs()
    rows = matrix(d.text("Gain", "1"), d.variables)
    if rows == [[rows[0][0]]]:
        b.out([b.scaled_block(rows[0][0], wire) for wire in wires])
        return
    if not d.text("Multiplication").startswith("Matrix(K*u)") or len(rows[0]) != len(wires):
        raise ValueError(f"a matrix of {len(rows[0])} columns on a signal of {len(wires)}")
    found = []
    for row in rows:
        terms = [b.scaled(k, wire) for k, wire in zip(row, wires, strict=True) if k]
        found.append(b.sum(*terms) if terms else b.constant(0.0))
    b.out(found)


def _minmax(b: Builder) -> None:
    kind = b.dialog().text("Function", "min")
    if b.dialog().text("Inputs", "1") == "1":
        groups = [b.inputs()]
    else:
        groups = _elements(b, b.width(), int(b.dialog().number("Inputs", "1")))
    if len(groups[0]) == 1:
        b.out([group[0] for group in groups])
        return
    b.out([b.add(MinMax("B", function=kind, ports=len(group)), *group) for group in groups])


def _relation(b: Builder) -> None:
    sign = b.dialog().text("Operator", ">=")
    block = RelationalOperator("B", operator=sign)
    b.out([b.add(block, *wires) for wires in _elements(b, b.width(), 2)])


def _logic(b: Builder) -> None:
    kind = b.dialog().text("Operator", "AND")
    count = max(b.ports(), 1)
    if kind == "NOT":
        b.out([b.add(LogicalOperator("B", operator="NOT", ports=1), w) for w in b.inputs()])
        return
    groups = [b.inputs()] if count == 1 else _elements(b, b.width(), count)
    block = LogicalOperator("B", operator=kind, ports=len(groups[0]))
    b.out([b.add(block, *group) for group in groups])


def _compare_to(text: str) -> Callable[[Builder], None]:
    """A library block that compares with a number."""

    def make(b: Builder) -> None:
        d = b.dialog()
        sign = d.text("relop", "<=")
        b.out([b.compare(wire, sign, b.dialog(element=e).number(text, "0") if text else 0.0)
               for e, wire in enumerate(b.inputs())])  # fmt: skip

    return make


def _conversion(b: Builder) -> None:
    """Numbers rounded and limited, or wrapped, to the type; they stay in single precision."""
    kind = b.dialog().text("OutDataTypeStr", "Inherit: Inherit via back propagation")
    if kind in ("boolean", "logical"):
        b.out([b.compare(wire, "~=", 0.0) for wire in b.inputs()])
        return
    limits = _limits(kind)
    if limits is None:
        known = kind in ("single", "double") or kind.startswith(("Inherit", "Enum", "Bus"))
        if not known:
            raise ValueError(f"OutDataTypeStr '{kind}' is not supported")
        b.out([b.scaled_block(1.0, wire) for wire in b.inputs()])
        return
    b.out([_rounded(b, wire, *limits) for wire in b.inputs()])


def _limits(kind: str) -> tuple[float, float, float] | None:
    """The smallest step, the lowest and the highest number of a type; None for other types."""
    whole, fixed = _WHOLE.match(kind), _FIXED.match(kind)
    if whole:
        signed, bits, fraction = not whole[1], int(whole[2]), 0
    elif fixed:
        signed, bits, fraction = fixed[1] == "1", int(fixed[2]), int(fixed[3] or 0)
    else:
        return None
    step = math.ldexp(1.0, -fraction)
    low = -math.ldexp(1.0, bits - 1) if signed else 0.0
    return step, low * step, (math.ldexp(1.0, bits - 1 if signed else bits) - 1) * step


def _rounded(b: Builder, wire: Wire, step: float, low: float, high: float) -> Wire:
    rounding = _ROUNDINGS[b.dialog().text("RndMeth", "Floor")]
    if rounding == "round":
        found: Wire = b.add(Quantiser("B", interval=step), wire, ending="_round")
    else:
        whole = b.add(RoundingFunction("B", function=rounding), b.scaled(1 / step, wire),
                      ending="_whole")  # fmt: skip
        found = b.scaled(step, whole)
    if b.dialog().text("SaturateOnIntegerOverflow") == "on":
        return b.add(Saturation("B", limit=high, lower=low), found)
    size = high - low + step
    if size > 2.0**24 * step:  # single precision cannot tell neighbours apart
        return b.add(Saturation("B", limit=high, lower=low), found)
    turns = b.add(RoundingFunction("B"), b.scaled(1 / size, b.sum(found, b.constant(-low))),
                  ending="_turns")  # fmt: skip
    return b.sum(found, b.scaled(size, turns), signs="+-")


def _saturation(b: Builder) -> None:
    names = ("UpperLimit", "LowerLimit")
    wires = b.inputs(1, b.width(*names))
    single = all(value_of(b.dialog().text(n) or "0", b.site.variables).size == 1 for n in names)
    if single:
        limits = b.limits(*names, "0.5", "-0.5")
        b.out([b.add(limits, wire) for wire in wires])
        return
    found = []
    for element, wire in enumerate(wires):
        d = b.dialog(element=element)
        low, high = d.number("LowerLimit", "-0.5"), d.number("UpperLimit", "0.5")
        found.append(b.add(Saturation("B", limit=high, lower=low), wire))
    b.out(found)


def _constant(b: Builder) -> None:
    d = b.dialog()
    shape = b.shapes.get((b.site.path, 1), (1,))
    if isinstance(shape, Bus):
        b.out([b.constant_block(value) for value in _bus_values(b, shape, d.text("Value", "1"))])
        return
    value = value_of(d.text("Value", "1"), d.variables).T.ravel()
    if value.size == 1:
        b.out([b.constant_block(b.tunable("Value", "1"))])
        return
    if value.size > _MOST_TERMS:
        raise ValueError(f"a constant of {value.size} elements")
    b.out([b.constant_block(float(one)) for one in value])


def _bus_values(b: Builder, bus: Bus, name: str) -> list[float]:
    """The numbers of a structure, its fields as variables `name.field`; a number is in all."""
    found: list[float] = []
    if not re.fullmatch(r"[A-Za-z_][\w.]*", name):
        return [float(value_of(name, b.site.variables)[0, 0])] * size_of(bus)
    for own, shape in bus.fields:
        if isinstance(shape, Bus) and shape.fields:
            found += _bus_values(b, shape, f"{name}.{own}")
            continue
        value = value_of(f"{name}.{own}", b.site.variables).T.ravel()
        size = size_of(shape)
        found += [float(one) for one in (value if value.size == size else [value[0]] * size)]
    return found or [0.0] * size_of(bus)


ARITHMETIC: Mapping[str, Callable[[Builder], None]] = {
    "Constant": _constant,
    "DataTypeConversion": _conversion,
    "DotProduct": _dot_product,
    "Gain": _gain,
    "Logic": _logic,
    "MinMax": _minmax,
    "Product": _product,
    "RelationalOperator": _relation,
    "Saturate": _saturation,
    "Sum": _sum,
    "simulink/Compare To Constant": _compare_to("const"),
    "simulink/Compare To Zero": _compare_to(""),
}
