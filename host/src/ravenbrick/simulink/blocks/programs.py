# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks whose meaning is a text: formulas and functions in MATLAB's language."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.matlab.arrays import array_of
from ravenbrick.simulink.matlab.evaluation import Program, formula, program_of
from ravenbrick.simulink.network import End, Network, Site
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.signals import Shape, plain, size_of

__all__ = ["PROGRAMS", "interpreted_shape", "program_shapes"]

_ADVICE = "; draw this part with blocks, or give its result as a variable of the workspace"


def _formula(b: Builder) -> None:
    """A block Fcn: a formula of `u`, `u(1)`, `u[1]`."""
    text = re.sub(r"\bu\s*\[\s*(\d+)\s*\]", r"u(\1)", b.dialog().text("Expr", "u"))
    b.out([formula(b, text, {"u": b.inputs()})])


def _given(b: Builder, port: int) -> np.ndarray:
    """An input as a matrix; a vector is a column."""
    shape = plain(b.input_shape(port))
    rows, columns = shape if len(shape) == 2 else (shape[0], 1)
    return array_of(list(b.inputs(port)), rows, columns)


def _interpreted_value(b: Builder) -> np.ndarray:
    text = b.dialog().text("MATLABFcn", "sin")
    try:
        return Program(b, b.network.program).value(text, {"u": _given(b, 1)})
    except ValueError as error:
        raise ValueError(f"in '{text}': {error}{_ADVICE}") from error


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
    program = Program(b, b.network.program)
    program.files[file] = program_of(script.text, file)
    main = next(iter(program.files[file].values()), None)
    if main is None:
        raise ValueError("its program has no function")
    ports = [name for name in main.inputs if name not in script.parameters]
    values = {name: _given(b, port) for port, name in enumerate(ports, 1)}
    values |= {name: value_of(name, b.site.variables) for name in script.parameters}
    try:
        return program.call(main, [values[name] for name in main.inputs], file)
    except ValueError as error:
        raise ValueError(f"{error}{_ADVICE}") from error


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
