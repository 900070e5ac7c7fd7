# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks whose meaning is a text: formulas and functions in MATLAB's language."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import TypeVar

import numpy as np

from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.matlab.arrays import array_of
from ravenbrick.simulink.matlab.evaluation import Program, formula, program_of
from ravenbrick.simulink.network import End, Network, Site
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.signals import Ref, Shape, Wire, plain, size_of

__all__ = ["PROGRAMS", "interpreted_shape", "program_shapes"]

Result = TypeVar("Result")
_FARTHEST = 100  # vectors and buses inside each other
_ADVICE = "; draw this part with blocks, or give its result as a variable of the workspace"


def _formula(b: Builder) -> None:
    """A block Fcn: a formula of `u`, `u(1)`, `u[1]`."""
    text = re.sub(r"\bu\s*\[\s*(\d+)\s*\]", r"u(\1)", b.dialog().text("Expr", "u"))
    b.out([formula(b, text, {"u": b.inputs()})])


def _given(b: Builder, port: int, *, fixed: bool) -> np.ndarray:
    """An input as a matrix; a vector is a column. If `fixed`, constants are their numbers."""
    shape = plain(b.input_shape(port))
    rows, columns = shape if len(shape) == 2 else (shape[0], 1)
    elements: list[float | Wire] = [
        _number_of(b, wire) if fixed and isinstance(wire, Ref) else wire for wire in b.inputs(port)
    ]
    return array_of(elements, rows, columns)


def _number_of(b: Builder, wire: Ref) -> float | Wire:
    """The number of a wire that comes from a Constant, also through vectors and buses."""
    end: End | None = (wire.path, wire.port)
    element = wire.element
    for _ in range(_FARTHEST):
        if end is None:
            break
        site = b.network.sites[end[0]]
        if site.kind == "Constant":
            value = value_of(site.block.parameters.get("Value", "1"), site.variables)
            return float(value.T.ravel()[element])
        if site.kind not in ("Mux", "BusCreator"):
            return wire
        inner: End | None = None
        for port in range(1, b.network.inputs(site.path) + 1):
            inner = b.network.source(site.path, port)
            size = 1 if inner is None else size_of(b.shapes.get(inner, (1,)))
            if element < size:
                break
            element -= size
        end = inner
    return wire


def _tried(b: Builder, make: Callable[[bool], Result]) -> Result:
    """With all signals; where that is refused, with the numbers of constants among them."""
    made = len(b.nodes)
    try:
        return make(False)
    except ValueError as error:
        del b.nodes[made:]
        try:
            return make(True)
        except ValueError:
            raise ValueError(f"{error}{_ADVICE}") from error


def _interpreted_value(b: Builder) -> np.ndarray:
    text = b.dialog().text("MATLABFcn", "sin")

    def make(fixed: bool) -> np.ndarray:
        try:
            signals = {"u": _given(b, 1, fixed=fixed)}
            return Program(b, b.network.program).value(text, signals)
        except ValueError as error:
            raise ValueError(f"in '{text}': {error}") from error

    return _tried(b, make)


def _interpreted(b: Builder) -> None:
    """The expression in the dialog of an Interpreted MATLAB Function, of its input `u`."""
    found = _interpreted_value(b)
    expected = size_of(b.shapes.get((b.site.path, 1), (1,)))
    if found.size != expected:
        raise ValueError(
            f"'{b.dialog().text('MATLABFcn')}' gives {found.size} elements, its dialog says "
            f"{expected}; set its output dimensions to {found.size}"
        )
    b.out([b.element(one) for one in found.ravel(order="F")])


def interpreted_shape(
    site: Site, network: Network, shapes: Mapping[End, Shape]
) -> dict[int, Shape]:
    """As its dialog says; -1 is what the expression gives, found by writing it out for nothing."""
    text = site.block.parameters.get("OutputDimensions", "-1")
    sizes = tuple(int(one) for one in value_of(text, site.variables).ravel())
    if sizes == (-1,):
        sizes = _shape_of(_interpreted_value(Builder.alone(site, network, dict(shapes))))
    if site.block.parameters.get("Output1D", "on") == "on":
        return {1: (math.prod(sizes),)}
    return {1: sizes}


def _shape_of(array: np.ndarray) -> tuple[int, ...]:
    """A column is a vector."""
    return (array.shape[0],) if array.shape[1] == 1 else (array.shape[0], array.shape[1])


def _outputs(b: Builder) -> list[np.ndarray]:
    """The outputs of a MATLAB Function block."""
    script, file = b.site.block.script, "its program"
    assert script is not None

    def make(fixed: bool) -> list[np.ndarray]:
        program = Program(b, b.network.program)
        program.files[file] = program_of(script.text, file)
        main = next(iter(program.files[file].values()), None)
        if main is None:
            raise ValueError("its program has no function")
        ports = [name for name in main.inputs if name not in script.parameters]
        values = {name: _given(b, port, fixed=fixed) for port, name in enumerate(ports, 1)}
        values |= {name: value_of(name, b.site.variables) for name in script.parameters}
        return program.call(main, [values[name] for name in main.inputs], file)

    return _tried(b, make)


def _program(b: Builder) -> None:
    """A MATLAB Function block; the first port of what is inside it is a call, and shows nothing."""
    b.out([b.constant(0.0)])
    for port, array in enumerate(_outputs(b), 2):
        b.out([b.element(one) for one in array.ravel(order="F")], port)


def program_shapes(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    """What its program gives, found by writing it out once for nothing."""
    b = Builder.alone(site, network, dict(shapes))
    found: dict[int, Shape] = {1: (1,)}
    for port, array in enumerate(_outputs(b), 2):
        found[port] = _shape_of(array)
    return found


PROGRAMS: Mapping[str, Callable[[Builder], None]] = {
    "Fcn": _formula,
    "MATLABFcn": _interpreted,
    "MATLABFunction": _program,
}
