# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that only lead signals elsewhere: vectors, matrices, buses, chosen elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.shapes import as_matrix, chosen_places, demux_sizes, selected
from ravenbrick.simulink.signals import Bus, Wire, plain, size_of

__all__ = ["ROUTING"]


def _mux(b: Builder) -> None:
    b.out([wire for port in range(1, b.ports() + 1) for wire in b.inputs(port)])


def _demux(b: Builder) -> None:
    wires, place = b.inputs(least=len(demux_sizes(b.site, 1))), 0
    for port, size in enumerate(demux_sizes(b.site, len(wires)), 1):
        if place + size > len(wires) or size < 1:
            raise ValueError(f"{len(wires)} elements do not fill its outputs")
        b.out(wires[place : place + size], port)
        place += size


def _bus_selector(b: Builder) -> None:
    wires = b.inputs()
    found = selected(b.site, b.input_shape())
    parts = [wires[first : first + size_of(shape)] for _, first, shape in found]
    if b.dialog().text("OutputAsBus") == "on":
        b.out([wire for part in parts for wire in part])
        return
    for port, part in enumerate(parts, 1):
        b.out(part, port)


def _bus_assignment(b: Builder) -> None:
    wires = b.inputs()
    for port, (_, first, shape) in enumerate(selected(b.site, b.input_shape()), 2):
        wires[first : first + size_of(shape)] = b.inputs(port, size_of(shape))
    b.out(wires)


def _same(b: Builder) -> None:
    b.out(b.inputs())


def _manual_switch(b: Builder) -> None:
    setting = b.dialog().text("CurrentSetting") or b.dialog().text("sw") or "1"
    b.out(b.inputs(1 if setting == "1" else 2, b.width()))


def _columns(b: Builder, port: int) -> list[list[Wire]]:
    """A matrix input by columns."""
    shape, wires = plain(b.input_shape(port)), b.inputs(port)
    rows = shape[0]
    return [wires[first : first + rows] for first in range(0, len(wires), max(rows, 1))]


def _concatenate(b: Builder) -> None:
    d = b.dialog()
    if d.text("Mode", "Vector") == "Vector" or d.text("ConcatenateDimension", "1") != "1":
        _mux(b)
        return
    parts = [_columns(b, port) for port in range(1, b.ports() + 1)]
    if len({len(part) for part in parts}) > 1:
        raise ValueError("its inputs have different numbers of columns")
    joined: list[Wire] = []
    for column in range(len(parts[0])):
        for part in parts:
            joined += part[column]
    b.out(joined)


def pick(b: Builder, place: Wire, choices: list[list[Wire]], first: int) -> list[Wire]:
    """The choice with the number `place`, counted from `first`; beyond the ends the outer ones."""
    found = choices[-1]
    for number in range(len(choices) - 2, -1, -1):
        below = b.compare(place, "<", first + number + 0.5)
        pairs = zip(choices[number], found, strict=True)
        found = [b.choose(below, own, other) for own, other in pairs]
    return found


def _selector(b: Builder) -> None:
    d = b.dialog()
    if d.text("NumberOfDimensions", "1") != "1":
        sizes = as_matrix(b.input_shape())
        rows, columns = chosen_places(b.site, sizes)
        every = b.inputs(1, sizes[0] * sizes[1])
        b.out([every[column * sizes[0] + row] for column in columns for row in rows])
        return
    wires, option = b.inputs(), d.text("IndexOptions", "Index vector (dialog)")
    first = 0 if d.text("IndexMode", "One-based") == "Zero-based" else 1
    if option == "Select all":
        b.out(wires)
    elif option == "Index vector (port)":
        ends = [[wire] for wire in wires]
        b.out([pick(b, place, ends, first)[0] for place in b.inputs(2)])
    elif option in ("Index vector (dialog)", "Starting index (dialog)"):
        places = [int(v) - first for v in value_of(d.text("Indices", "1"), d.variables).ravel()]
        wires = wires if len(wires) > 1 else b.inputs(least=max(places, default=0) + 1)
        if option.startswith("Starting"):
            count = int(d.number("OutputSizes", "1"))
            places = list(range(places[0], places[0] + count))
        if any(not 0 <= place < len(wires) for place in places):
            raise ValueError(f"it selects elements beyond the {len(wires)} of its input")
        b.out([wires[place] for place in places])
    else:
        raise ValueError(f"the way to select '{option}'")


def _multiport_switch(b: Builder) -> None:
    d = b.dialog()
    order = d.text("DataPortOrder", "One-based contiguous")
    count = b.ports() - 1
    if order == "Specify indices":
        _switch_by_numbers(b, count)
        return
    if d.text("DataPortForDefault", "Last data port") != "Last data port" and count > 1:
        count -= 1
    if count < 2:
        raise ValueError("a choice from the elements of one vector")
    width = max(size_of(plain(b.input_shape(port))) for port in range(1, count + 2))
    choices = [b.inputs(port, width) for port in range(2, count + 2)]
    first = 0 if order.startswith("Zero") else 1
    if size_of(b.input_shape(1)) == 1:
        b.out(pick(b, b.inputs(1)[0], choices, first))
        return
    b.out([pick(b, place, [[choice[element]] for choice in choices], first)[0]
           for element, place in enumerate(b.inputs(1, width))])  # fmt: skip


def _switch_by_numbers(b: Builder, count: int) -> None:
    numbers = value_of(b.dialog().text("DataPortIndices", "{1,2}"), b.site.variables).ravel()
    width = max(size_of(plain(b.input_shape(port))) for port in range(2, count + 2))
    found, place = b.inputs(count + 1, width), b.inputs(1)[0]
    for port, number in reversed(list(zip(range(2, count + 2), numbers, strict=False))):
        test = b.compare(place, "==", float(number))
        pairs = zip(b.inputs(port, width), found, strict=True)
        found = [b.choose(test, own, other) for own, other in pairs]
    b.out(found)


def _assignment(b: Builder) -> None:
    d = b.dialog()
    d.refuse("IndexOptions", ("Index vector (dialog)",))
    first = 0 if d.text("IndexMode", "One-based") == "Zero-based" else 1
    wires = b.inputs()
    places = [int(v) - first for v in value_of(d.text("Indices", "1"), d.variables).ravel()]
    for place, wire in zip(places, b.inputs(2, len(places)), strict=True):
        wires[place] = wire
    b.out(wires)


def _width(b: Builder) -> None:
    shape = b.input_shape()
    if isinstance(shape, Bus):
        raise ValueError("the width of a bus")
    b.out([b.constant(size_of(shape))])


ROUTING: Mapping[str, Callable[[Builder], None]] = {
    "Assignment": _assignment,
    "BusAssignment": _bus_assignment,
    "BusCreator": _mux,
    "BusSelector": _bus_selector,
    "Concatenate": _concatenate,
    "Demux": _demux,
    "ManualSwitch": _manual_switch,
    "MultiPortSwitch": _multiport_switch,
    "Mux": _mux,
    "Reshape": _same,
    "Selector": _selector,
    "SignalConversion": _same,
    "Width": _width,
}
