# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Units of signals: what adds metres to radians per second is refused, with both ends named."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks import basic, dynamic, nonlinear, relational
from ravenbrick.model.blocks.basic import Block, Inputs, Parameter
from ravenbrick.model.blocks.continuous import Integrator
from ravenbrick.model.blocks.logic import ZeroOrderHold
from ravenbrick.model.structure.expansion import End, Expanded

__all__ = ["Unit", "UnitConversion", "check_units", "unit_of"]

_BASES = ("m", "kg", "s", "A", "K", "rad", "count", "duty")
_DERIVED = {
    "g": "0.001 kg", "mm": "0.001 m", "cm": "0.01 m", "km": "1000 m", "ms": "0.001 s",
    "us": "0.000001 s", "min": "60 s", "h": "3600 s", "Hz": "1/s", "N": "kg m/s^2", "J": "N m",
    "W": "J/s", "V": "W/A", "mV": "0.001 V", "mA": "0.001 A", "ohm": "V/A", "H": "V s/A",
    "deg": f"{math.pi / 180!r} rad", "degree": "deg", "degrees": "deg", "turn": f"{math.tau!r} rad",
    "rpm": "turn/min", "counts": "count", "C": "A s",
}  # fmt: skip
_TOKEN = re.compile(r"\s*([0-9.]+(?:e-?[0-9]+)?|[A-Za-z_%°]+|\^\s*-?[0-9]+|[*/()])")
_KEEPING = (
    basic.Sum, basic.Saturation, basic.UnitDelay, basic.Conversion, dynamic.Delay,
    dynamic.MovingAverage, nonlinear.DeadZone, nonlinear.RateLimit, nonlinear.Quantiser,
    nonlinear.Backlash, relational.MinMax, relational.Abs, ZeroOrderHold,
)  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """A factor and the powers of base units, such as 1000 m^1 for km; angles are a base of own."""

    factor: float
    powers: tuple[tuple[str, int], ...]

    def __mul__(self, other: Unit) -> Unit:
        """The product of two quantities' units."""
        powers = dict(self.powers)
        for base, power in other.powers:
            powers[base] = powers.get(base, 0) + power
        kept = tuple(sorted((base, power) for base, power in powers.items() if power))
        return Unit(self.factor * other.factor, kept)

    def __pow__(self, power: int) -> Unit:
        """The unit multiplied with itself."""
        powers = tuple((base, own * power) for base, own in self.powers if power)
        return Unit(self.factor**power, powers)

    def is_same(self, other: Unit) -> bool:
        """Whether the numbers of both may be added."""
        return self.powers == other.powers and math.isclose(self.factor, other.factor)


@lru_cache(maxsize=1024)
def unit_of(text: str) -> Unit:
    """The unit of a text such as "rad/s", "N m" or "V s/rad"; an unknown name is a base of own.

    Raises `DesignError` for what is no product of names, numbers and whole powers.
    """
    if text.strip() in ("", "-", "1"):
        return Unit(1.0, ())
    tokens, place = [], 0
    while place < len(text.rstrip()):
        match = _TOKEN.match(text, place)
        if match is None:
            raise DesignError(f"'{text}' is not a unit; write names with * / ^, such as 'm/s^2'")
        tokens.append(match[1])
        place = match.end()
    try:
        found, rest = _product(tokens)
    except (IndexError, ValueError) as error:
        raise DesignError(f"'{text}' is not a unit; write such as 'm/s^2'") from error
    if rest:
        raise DesignError(f"'{text}' is not a unit: '{' '.join(rest)}' is too much")
    return found


def _product(tokens: list[str]) -> tuple[Unit, list[str]]:
    """Products and one-term divisors from left to right."""
    found, rest = _power(tokens)
    while rest and rest[0] != ")":
        sign = -1 if rest[0] == "/" else 1
        following, rest = _power(rest[1:] if rest[0] in "*/" else rest)
        found = found * following**sign
    return found, rest


def _power(tokens: list[str]) -> tuple[Unit, list[str]]:
    head, rest = tokens[0], tokens[1:]
    if head == "(":
        found, rest = _product(rest)
        if not rest or rest[0] != ")":
            raise ValueError("an open parenthesis")
        rest = rest[1:]
    elif head[0].isdigit() or head[0] == ".":
        found = Unit(float(head), ())
    elif head in "*/)" or head[0] == "^":
        raise ValueError(f"{head} without a name before it")
    else:
        found = unit_of(_DERIVED[head]) if head in _DERIVED else Unit(1.0, ((head, 1),))
    if rest and rest[0].startswith("^"):
        found, rest = found ** int(rest[0][1:]), rest[1:]
    return found, rest


@dataclass(frozen=True)
class UnitConversion(Block):
    """A signal in unit `source` as one in unit `target`, such as "deg/s" in "rad/s".

    Units of different kinds need a `factor` (target per source): volts from a duty cycle are
    `UnitConversion("Volts", source="duty", target="V", factor=9.0)`.
    """

    source: str = ""
    target: str = ""
    factor: float | None = None

    def __post_init__(self) -> None:
        one, two = unit_of(self.source), unit_of(self.target)
        if self.factor is None and one.powers != two.powers:
            raise DesignError(
                f"conversion '{self.name}': {self.source} is another kind of quantity than "
                f"{self.target}; give the factor"
            )

    @property
    def gain(self) -> float:
        """Target per source."""
        if self.factor is not None:
            return self.factor
        return unit_of(self.source).factor / unit_of(self.target).factor

    def output(self, inputs: Inputs) -> ir.Expression:
        """The scaled input."""
        return ir.Binary("*", self._literal(self.gain), inputs[0])


