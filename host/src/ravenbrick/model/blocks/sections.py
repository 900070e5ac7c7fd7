# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Transfer functions as a chain of small sections in delta = z - 1, which keep their digits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.blocks.basic import (
    Assignments,
    Block,
    DiscreteTransferFunction,
    Inputs,
)
from ravenbrick.model.lazy import control
from ravenbrick.model.zero_pole_gain import ZeroPoleGain

__all__ = ["DeltaTransferFunction", "Section", "transfer_function_block"]


@dataclass(frozen=True)
class Section:
    """One or two states, delta(x) being the difference of the next x and the present one.

    e = u - x_last if `returned`, else u. Of `order` 1: delta(x) = entry e,
    y = output x + direct e. Of order 2: delta(x1) = entry e - damping x1, delta(x2) = x1,
    y = output x2 + direct e + middle x1.
    """

    entry: float
    output: float
    direct: float
    returned: bool
    order: int = 1
    damping: float = 0.0
    middle: float = 0.0

    @property
    def doubled(self) -> bool:
        """Whether the step of the state is twice what passes on at once, as by Tustin's method.

        The next state is then y + direct e: one product less.
        """
        return self.order == 1 and self.output == 1.0 and self.entry == 2 * self.direct


@dataclass(frozen=True)
class DeltaTransferFunction(Block):
    """Sections in series, then `gain`; the digits of slow poles are not lost as in powers of z.

    `of` chooses the sections: one of first order for each real pole, of second order for each
    complex pair, fast ones first, integrators last, each with a static gain of 1.
    """

    sections: tuple[Section, ...] = ()
    gain: float = 1.0

    @classmethod
    def of(
        cls,
        name: str,
        system: ZeroPoleGain,
        data_type: ir.DataType = ir.DataType.REAL32,
    ) -> DeltaTransferFunction:
        """A discrete system by its roots; raises `DesignError` for a continuous one."""
        if not system.dt:
            raise DesignError(f"block '{name}': the system is continuous; discretise it first")
        if not system.poles:
            raise DesignError(f"block '{name}': the system is a number; use a Gain")
        sections, gain = _sections(system)
        return cls(name, data_type, sections=sections, gain=gain)

    def _held_back(self) -> int:
        """How many sections from the first do not pass the present input on to the output."""
        own = [index for index, section in enumerate(self.sections, 1) if not section.direct]
        return max(own, default=0)

    def feedthrough(self, port: int) -> bool:
        """Only if each section has as many zeros as poles."""
        return self._held_back() == 0

    def states(self) -> tuple[ir.Slot, ...]:
        """Those of the sections in order."""
        count = sum(section.order for section in self.sections)
        return tuple(self._state(f"DSTATE{index}", 0.0) for index in range(1, count + 1))

    def _states_of(self, place: int) -> tuple[ir.Slot, ...]:
        first = sum(section.order for section in self.sections[:place])
        return self.states()[first : first + self.sections[place].order]

    def _times(self, factor: float, value: ir.Expression) -> ir.Expression:
        return value if factor == 1.0 else ir.Binary("*", self._literal(factor), value)

    def _difference(self, place: int) -> ir.Slot:
        return self._local(f"e{place + 1}")

    def _passing(self, place: int) -> ir.Slot:
        return self._local(f"h{place + 1}")

    def _between(self, place: int) -> ir.Slot:
        return self._local(f"y{place + 1}")

    def _named(self, place: int) -> bool:
        """Whether y of a section is a variable; the last one's is often only the output."""
        return place + 1 < len(self.sections) or self.sections[place].doubled

    def _input(self, place: int, inputs: Inputs) -> ir.Expression:
        return inputs[0] if place == 0 else ir.Read(self._between(place - 1))

    def _entering(self, place: int, inputs: Inputs) -> ir.Expression:
        """e of a section."""
        if self.sections[place].returned:
            return ir.Read(self._difference(place))
        return self._input(place, inputs)

    def _computed(self, first: int, last: int, inputs: Inputs) -> Assignments:
        """e and y of the sections from `first` up to `last`, y only between sections."""
        found: list[tuple[ir.Slot, ir.Expression]] = []
        for place in range(first, last):
            section, states = self.sections[place], self._states_of(place)
            if section.returned:
                entering = ir.Binary("-", self._input(place, inputs), ir.Read(states[-1]))
                found.append((self._difference(place), entering))
            if section.doubled:
                passing = self._times(section.direct, self._entering(place, inputs))
                found.append((self._passing(place), passing))
            if section.direct and self._named(place):
                found.append((self._between(place), self._leaving(place, inputs)))
        return tuple(found)

    def _leaving(self, place: int, inputs: Inputs) -> ir.Expression:
        """y of a section."""
        section, states = self.sections[place], self._states_of(place)
        terms = []
        if section.output:
            terms.append(self._times(section.output, ir.Read(states[-1])))
        if section.doubled:
            terms.append(ir.Read(self._passing(place)))
        elif section.direct:
            terms.append(self._times(section.direct, self._entering(place, inputs)))
        if section.middle:
            terms.append(self._times(section.middle, ir.Read(states[0])))
        total = terms[0] if terms else self._literal(0.0)
        for term in terms[1:]:
            total = ir.Binary("+", total, term)
        return total

    def intermediates(self, inputs: Inputs) -> Assignments:
        """What does not wait for an input that the output does not need."""
        held = self._held_back()
        stored = tuple(
            (self._between(place), self._leaving(place, inputs))
            for place in range(held)
            if not self.sections[place].direct and place + 1 < len(self.sections)
        )
        return (*stored, *self._computed(held, len(self.sections), inputs))

    def output(self, inputs: Inputs) -> ir.Expression:
        """The last section's y times the gain."""
        last = len(self.sections) - 1
        own = ir.Read(self._between(last)) if self._named(last) else self._leaving(last, inputs)
        return self._times(self.gain, own)

    def updates(self, inputs: Inputs, output: ir.Expression) -> Assignments:
        """Each state with its difference, the second of a section before the first."""
        found = list(self._computed(0, self._held_back(), inputs))
        for place, section in enumerate(self.sections):
            states = self._states_of(place)
            if section.doubled:
                parts = ir.Read(self._between(place)), ir.Read(self._passing(place))
                found.append((states[0], ir.Binary("+", *parts)))
                continue
            if section.order == 2:
                moved = ir.Binary("+", ir.Read(states[1]), ir.Read(states[0]))
                found.append((states[1], moved))
            step = self._times(section.entry, self._entering(place, inputs))
            if section.damping:
                loss = self._times(section.damping, ir.Read(states[0]))
                step = ir.Binary("-", step, loss)
            found.append((states[0], ir.Binary("+", ir.Read(states[0]), step)))
        return tuple(found)


