# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How many elements each signal of a model has, and which names in a bus."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Mapping
from itertools import pairwise

import numpy as np

from ravenbrick.simulink.blocks.programs import interpreted_shape, program_shapes
from ravenbrick.simulink.counts import counts_in
from ravenbrick.simulink.matlab.linear_systems import is_lti, system_of
from ravenbrick.simulink.network import End, Network, Site
from ravenbrick.simulink.numbers import value_of
from ravenbrick.simulink.signals import Bus, Shape, plain, size_of

__all__ = ["as_matrix", "chosen_places", "demux_sizes", "selected", "shapes_of"]

_MOST_ROUNDS = 60
_LARGEST = 4096
# Parameters whose elements widen a block's output.
_WIDENING = {
    "Constant": ("Value",), "Gain": ("Gain",), "Bias": ("Bias",), "UnitDelay": ("InitialCondition",
    "X0"), "Memory": ("InitialCondition", "X0"), "Delay": ("InitialCondition",),
    "DiscreteIntegrator": ("InitialCondition",), "Integrator": ("InitialCondition",),
    "Step": ("After", "Before"), "Sin": ("Amplitude", "Frequency", "Phase"),
    "Saturate": ("UpperLimit", "LowerLimit"), "Reference": ("offset", "gain", "Cov"),
    "UniformRandomNumber": ("Minimum", "Maximum", "Seed"), "RandomNumber": ("Mean", "Variance",
    "Seed"),
}  # fmt: skip
_ONE_ELEMENT = frozenset("DotProduct Width Clock DigitalClock If SwitchCase".split())
_REDUCED = frozenset("Sum MinMax Product".split())

Rule = Callable[[Site, Network, Mapping[End, Shape]], dict[int, Shape]]


class _Asked:
    """What a model wants of signals whose type is not in the file: names, numbers of elements."""

    def __init__(self) -> None:
        self._names: dict[str, list[str]] = {}
        self._widths: dict[str, int] = {}

    def shape(self, origin: str) -> Bus:
        """The signal that begins at `origin`, as far as it is known by now."""
        fields = tuple(
            (name, self.shape(f"{origin}{name}.")) for name in self._names.get(origin, ())
        )
        return Bus(fields, origin, self._widths.get(origin, 1))

    def name(self, bus: Shape, name: str) -> None:
        """A signal is selected by name, `a.b` in a bus inside."""
        if not isinstance(bus, Bus):
            return
        first, _, rest = name.partition(".")
        inner = dict(bus.fields).get(first)
        if inner is None and bus.origin:
            known = self._names.setdefault(bus.origin, [])
            if first not in known:
                known.append(first)
            inner = self.shape(f"{bus.origin}{first}.")
        if rest and inner is not None:
            self.name(inner, rest)

    def width(self, shape: Shape, least: int) -> None:
        """A signal has at least so many elements."""
        if isinstance(shape, Bus) and shape.origin and not shape.fields:
            known = self._widths.get(shape.origin, 1)
            self._widths[shape.origin] = min(max(known, least), _LARGEST)


def shapes_of(network: Network, known: Container[str]) -> dict[End, Shape]:
    """The shape of every output that gives a signal of its own.

    Outputs of kinds of blocks that are not `known` are what others ask of them.
    """
    asked = _Asked()
    shapes: dict[End, Shape] = {}
    for _ in range(_MOST_ROUNDS):
        changed = False
        for site in network.sites.values():
            if site.commented or network.is_system(site.path):
                continue
            _ask(site, network, shapes, asked)
            try:
                found = _outputs(site, network, shapes, asked, known)
            except (ValueError, IndexError, KeyError):
                found = {1: (1,)}
            for port, shape in found.items():
                limited = shape if size_of(shape) <= _LARGEST else (1,)
                if shapes.get((site.path, port)) != limited:
                    shapes[site.path, port] = limited
                    changed = True
        if not changed:
            break
    return shapes


def _ask(site: Site, network: Network, shapes: Mapping[End, Shape], asked: _Asked) -> None:
    """What a block wants of its input."""
    given = _input(site, network, shapes, 1)
    if not isinstance(given, Bus):
        return
    if site.kind in ("BusSelector", "BusAssignment"):
        key = "OutputSignals" if site.kind == "BusSelector" else "AssignedSignals"
        for name in site.block.parameters.get(key, "").split(","):
            if name:
                asked.name(given, name)
        if site.kind == "BusAssignment":
            _ask_widths(site, network, shapes, asked, given)
    elif site.kind == "Demux":
        asked.width(given, len(demux_sizes(site, 1)))
    elif site.kind == "Selector":
        try:
            places = value_of(site.block.parameters.get("Indices", "1"), site.variables)
        except ValueError:
            return
        asked.width(given, int(places.max(initial=1)))