@dataclass(frozen=True)
class _Known:
    """A unit, as written, and the path of the block that states it."""

    unit: Unit
    text: str
    path: str


class _Classes:
    """Outputs that must have the same unit, and what is known of it."""

    def __init__(self, diagram: str) -> None:
        self._parents: dict[End, End] = {}
        self.known: dict[End, _Known] = {}
        self._diagram = diagram

    def root(self, end: End) -> End:
        """The representative of an output's class."""
        while self._parents.get(end, end) != end:
            end = self._parents[end]
        return end

    def join(self, one: End, two: End, where: str) -> bool:
        """Both have the same unit; whether that is new."""
        first, second = self.root(one), self.root(two)
        if first == second:
            return False
        left, right = self.known.get(first), self.known.get(second)
        if left is not None and right is not None:
            self._compare(left, right, where)
        self._parents[second] = first
        if left is None and right is not None:
            self.known[first] = right
        return True

    def state(self, end: End, text: str, path: str, unit: Unit | None = None) -> bool:
        """An output's unit; whether that is new."""
        root, stated = self.root(end), _Known(unit or unit_of(text), text, path)
        if root in self.known:
            self._compare(self.known[root], stated, path)
            return False
        self.known[root] = stated
        return True

    def get(self, end: End) -> _Known | None:
        """What is known."""
        return self.known.get(self.root(end))

    def _compare(self, one: _Known, two: _Known, where: str) -> None:
        if one.unit.is_same(two.unit):
            return
        remedy = "put a UnitConversion between them"
        if one.unit.powers != two.unit.powers:
            remedy = "these are different quantities"
        raise DesignError(
            f"diagram '{self._diagram}': at '{where}' a signal in {one.text} (from '{one.path}') "
            f"meets one in {two.text} (from '{two.path}'); {remedy}"
        )


def check_units(diagram: str, whole: Expanded) -> Mapping[End, str]:
    """Units of all outputs that are known or follow, as text; raises `DesignError` on a conflict.

    A signal without a stated unit may have any, and a plain gain gives any.
    """
    classes = _Classes(diagram)
    sources_of = {
        path: [whole.sources[path, port] for port in range(len(block.input_types))]
        for path, block in whole.blocks.items()
    }
    for path, block in whole.blocks.items():
        _state(classes, path, block, sources_of[path])
    for stated in whole.port_units:
        classes.state(stated.end, stated.unit, stated.path)
    for path, block in whole.blocks.items():
        _join(classes, path, block, sources_of[path])
    changed = True
    while changed:
        changed = False
        for path, block in whole.blocks.items():
            changed |= _follow(classes, path, block, sources_of[path])
    ends = [(path, n) for path, block in whole.blocks.items() for n in range(block.output_count)]
    return {end: known.text for end in ends if (known := classes.get(end))}


def _state(classes: _Classes, path: str, block: Block, sources: list[End]) -> None:
    """What a block states of its ports."""
    own = (path, 0)
    if isinstance(block, UnitConversion):
        classes.state(sources[0], block.source, path)
        classes.state(own, block.target, path)
    elif isinstance(block, basic.Outport):
        if block.unit:
            classes.state(sources[0], block.unit, path)
    elif block.unit:
        for output in range(block.output_count):
            classes.state((path, output), block.unit, path)
    elif isinstance(block, basic.Constant) and isinstance(block.value, Parameter):
        if block.value.unit:
            classes.state(own, block.value.unit, path)


def _join(classes: _Classes, path: str, block: Block, sources: list[End]) -> None:
    """Ports of a block that have the same unit."""
    own = (path, 0)
    if isinstance(block, _KEEPING):
        for source in sources:
            classes.join(own, source, path)
    elif isinstance(block, nonlinear.Switch):
        classes.join(own, sources[0], path)
        classes.join(own, sources[2], path)
    elif isinstance(block, relational.RelationalOperator):
        classes.join(sources[0], sources[1], path)


def _follow(classes: _Classes, path: str, block: Block, sources: list[End]) -> bool:
    """Products of known units; whether anything is new."""
    own = (path, 0)
    if block.unit or not sources:
        return False
    given = [classes.get(source) for source in sources]
    units = [known for known in given if known is not None]
    factor = _factor(block)
    if len(units) < len(given):
        return False
    if isinstance(block, relational.Product):
        total, text = units[0].unit, units[0].text
        for operator, known in zip(block.operators[1:], units[1:], strict=True):
            total = total * known.unit ** (1 if operator == "*" else -1)
            text = f"{text} {operator} ({known.text})"
    elif factor is not None:
        total, text = units[0].unit * unit_of(factor), f"{units[0].text} * ({factor})"
    else:
        return False
    if total.is_same(units[0].unit):
        text = units[0].text
    return classes.state(own, text, path, total)


def _factor(block: Block) -> str | None:
    """The unit that a block multiplies its input by; None if unknown."""
    if isinstance(block, basic.Gain) and isinstance(block.gain, Parameter):
        return block.gain.unit or None
    if isinstance(block, Integrator):
        return "s"
    if isinstance(block, basic.DiscreteIntegrator) and block.gain is None:
        return "s"
    return None
