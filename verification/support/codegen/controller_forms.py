# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Random controllers by their roots, the forms in which they can run, and their exact answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from decimal import Decimal, localcontext

import numpy as np
from ravenbrick.model import (
    Block,
    Diagram,
    DiscreteStateSpace,
    DiscreteTransferFunction,
    Gain,
    Inport,
    Outport,
    ZeroPoleGain,
    transfer_function_block,
)
from scipy import linalg, signal

__all__ = ["FORMS", "exact_answer", "form_diagram", "random_controller"]

DIGITS = 60


def random_controller(random: np.random.Generator) -> ZeroPoleGain:
    """A stable or integrating controller: real and complex roots over four decades, order 1 to 7.

    In continuous time; `gain` makes the response at 1 rad/s of size 1.
    """
    integrators = int(random.integers(0, 2))
    pairs, single = int(random.integers(0, 3)), int(random.integers(0, 3))
    single += not integrators + pairs + single
    poles = [0j] * integrators + _real(random, single) + _complex(random, pairs)
    zero_pairs = int(random.integers(0, min(2, len(poles) // 2) + 1))
    most = len(poles) - 2 * zero_pairs
    zeros = _complex(random, zero_pairs) + _real(random, int(random.integers(0, most + 1)))
    plain = ZeroPoleGain(tuple(zeros), tuple(poles), 1.0)
    return ZeroPoleGain(plain.zeros, plain.poles, float(1 / abs(plain.response(1.0))))


def _real(random: np.random.Generator, count: int) -> list[complex]:
    return [complex(-(10 ** random.uniform(-1.5, 2.5))) for _ in range(count)]


def _complex(random: np.random.Generator, pairs: int) -> list[complex]:
    roots = []
    for _ in range(pairs):
        size, damping = 10 ** random.uniform(-1, 2.2), random.uniform(0.05, 0.95)
        root = complex(-damping * size, size * (1 - damping**2) ** 0.5)
        roots += [root, root.conjugate()]
    return roots


def _factors(roots: tuple[complex, ...]) -> list[tuple[Decimal, Decimal, Decimal]]:
    """Real factors of s, two roots at most each: coefficients of s^2, s, 1."""
    own = [root for root in roots if root.imag >= 0]
    factors = []
    for root in own:
        real, imaginary = Decimal(root.real), Decimal(root.imag)
        if imaginary:
            factors.append((Decimal(1), -2 * real, real * real + imaginary * imaginary))
        else:
            factors.append((Decimal(0), Decimal(1), -real))
    return factors


def exact_answer(system: ZeroPoleGain, sample_time: float, steps: int, down: int) -> np.ndarray:
    """Outputs for 1 until step `down`, then 0, by Tustin's method in sixty decimal digits.

    Numerator and denominator are filtered factor by factor, each as its own difference equation:
    nothing here is shared with the blocks.
    """
    with localcontext() as context:
        context.prec = DIGITS
        rate = 2 / Decimal(sample_time)
        values = [Decimal(system.gain) if k < down else Decimal(0) for k in range(steps)]
        tops, bottoms = _factors(system.zeros), _factors(system.poles)
        for place in range(max(len(tops), len(bottoms))):
            top = _in_z(tops[place], rate) if place < len(tops) else None
            bottom = _in_z(bottoms[place], rate) if place < len(bottoms) else None
            values = _filtered(values, top, bottom)
        excess = len(system.poles) - len(system.zeros)
        # Each factor in z was (z + 1) times too large; what does not cancel is left here.
        for _ in range(excess):
            values = [b + a for a, b in zip([Decimal(0), *values], values, strict=False)]
        return np.array([float(value) for value in values])


_Taps = tuple[Decimal, ...]


def _in_z(factor: tuple[Decimal, Decimal, Decimal], rate: Decimal) -> _Taps:
    """A factor of s with s = rate (z-1)/(z+1), times (z+1) per root; taps of 1, 1/z, 1/z^2."""
    two, one, none = factor
    if not two:
        return one * rate + none, none - one * rate
    square = two * rate * rate
    return square + one * rate + none, 2 * (none - square), square - one * rate + none


def _filtered(values: list[Decimal], top: _Taps | None, bottom: _Taps | None) -> list[Decimal]:
    above = (*(top or (Decimal(1),)), Decimal(0), Decimal(0))[:3]
    below = (*(bottom or (Decimal(1),)), Decimal(0), Decimal(0))[:3]
    (b0, b1, b2), (a0, a1, a2) = above, below
    b0, b1, b2, a1, a2 = b0 / a0, b1 / a0, b2 / a0, a1 / a0, a2 / a0
    first = second = Decimal(0)
    found = []
    for value in values:
        out = b0 * value + first
        first, second = b1 * value - a1 * out + second, b2 * value - a2 * out
        found.append(out)
    return found


def _z_roots(system: ZeroPoleGain) -> tuple[np.ndarray, np.ndarray, float]:
    return 1 + np.array(system.zeros), 1 + np.array(system.poles), system.gain


def _direct(system: ZeroPoleGain) -> list[Block]:
    zeros, poles, gain = _z_roots(system)
    top = gain * np.real(np.atleast_1d(np.poly(zeros)))
    bottom = tuple(np.real(np.poly(poles)).tolist())
    return [DiscreteTransferFunction("Direct", numerator=tuple(top.tolist()), denominator=bottom)]


def _cascade(system: ZeroPoleGain) -> list[Block]:
    blocks: list[Block] = []
    for place, row in enumerate(signal.zpk2sos(*_z_roots(system))):
        top, bottom = row[:3].tolist(), row[3:].tolist()
        if bottom[2] == 0.0 and top[2] == 0.0:
            top, bottom = top[:2], bottom[:2]
        name = f"Section{place + 1}"
        blocks.append(
            DiscreteTransferFunction(name, numerator=tuple(top), denominator=tuple(bottom))
        )
    return blocks


def _balanced(system: ZeroPoleGain) -> list[Block]:
    """Balanced by gramians; integrators are damped a little while the balance is computed."""
    a, b, c, d = _modal(system)
    shrunk = a * (1 - 1e-4)
    reach = linalg.solve_discrete_lyapunov(shrunk, b @ b.T)
    seen = linalg.solve_discrete_lyapunov(shrunk.T, c.T @ c)
    u, sizes, _ = np.linalg.svd(reach)
    root = u * np.sqrt(np.maximum(sizes, sizes[0] * 1e-14))
    v, values, _ = np.linalg.svd(root.T @ seen @ root)
    shape = root @ v * np.maximum(values, values[0] * 1e-14) ** -0.25
    back = np.linalg.inv(shape)
    rows = [tuple(map(tuple, matrix.tolist())) for matrix in (back @ a @ shape, back @ b)]
    own = tuple((c @ shape)[0].tolist())
    return [DiscreteStateSpace("Balanced", a=rows[0], b=rows[1], c=own, d=(float(d),))]


def _modal(system: ZeroPoleGain) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """The default block's own matrices in double precision."""
    from ravenbrick.model import linear_system

    found = linear_system(form_diagram([transfer_function_block("Sections", system)], system.dt))
    return found.A, found.B, found.C, float(found.D[0, 0])


def _delta(system: ZeroPoleGain) -> list[Block]:
    return [transfer_function_block("Sections", system)]


FORMS: Mapping[str, Callable[[ZeroPoleGain], list[Block]]] = {
    "direct": _direct,
    "cascade": _cascade,
    "balanced": _balanced,
    "delta": _delta,
}


def form_diagram(blocks: list[Block], sample_time: float, name: str = "form") -> Diagram:
    """The blocks in a row between one port each."""
    diagram = Diagram(name, sample_time)
    row = [diagram.add(block) for block in blocks] or [diagram.add(Gain("One"))]
    diagram.connect_chain(diagram.add(Inport("In")), *row, diagram.add(Outport("Out")))
    return diagram