def _ask_widths(
    site: Site, network: Network, shapes: Mapping[End, Shape], asked: _Asked, bus: Bus
) -> None:
    """What is assigned to a signal of a bus tells its size."""
    names = [n for n in site.block.parameters.get("AssignedSignals", "").split(",") if n]
    for port, name in enumerate(names, 2):
        given = _input(site, network, shapes, port) or (1,)
        try:
            asked.width(bus.find(name)[1], size_of(given))
        except ValueError:
            continue


def _is_open(network: Network, site: Site) -> bool:
    """Whether the type of the block's signal is not in the file."""
    parameters = site.block.parameters
    typed = parameters.get("OutDataTypeStr", "").startswith("Bus:")
    if site.kind == "Constant":
        text = parameters.get("Value", "1")
        return typed or (
            re.fullmatch(r"[A-Za-z_][\w.]*", text) is not None and site.variables.guesses(text)
        )
    if site.kind == "Inport" and network.is_root_port(site):
        return typed or parameters.get("PortDimensions", "-1") == "-1"
    return site.kind == "FromWorkspace"


def _outputs(
    site: Site,
    network: Network,
    shapes: Mapping[End, Shape],
    asked: _Asked,
    known: Container[str],
) -> dict[int, Shape]:
    if _is_open(network, site):
        return {1: asked.shape(f"{site.path}|")}
    if network.is_root_port(site) and site.kind == "Inport":
        return {1: _port_shape(site)}
    rule = _RULES.get(site.kind, _widest)
    if site.kind in known:
        try:
            return rule(site, network, shapes)
        except ValueError:
            if site.kind not in ("MATLABFcn", "MATLABFunction"):
                raise
    numbers = counts_in(site.block.parameters.get("Ports", "1, 1"))
    count = numbers[1] if len(numbers) > 1 else 1
    return {port: asked.shape(f"{site.path}|{port}|") for port in range(1, count + 1)}


def _port_shape(site: Site) -> Shape:
    text = site.block.parameters.get("PortDimensions", "-1")
    sizes = [int(one) for one in value_of(text, site.variables).ravel()]
    if any(one < 1 for one in sizes):
        return (1,)
    return tuple(sizes) if len(sizes) <= 2 else (1,)


def _input(site: Site, network: Network, shapes: Mapping[End, Shape], port: int) -> Shape | None:
    end = network.source(site.path, port)
    return None if end is None else shapes.get(end, (1,))


def _inputs(site: Site, network: Network, shapes: Mapping[End, Shape]) -> list[Shape]:
    ports = range(1, network.inputs(site.path) + 1)
    return [_input(site, network, shapes, port) or (1,) for port in ports]


