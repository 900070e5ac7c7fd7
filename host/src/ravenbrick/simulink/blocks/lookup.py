# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables: prelookup, interpolation with its index, direct lookup, two dimensions."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ravenbrick.model import LookupTable, RoundingFunction, Saturation
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.signals import Wire

__all__ = ["LOOKUP"]

_LARGEST = 2000


def _points(b: Builder, name: str) -> tuple[float, ...]:
    return b.dialog().numbers(name, "[0 1]")


def _even(b: Builder, prefix: str, count: int) -> tuple[float, ...]:
    first = b.dialog().number(f"{prefix}FirstPoint", "0")
    step = b.dialog().number(f"{prefix}Spacing", "1")
    return tuple(first + step * index for index in range(count))


def _breakpoints(b: Builder, name: str, prefix: str, count: int) -> tuple[float, ...]:
    if b.dialog().text("BreakpointsSpecification", "Explicit values") == "Even spacing":
        return _even(b, prefix, count)
    return _points(b, name)


def _table(b: Builder) -> None:
    """One dimension; two by lines between lines."""
    d = b.dialog()
    kind = b.site.kind
    if kind == "Lookup":
        _line(b, _points(b, "InputValues"), _points(b, "Table"), d.text("LookUpMeth"))
        return
    if kind == "Lookup2D" or d.text("NumberOfTableDimensions", "1") == "2":
        _plane(b)
        return
    if d.text("NumberOfTableDimensions", "1") != "1":
        raise ValueError("a table of more than two dimensions")
    values = _points(b, "Table")
    points = _breakpoints(b, "BreakpointsForDimension1", "BreakpointsForDimension1", len(values))
    method = d.text("InterpMethod", "Linear")
    if method.startswith("Linear"):
        onwards = d.text("ExtrapMethod", "Linear") == "Linear"
        _line(b, points, values, "Interpolation-Extrapolation" if onwards else "")
    elif method == "Flat":
        b.out([b.add(LookupTable("B", breakpoints=points, table=values, interpolate=False), wire)
               for wire in b.inputs()])  # fmt: skip
    else:
        raise ValueError(f"InterpMethod '{method}' is not supported")


def _line(b: Builder, points: tuple[float, ...], values: tuple[float, ...], way: str) -> None:
    onwards = way.startswith("Interpolation-Extra")
    block = LookupTable("B", breakpoints=points, table=values, extrapolate=onwards)
    b.out([b.add(block, wire) for wire in b.inputs()])


def _plane(b: Builder) -> None:
    """Lines over the second input for the rows around the first one."""
    d = b.dialog()
    if b.site.kind == "Lookup2D":
        names = "RowIndex", "ColumnIndex", "Table"
        onwards = d.text("LookUpMeth").startswith("Interpolation-Extra")
    else:
        names = "BreakpointsForDimension1", "BreakpointsForDimension2", "Table"
        onwards = d.text("ExtrapMethod", "Linear") == "Linear"
    values = value_of(d.text(names[2], "[0 1; 1 2]"), d.variables)
    rows, columns = (_points(b, name) for name in names[:2])
    if d.variables.guess and values.size == 1:
        values = np.zeros((len(rows), len(columns)))
    if values.shape != (len(rows), len(columns)) or values.size > _LARGEST:
        raise ValueError(f"a table of {values.shape} for {len(rows)} and {len(columns)} points")
    high, wide = b.inputs(1)[0], b.inputs(2)[0]
    over = [LookupTable("B", breakpoints=columns, table=tuple(row), extrapolate=onwards)
            for row in values]  # fmt: skip
    heights: list[Wire] = [b.add(one, wide, ending="_row") for one in over]
    place, share = _place(b, high, rows, onwards=onwards)
    lower = _picked(b, place, heights[:-1])
    upper = _picked(b, place, heights[1:])
    b.out([b.sum(lower, b.product(share, b.sum(upper, lower, signs="+-")))])


def _picked(b: Builder, place: Wire, choices: list[Wire]) -> Wire:
    found = choices[-1]
    for number in range(len(choices) - 2, -1, -1):
        found = b.choose(b.compare(place, "<", number + 0.5), choices[number], found)
    return found