def transfer_function_block(
    name: str,
    system: control.TransferFunction | ZeroPoleGain,
    data_type: ir.DataType = ir.DataType.REAL32,
    sample_time: float | None = None,
) -> DeltaTransferFunction | DiscreteTransferFunction:
    """A transfer function with one input and one output, in sections of the delta operator.

    A continuous one needs `sample_time` (s): its roots are mapped by Tustin's method. Of a discrete
    one by polynomials the roots are found first, which is refused where the coefficients do not
    determine the response. A filter with a finite impulse response stays a polynomial.
    """
    if isinstance(system, control.TransferFunction) and control.isdtime(system, strict=True):
        numerator, denominator = (_trimmed(p[0][0]) for p in (system.num, system.den))
        if len(denominator) > 1 and not any(denominator[1:]):
            padding = (0.0,) * (len(denominator) - len(numerator))
            taps = tuple(value / denominator[0] for value in numerator)
            return DiscreteTransferFunction(
                name,
                data_type,
                numerator=(*padding, *taps),
                denominator=(1.0, *(0.0,) * (len(denominator) - 1)),
            )
    try:
        roots = ZeroPoleGain.of(system)
    except DesignError as error:
        raise DesignError(f"block '{name}': {error.sentence}") from error
    if not roots.dt:
        if sample_time is None:
            raise ValueError(
                f"block '{name}': the system is continuous; give a sample time, or discretise it "
                "first"
            )
        roots = roots.sampled(sample_time)
    return DeltaTransferFunction.of(name, roots, data_type)