def _widest(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    """Element by element: the largest of inputs and parameters."""
    given = _inputs(site, network, shapes)
    if site.kind in _ONE_ELEMENT:
        outputs = 8 if site.kind in ("If", "SwitchCase") else 1
        return {port: (1,) for port in range(1, outputs + 1)}
    if site.kind in _REDUCED and len(given) == 1 and _one_input(site):
        return {1: (1,)}
    for name in _WIDENING.get(site.kind, ()):
        text = site.block.parameters.get(name, "")
        if text:
            try:
                given.append(_value_shape(value_of(text, site.variables)))
            except ValueError:
                continue
    largest: Shape = (1,)
    for shape in given:
        bigger = size_of(shape) > size_of(largest)
        same = size_of(shape) == size_of(largest)
        if bigger or (same and _rank(shape) > _rank(largest)):
            largest = shape
    outputs = 2 if site.kind in _TWO_OUTPUTS else 1
    return {port: largest for port in range(1, outputs + 1)}


_TWO_OUTPUTS = ("PreLookup", "Trigonometry", "Reference", "SecondOrderIntegrator")


def _rank(shape: Shape) -> int:
    """Of shapes of one size the matrix counts before the vector, the bus before both."""
    return 3 if isinstance(shape, Bus) else len(shape)


def _one_input(site: Site) -> bool:
    return len(site.block.parameters.get("Inputs", "1").replace("|", "")) == 1


def _value_shape(value: np.ndarray) -> Shape:
    return (value.size,) if 1 in value.shape else tuple(value.shape)


def _mux(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    return {1: (max(sum(size_of(s) for s in _inputs(site, network, shapes)), 1),)}


def demux_sizes(site: Site, total: int) -> list[int]:
    """The elements of each output."""
    values = [int(v) for v in value_of(site.block.parameters.get("Outputs", "2"),
                                       site.variables).ravel()]  # fmt: skip
    if len(values) == 1:
        count = max(values[0], 1)
        size, rest = divmod(total, count)
        return [size + (1 if index < rest else 0) for index in range(count)]
    left = total - sum(v for v in values if v > 0)
    free = sum(v < 0 for v in values)
    return [v if v > 0 else left // max(free, 1) for v in values]


def _demux(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    given = _input(site, network, shapes, 1) or (1,)
    if isinstance(given, Bus) and len(demux_sizes(site, 1)) == len(given.fields):
        return {port: inner for port, (_, inner) in enumerate(given.fields, 1)}
    sizes = demux_sizes(site, size_of(given))
    return {port: (max(size, 1),) for port, size in enumerate(sizes, 1)}


def _bus_creator(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    fields = []
    for port, shape in enumerate(_inputs(site, network, shapes), 1):
        name = network.signal_name(site.path, port) or f"signal{port}"
        fields.append((name, shape))
    return {1: Bus(tuple(fields))}


def selected(site: Site, bus: Shape) -> list[tuple[str, int, Shape]]:
    """Names, first elements and shapes of the signals that a bus selector or assignment names."""
    key = "OutputSignals" if site.kind == "BusSelector" else "AssignedSignals"
    names = [name for name in site.block.parameters.get(key, "").split(",") if name]
    if not isinstance(bus, Bus):
        raise ValueError("its input is not a bus whose signals are known")
    return [(name, *bus.find(name)) for name in names]


def _bus_selector(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    found = selected(site, _input(site, network, shapes, 1) or (1,))
    if site.block.parameters.get("OutputAsBus", "off") == "on":
        return {1: Bus(tuple((name.split(".")[-1], shape) for name, _, shape in found))}
    return {port: shape for port, (_, _, shape) in enumerate(found, 1)}


def _first_input(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    return {1: _input(site, network, shapes, 1) or (1,)}


def _constant(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    text = site.block.parameters.get("Value", "1")
    return {1: _value_shape(value_of(text, site.variables))}


def _concatenate(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    given = [plain(shape) for shape in _inputs(site, network, shapes)]
    axis = site.block.parameters.get("ConcatenateDimension", "1")
    if site.block.parameters.get("Mode", "Vector") == "Vector" or not given:
        return {1: (max(sum(size_of(shape) for shape in given), 1),)}
    columns = [shape if len(shape) == 2 else (shape[0], 1) for shape in given]
    if axis == "1":
        return {1: (sum(shape[0] for shape in columns), columns[0][1])}
    return {1: (columns[0][0], sum(shape[1] for shape in columns))}


def _reshape(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    total = size_of(_input(site, network, shapes, 1) or (1,))
    kind = site.block.parameters.get("OutputDimensionality", "1-D array")
    if kind == "Customize":
        text = site.block.parameters.get("OutputDimensions", "[1,1]")
        sizes = tuple(int(v) for v in value_of(text, site.variables).ravel())
        if np.prod(sizes) == total and len(sizes) <= 2:
            return {1: sizes}
    rows = {"Column vector (2-D)": (total, 1), "Row vector (2-D)": (1, total)}
    return {1: rows.get(kind, (total,))}


def chosen_places(site: Site, sizes: tuple[int, ...]) -> list[list[int]]:
    """Of a selection of rows and columns by the dialog, what is taken of each dimension."""
    parameters = site.block.parameters
    options = [one.strip() for one in parameters.get("IndexOptions", "").split(",")]
    first = 0 if parameters.get("IndexMode", "One-based") == "Zero-based" else 1
    places = _parts(parameters.get("Indices", "1,1"))
    counts = _parts(parameters.get("OutputSizes", "1,1"))
    if not len(options) == len(places) == len(counts) == len(sizes) == 2:
        raise ValueError("a selection from more than two dimensions, or of a matrix of one row")
    found = []
    for option, text, count, size in zip(options, places, counts, sizes, strict=True):
        if option == "Select all":
            found.append(list(range(size)))
            continue
        if option not in ("Index vector (dialog)", "Starting index (dialog)"):
            raise ValueError(f"the way to select '{option}'")
        own = [int(v) - first for v in value_of(text, site.variables).ravel()]
        if option.startswith("Starting"):
            length = int(value_of(count, site.variables)[0, 0])
            own = list(range(own[0], own[0] + length))
        if any(not 0 <= place < size for place in own):
            raise ValueError(f"it selects elements beyond the {size} of its input")
        found.append(own)
    return found


def _parts(text: str) -> list[str]:
    """What stands between commas outside of brackets."""
    return re.findall(r"(?:\[[^\]]*\]|\([^)]*\)|[^,])+", text)


def as_matrix(shape: Shape) -> tuple[int, ...]:
    """Rows and columns; a vector is a column."""
    sizes = plain(shape)
    return sizes if len(sizes) == 2 else (sizes[0], 1)


def _selector(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    parameters = site.block.parameters
    if parameters.get("NumberOfDimensions", "1") != "1":
        given = _input(site, network, shapes, 1) or (1,)
        rows, columns = chosen_places(site, as_matrix(given))
        return {1: (len(rows), len(columns))}
    option = parameters.get("IndexOptions", "Index vector (dialog)")
    if option == "Select all":
        return _first_input(site, network, shapes)
    if option == "Index vector (dialog)":
        places = value_of(parameters.get("Indices", "1"), site.variables)
        return {1: (max(places.size, 1),)}
    if option == "Starting index (dialog)":
        sizes = value_of(parameters.get("OutputSizes", "1"), site.variables)
        return {1: (int(sizes.ravel()[0]),)}
    return {1: (size_of(_input(site, network, shapes, 2) or (1,)),)}


def _math(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    found = _widest(site, network, shapes)
    given = plain(found[1])
    if site.block.parameters.get("Operator") in ("transpose", "hermitian"):
        return {1: (given[1], given[0]) if len(given) == 2 else (1, given[0])}
    return found


def _product(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    if site.block.parameters.get("Multiplication", "Element-wise(.*)") != "Matrix(*)":
        return _widest(site, network, shapes)
    given = [plain(shape) for shape in _inputs(site, network, shapes)]
    matrices = [shape for shape in given if size_of(shape) > 1]
    if not matrices:
        return {1: (1,)}
    if len(matrices) == 1:
        return {1: matrices[0]}
    if all(len(shape) == 1 for shape in matrices):
        return {1: (1,)}
    full = [shape if len(shape) == 2 else (shape[0], 1) for shape in matrices]
    if any(left[1] != right[0] for left, right in pairwise(full)):
        return {1: (1,)}
    result = (full[0][0], full[-1][1])
    return {1: (result[0],) if len(matrices[-1]) == 1 and result[1] == 1 else result}


def _gain(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    if not site.block.parameters.get("Multiplication", "Element").startswith("Matrix"):
        return _widest(site, network, shapes)
    value = value_of(site.block.parameters.get("Gain", "1"), site.variables)
    return {1: (value.shape[0],)} if value.size > 1 else _first_input(site, network, shapes)


def _state_space(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    return {1: (value_of(site.block.parameters.get("C", "1"), site.variables).shape[0],)}


def _transfer_function(
    site: Site, network: Network, shapes: Mapping[End, Shape]
) -> dict[int, Shape]:
    """A row of a matrix of numerators for each output."""
    rows = value_of(site.block.parameters.get("Numerator", "[1]"), site.variables)
    return {1: (len(rows),)} if len(rows) > 1 else _widest(site, network, shapes)


def _reference(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    if not is_lti(site.block.parameters.get("SourceBlock", "")):
        return _widest(site, network, shapes)
    system = system_of(site.block.parameters.get("sys", "1"), site.variables)
    count = len(system) if isinstance(system, np.ndarray) else system.noutputs
    return {1: (count,)} if count > 1 else _widest(site, network, shapes)


def _multiport(site: Site, network: Network, shapes: Mapping[End, Shape]) -> dict[int, Shape]:
    given = _inputs(site, network, shapes)
    return {1: max([*given[1:], *given[:1]], key=size_of, default=(1,))}


_RULES: dict[str, Rule] = {
    "Mux": _mux, "Demux": _demux, "BusCreator": _bus_creator, "BusSelector": _bus_selector,
    "BusAssignment": _first_input, "Constant": _constant,
    "Concatenate": _concatenate, "Reshape": _reshape, "Selector": _selector, "Math": _math,
    "Product": _product, "Gain": _gain, "StateSpace": _state_space,
    "TransferFcn": _transfer_function, "Reference": _reference,
    "DiscreteStateSpace": _state_space, "MultiPortSwitch": _multiport,
    "SignalConversion": _first_input, "RateTransition": _first_input, "Assignment": _first_input,
    "Fcn": lambda site, network, shapes: {1: (1,)}, "Outport": _first_input,
    "MATLABFcn": interpreted_shape, "MATLABFunction": program_shapes,
}  # fmt: skip