def _place(
    b: Builder, wire: Wire, points: tuple[float, ...], *, onwards: bool = False, last: bool = False
) -> tuple[Wire, Wire]:
    """The number of the interval that a value is in, from 0, and its share of it.

    With `last` the last point has a number of its own.
    """
    if len(points) < 2:
        raise ValueError("a table with fewer than two points")
    if not onwards:
        wire = b.add(Saturation("B", limit=points[-1], lower=points[0]), wire, ending="_within")
    starts = points if last else points[:-1]
    numbers = tuple(float(number) for number in range(len(starts)))
    if len(starts) == 1:
        place: Wire = b.constant(0.0)
        start, width = b.constant(points[0]), b.constant(points[1] - points[0])
    else:
        gaps = np.diff(points)
        widths = (*gaps, *gaps[-1:])[: len(starts)]
        stairs = [
            LookupTable("B", breakpoints=starts, table=tuple(map(float, heights)),
                        interpolate=False)
            for heights in (numbers, starts, widths)
        ]  # fmt: skip
        place, start, width = (b.add(one, wire, ending="_stairs") for one in stairs)
    share = b.product(b.sum(wire, start, signs="+-"), width, operators="*/")
    return place, share


def _prelookup(b: Builder) -> None:
    d = b.dialog()
    d.refuse("ExtrapMethod", ("Clip", "Linear"))
    if d.text("BreakpointsSpecification", "Explicit values") == "Even spacing":
        points = _even(b, "Breakpoints", int(d.number("BreakpointsNumPoints", "11")))
    else:
        points = _points(b, "BreakpointsData")
    onwards = d.text("ExtrapMethod", "Clip") == "Linear"
    only = d.text("OutputSelection", "Index and fraction") == "Index only"
    last = only or d.text("UseLastBreakpoint") == "on"
    pairs = [_place(b, wire, points, onwards=onwards, last=last) for wire in b.inputs()]
    b.out([place for place, _ in pairs])
    if not only:
        b.out([share for _, share in pairs], 2)


def _interpolation(b: Builder) -> None:
    d = b.dialog()
    if d.text("NumberOfTableDimensions", "1") != "1":
        raise ValueError("an interpolation in several dimensions")
    d.refuse("RequireIndexFractionAsBus", ("off",))
    values = _points(b, "Table")
    if len(values) < 2:
        raise ValueError("a table with fewer than two values")
    numbers = tuple(float(number) for number in range(len(values)))
    place = b.inputs(1)[0]
    stairs = LookupTable("B", breakpoints=numbers, table=values, interpolate=False)
    if d.text("InterpMethod", "Linear") == "Flat":
        b.out([b.add(stairs, place)])
        return
    d.refuse("InterpMethod", ("Linear", "Linear point-slope"))
    steps = (*np.diff(values).tolist(), 0.0)
    rise = LookupTable("B", breakpoints=numbers, table=steps, interpolate=False)
    height = b.add(stairs, place, ending="_value")
    change = b.add(rise, place, ending="_change")
    b.out([b.sum(height, b.product(b.inputs(2)[0], change))])


def _direct(b: Builder) -> None:
    """Elements, rows or columns of a table by their numbers from 0, beyond the ends the outer."""
    d = b.dialog()
    if d.text("TableIsInput", "off") == "on":
        raise ValueError("a table that is a signal")
    values = value_of(d.text("Table", "[0 1]"), d.variables)
    if values.size > _LARGEST:
        raise ValueError(f"a table of {values.size} elements")
    dimensions = d.text("NumberOfTableDimensions", d.text("maskTabDims", "1"))
    chosen = d.text("InputsSelectThisObjectFromTable", d.text("outDims", "Element"))
    places = [b.add(RoundingFunction("B", function="fix"), b.inputs(port)[0], ending="_whole")
              for port in range(1, b.ports() + 1)]  # fmt: skip
    if dimensions == "1" or (min(values.shape) == 1 and len(places) == 1):
        b.out([_by_number(b, places[0], values.ravel())])
    elif chosen == "Column" and dimensions == "2":
        b.out([_by_number(b, places[0], row) for row in values])
    elif chosen == "Element" and dimensions == "2" and len(places) == 2:
        rows = [_by_number(b, places[1], row) for row in values]
        b.out([_picked(b, places[0], rows)])
    else:
        raise ValueError(f"a direct table of {dimensions} dimensions that gives a {chosen}")


def _by_number(b: Builder, place: Wire, row: np.ndarray) -> Wire:
    heights = tuple(float(v) for v in np.ravel(row))
    if len(heights) == 1:
        return b.constant(heights[0])
    numbers = tuple(float(number) for number in range(len(heights)))
    table = LookupTable("B", breakpoints=numbers, table=heights, interpolate=False)
    return b.add(table, place, ending="_entry")


LOOKUP: Mapping[str, Callable[[Builder], None]] = {
    "Interpolation_n-D": _interpolation,
    "Lookup": _table,
    "Lookup2D": _table,
    "LookupNDDirect": _direct,
    "Lookup_n-D": _table,
    "PreLookup": _prelookup,
}