def _trimmed(polynomial: object) -> list[float]:
    """Coefficients without leading zeros."""
    values = [float(value) for value in polynomial]  # type: ignore[attr-defined]
    while values and values[0] == 0.0:
        values.pop(0)
    return values


def _sections(system: ZeroPoleGain) -> tuple[tuple[Section, ...], float]:
    """Sections from fast to slow, and the gain behind them."""
    gain = system.gain
    found = []
    for zeros, poles in _assigned(list(system.zeros), list(system.poles)):
        section, factor = _section(zeros, poles)
        gain *= factor
        found.append((_rank(poles), section))
    found.sort(key=lambda one: one[0])
    return tuple(section for _, section in found), gain


def _rank(poles: tuple[complex, ...]) -> tuple[bool, float]:
    """Integrators last, else fast ones first."""
    return any(pole == 0 for pole in poles), -min(abs(pole) for pole in poles)


def _distance(first: complex, second: complex) -> float:
    sizes = [max(abs(root), 1e-300) for root in (first, second)]
    return abs(math.log(sizes[0] / sizes[1]))


_Roots = tuple[complex, ...]


def _assigned(zeros: list[complex], poles: list[complex]) -> list[tuple[_Roots, _Roots]]:
    """Zeros and poles of each section.

    Complex zeros go to the complex poles nearest in the logarithm of their size, else to two real
    poles joined; real zeros to the nearest place left.
    """
    pairs = [(pole, pole.conjugate()) for pole in poles if pole.imag > 0]
    single = sorted((pole for pole in poles if pole.imag == 0), key=abs)
    open_: list[tuple[list[complex], _Roots]] = []
    for zero in sorted((zero for zero in zeros if zero.imag > 0), key=abs, reverse=True):
        both = [zero, zero.conjugate()]
        if pairs:
            chosen = min(pairs, key=lambda pair: _distance(pair[0], zero))
            pairs.remove(chosen)
        else:
            near = sorted(single, key=lambda pole: _distance(pole, zero))[:2]
            for pole in near:
                single.remove(pole)
            chosen = (near[0], near[1])
        open_.append((both, chosen))
    open_ += [([], pair) for pair in pairs] + [([], (pole,)) for pole in single]
    for zero in sorted((zero for zero in zeros if zero.imag == 0), key=abs):
        places = [place for place in open_ if len(place[0]) < len(place[1])]
        near_place = min(places, key=lambda place: min(_distance(pole, zero) for pole in place[1]))
        near_place[0].append(zero)
    return [(tuple(own), chosen) for own, chosen in open_]


def _section(zeros: _Roots, poles: _Roots) -> tuple[Section, float]:
    """A section of these roots with a static gain of 1, and the factor left out of it."""
    top = _monic(zeros)
    if len(poles) == 1:
        return _first_order(top, poles[0].real)
    n2, n1, n0 = (0.0,) * (2 - len(zeros)) + top
    damping, product = _monic(poles)[1:]
    returned = product != 0.0
    factor = product / n0 if returned and n0 else 1.0 / max(abs(n2), abs(n1), abs(n0))
    n2, n1, n0 = (factor * value for value in (n2, n1, n0))
    entry = product if returned else 1.0
    section = Section(
        entry=entry,
        output=n0 / entry,
        direct=n2,
        returned=returned,
        order=2,
        damping=damping,
        middle=(n1 - n2 * damping) / entry,
    )
    return section, 1.0 / factor


def _first_order(top: tuple[float, ...], pole: float) -> tuple[Section, float]:
    n1, n0 = (0.0,) * (2 - len(top)) + top
    if pole == 0.0:
        factor = 1.0 / (n1 or n0)
        n1, n0 = n1 * factor, n0 * factor
        return Section(n0, 1.0, n1, returned=False), 1.0 / factor
    factor = -pole / n0 if n0 else 1.0 / n1
    n1, n0 = n1 * factor, n0 * factor
    return Section(-pole, -n0 / pole, n1, returned=True), 1.0 / factor


def _monic(roots: _Roots) -> tuple[float, ...]:
    """Coefficients of the polynomial with one or two roots, or none."""
    if not roots:
        return (1.0,)
    if len(roots) == 1:
        return (1.0, -roots[0].real)
    return (1.0, -(roots[0] + roots[1]).real, (roots[0] * roots[1]).real)
