# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What makes blocks of a diagram from one block of a model: its dialog, its inputs, new nodes."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum

from ravenbrick.codegen.c.text import C_KEYWORDS
from ravenbrick.codegen.scopes import ACCUMULATOR
from ravenbrick.model import (
    Block,
    Constant,
    Gain,
    LogicalOperator,
    Parameter,
    Product,
    RelationalOperator,
    Saturation,
    Sum,
    Switch,
    UnitDelay,
)
from ravenbrick.model.blocks.continuous import ContinuousStateSpace
from ravenbrick.simulink.file import SimulinkBlock
from ravenbrick.simulink.network import Network, Site
from ravenbrick.simulink.numbers import Workspace, value_of
from ravenbrick.simulink.signals import Node, Ref, Shape, Wire, plain, size_of

__all__ = ["Builder", "ContinuousForm", "Dialog", "Names", "Value", "identifier"]

Value = float | Parameter


class ContinuousForm(Enum):
    """What a continuous block becomes: a discrete one, or in a simulation what it is."""

    TUSTIN = "discrete by Tustin's method"
    HELD = "discrete with its input held"
    SOLVED = "a system of differential equations"


LONGEST_NAME = 31


def identifier(path: str) -> str:
    """The last characters of a path as a name for a diagram."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", path).strip("_") or "Block"
    words = words if words[0].isalpha() else f"B_{words}"
    return words[-LONGEST_NAME:].lstrip("_0123456789").rstrip("_") or "Block"


class Names:
    """Names that are not taken yet."""

    def __init__(self) -> None:
        self._taken = {word.lower() for word in (*C_KEYWORDS, ACCUMULATOR)}
        self._next: dict[tuple[str, str], int] = {}
        self._shared: dict[str, str] = {}

    def new(self, path: str, ending: str = "") -> str:
        """A name for the block at `path`, with an ending for a part of it.

        The ending is set apart by `_i`, so that no value of another block has the same name.
        """
        ending = ending and f"_i{ending}"
        path = path.replace("//", "_")  # a slash in a block's name
        last = identifier(path.rpartition("/")[2])
        base = last if ending or last.lower() not in self._taken else identifier(path)
        number = self._next.get((base, ending), 1)
        name = self._cut(base, ending if number == 1 else f"{ending}_{number}")
        while name.lower() in self._taken:
            number += 1
            name = self._cut(base, f"{ending}_{number}")
        self._next[base, ending] = number
        self._taken.add(name.lower())
        return name

    def shared(self, text: str) -> str:
        """The same name for the same text."""
        if text not in self._shared:
            self._shared[text] = self.new(text)
        return self._shared[text]

    def _cut(self, base: str, ending: str) -> str:
        return f"{base[: LONGEST_NAME - len(ending)].rstrip('_')}{ending}"


@dataclass(frozen=True)
class Dialog:
    """A block's parameters as numbers; `sample_time` (s) is the rate that the block runs at.

    Of a parameter with several elements `element` (from 0) is taken.
    """

    block: SimulinkBlock
    name: str
    variables: Workspace
    sample_time: float
    element: int = 0
    form: ContinuousForm = ContinuousForm.TUSTIN

    def text(self, name: str, default: str = "") -> str:
        """A parameter as it stands in the file."""
        return self.block.parameters.get(name, default).strip()

    def number(self, name: str, default: str) -> float:
        """A scalar parameter, or the element of a vector."""
        value = value_of(self.text(name, default) or default, self.variables)
        flat = value.T.ravel()
        if flat.size == 0:
            return self.number_of(default)
        return float(flat[0] if flat.size == 1 else flat[min(self.element, flat.size - 1)])

    def number_of(self, text: str) -> float:
        """A number from text."""
        return float(value_of(text, self.variables).T.ravel()[0])

    def numbers(self, name: str, default: str) -> tuple[float, ...]:
        """A vector parameter; where variables are guessed one that may be any is the default."""
        value = value_of(self.text(name, default) or default, self.variables)
        if min(value.shape) > 1:
            raise ValueError(f"{name} is a matrix, not a vector")
        if value.size == 1 and self.guesses(name):
            return self.numbers("", default)
        return tuple(float(one) for one in value.ravel())

    def guesses(self, name: str) -> bool:
        """Whether a parameter has a value only by a guess."""
        return bool(self.text(name)) and self.variables.guesses(self.text(name))

    def samples(self, seconds: float) -> int:
        """A time as a whole number of samples."""
        if self.variables.guess:
            return max(round(seconds / self.sample_time), 2)
        count = round(seconds / self.sample_time)
        if not math.isclose(count * self.sample_time, seconds, rel_tol=1e-6, abs_tol=1e-12):
            raise ValueError(f"{seconds} s is not a whole number of samples")
        return count

    def refuse(self, name: str, allowed: tuple[str, ...]) -> None:
        """Raise unless a parameter has one of these values or is not there."""
        if self.text(name) and self.text(name) not in allowed:
            raise ValueError(f"{name} '{self.text(name)}' is not supported")


@dataclass
class Builder:
    """One block of the model, and what it becomes: nodes, and the wires of its outputs."""

    site: Site
    network: Network
    shapes: dict[tuple[str, int], Shape]
    names: Names
    parameters: Names
    sample_time: float
    condition: Callable[[str], Wire]
    form: ContinuousForm
    time: Callable[[], Wire]
    nodes: list[Node] = field(default_factory=list)
    outputs: dict[int, list[Wire]] = field(default_factory=dict)
    open_inputs: list[int | str] = field(default_factory=list)
    _shared: dict[tuple[object, ...], Node] | None = None

    @classmethod
    def alone(cls, site: Site, network: Network, shapes: dict[tuple[str, int], Shape]) -> Builder:
        """One whose nodes go nowhere: to see what a block would become."""

        def no_wire(*_: object) -> Wire:
            raise ValueError("a condition or the time")

        return cls(site, network, shapes, Names(), Names(), 1.0, no_wire, ContinuousForm.TUSTIN,
                   no_wire)  # fmt: skip

    @contextmanager
    def sharing(self) -> Iterator[None]:
        """Meanwhile what is computed twice, of the same wires, is one block."""
        before = self._shared
        self._shared = {} if before is None else before
        try:
            yield
        finally:
            self._shared = before

    def dialog(self, name: str = "", element: int = 0) -> Dialog:
        """The block's parameters."""
        site, rate = self.site, self.sample_time
        return Dialog(site.block, name, site.variables, rate, element, self.form)

    def tunable(self, name: str, default: str) -> Value:
        """A dialog's parameter as a field of the generated parameters, as Embedded Coder names it.

        A variable of the workspace gives its own name, shared by all blocks that use it; any other
        scalar is `<block>_<name>`. Infinite values, and vectors and matrices, stay numbers.
        """
        d = self.dialog()
        text, value = d.text(name, default) or default, d.number(name, default)
        if not math.isfinite(value) or value_of(text, d.variables).size != 1:
            return value
        if re.fullmatch(r"[A-Za-z][\w.]*", text) and self.network.is_workspace_variable(
            text, d.variables
        ):
            about = f"workspace variable '{text}'"
            return Parameter(self.parameters.shared(text), value, "", about)
        own = self.parameters.new(f"{self.site.path}_{name}")
        return Parameter(own, value, "", f"{name} of '{identifier(self.site.path)}'")

    def symmetric_limits(self, upper: str, lower: str) -> bool:
        """Whether the lower limit is the upper one with a minus, and finite."""
        d = self.dialog()
        high, low = (d.text(name).replace(" ", "") for name in (upper, lower))
        numbers = d.number(upper, "0.5"), d.number(lower, "-0.5")
        literal = not re.search("[A-Za-z]", high + low)
        same = low == f"-{high}" or literal
        return same and numbers[0] == -numbers[1] and math.isfinite(numbers[0])

    def limits(self, upper: str, lower: str, high: str, low: str) -> Saturation:
        """A saturation between two parameters of the dialog; `high` and `low` are the defaults.

        Limits such as `battery` and `-battery` become one field, so that they cannot differ.
        """
        limit = self.tunable(upper, high)
        if self.symmetric_limits(upper, lower):
            return Saturation("B", limit=limit)
        return Saturation("B", limit=limit, lower=self.tunable(lower, low))

    def input_shape(self, port: int | str = 1) -> Shape:
        """The shape of the signal at an input; of an open one a number."""
        end = self.network.source(self.site.path, port)
        return (1,) if end is None else self.shapes.get(end, (1,))

    def inputs(self, port: int | str = 1, width: int | None = None, least: int = 1) -> list[Wire]:
        """The wires of the signal at an input; a single one is spread over `width`.

        An open input is 0, in at least `least` elements.
        """
        end = self.network.source(self.site.path, port)
        if end is None:
            self.open_inputs.append(port)
            return [self.constant(0.0)] * (width or least)
        count = size_of(self.shapes.get(end, (1,)))
        wires: list[Wire] = [Ref(*end, element) for element in range(count)]
        if width is None or count == width:
            return wires
        if count != 1:
            raise ValueError(f"input {port} has {count} elements where {width} are expected")
        return wires * width

    def ports(self) -> int:
        """The number of inputs."""
        return self.network.inputs(self.site.path)

    def width(self, *names: str) -> int:
        """The number of elements of all inputs and of the parameters that are named."""
        sizes = [1]
        for port in range(1, self.ports() + 1):
            sizes.append(size_of(plain(self.input_shape(port))))
        for name in names:
            text = self.dialog().text(name)
            if text:
                sizes.append(value_of(text, self.site.variables).size)
        return max(sizes)

    def add(self, block: Block, *inputs: Wire, ending: str = "") -> Node:
        """A new node; the block gets a name that is free, and the rate of this one."""
        key = (block, *inputs)
        shared = self._shared if len(inputs) == len(block.input_types) else None
        if shared is not None and key in shared:
            return shared[key]
        named = replace(block, name=self.names.new(self.site.path, ending))
        node = Node(named, self.site.path, list(inputs))
        self.nodes.append(node)
        if shared is not None and not block.states():
            shared[key] = node
        return node

    def constant(self, value: float) -> Node:
        """A number as a wire."""
        return self.add(Constant("B", value=float(value)), ending="_number")

    def element(self, value: float | Wire) -> Wire:
        """A wire as it is, a number as a constant."""
        return self.constant(value) if isinstance(value, float | int) else value

    def constant_block(self, value: Value) -> Node:
        """A number under the block's own name."""
        return self.add(Constant("B", value=value))

    def scaled_block(self, factor: Value, wire: Wire) -> Node:
        """A product with a number under the block's own name."""
        return self.add(Gain("B", gain=factor), wire)

    def sum(self, *wires: Wire, signs: str = "") -> Wire:
        """A sum; signs such as `+-`."""
        pairs = list(zip(signs or "+" * len(wires), wires, strict=True))
        pairs.sort(key=lambda pair: pair[0])  # the pluses first
        if pairs[0][0] == "-":
            total = self.sum(*(wire for _, wire in pairs)) if len(pairs) > 1 else pairs[0][1]
            return self.add(Gain("B", gain=-1.0), total, ending="_minus")
        if len(pairs) == 1:
            return pairs[0][1]
        ordered = "".join(sign for sign, _ in pairs)
        return self.add(Sum("B", signs=ordered), *(wire for _, wire in pairs), ending="_sum")

    def scaled(self, factor: Value, wire: Wire, ending: str = "_gain") -> Wire:
        """A product with a number."""
        return wire if factor == 1.0 else self.add(Gain("B", gain=factor), wire, ending=ending)

    def product(self, *wires: Wire, operators: str = "") -> Wire:
        """Products and quotients."""
        if len(wires) == 1:
            return wires[0]
        block = Product("B", operators=operators or "*" * len(wires))
        return self.add(block, *wires, ending="_product")

    def compare(self, left: Wire, operator: str, right: Wire | float) -> Wire:
        """1 or 0."""
        other = self.constant(right) if isinstance(right, float | int) else right
        return self.add(RelationalOperator("B", operator=operator), left, other, ending="_test")

    def logic(self, operator: str, *wires: Wire) -> Wire:
        """1 or 0."""
        block = LogicalOperator("B", operator=operator, ports=len(wires))
        return self.add(block, *wires, ending=f"_{operator.lower()}")

    def choose(self, condition: Wire, yes: Wire, no: Wire) -> Wire:
        """`yes` where the condition is 1, `no` where it is 0."""
        return self.add(Switch("B", threshold=0.5), yes, condition, no, ending="_choice")

    def limited(self, wire: Wire, low: Wire, high: Wire) -> Wire:
        """Between two signals."""
        inside = self.choose(self.compare(wire, "<", low), low, wire)
        return self.choose(self.compare(wire, ">", high), high, inside)

    @property
    def solved(self) -> bool:
        """Whether the block stays continuous: in a simulation, unless its dialog is discrete."""
        discrete = self.dialog().text("TimeDomain", "Continuous-time").startswith("Discrete")
        return self.form is ContinuousForm.SOLVED and not discrete

    def integral(self, wire: Wire | None = None, initial: float = 0.0) -> Node:
        """The integral over time, in a simulation; its input may be given later."""
        given = [] if wire is None else [wire]
        return self.add(ContinuousStateSpace("B", initial=(initial,)), *given, ending="_integral")

    def last(self, wire: Wire, initial: float = 0.0) -> Wire:
        """The value of the step before."""
        return self.add(UnitDelay("B", initial=initial), wire, ending="_last")

    def out(self, wires: Sequence[Wire], port: int = 1) -> None:
        """What an output gives."""
        self.outputs[port] = list(wires)
