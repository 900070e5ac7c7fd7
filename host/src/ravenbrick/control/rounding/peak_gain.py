# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Worst-case peak gain: how large a bounded error can become, for all time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = ["peak_gain"]

_Array = npt.NDArray[np.float64]
_SMALL = 1e-12
_MOST_DOUBLINGS = 24


def peak_gain(system: control.StateSpace) -> _Array:
    """Sums of the absolute impulse responses, shape (outputs, inputs), rounded upwards.

    It is the largest ratio of the output's to the input's largest absolute value (Boyd and
    Barratt, Linear Controller Design, section 5.2). The sum ends after N samples with
    q = |A^N| < 1 in the row-sum norm; what is left is at most q/(1-q) sum |C A^i| |B| over i < N.
    Raises `DesignError` for a system that is not stable.
    """
    a, b, c, d = (np.asarray(matrix, dtype=float) for matrix in
                  (system.A, system.B, system.C, system.D))  # fmt: skip
    if not len(a):
        return np.asarray(np.abs(d))
    length, contraction = _contracting_power(a)
    total, rows = np.abs(d), np.zeros(len(c))
    row = c
    for _ in range(length):
        total = total + np.abs(row @ b)
        rows = rows + np.abs(row).sum(axis=1)
        row = row @ a
    largest_input = np.abs(b).max(axis=0)
    rest = contraction / (1 - contraction) * np.outer(rows, largest_input)
    result: _Array = (total + rest) * (1 + 1e-9)
    return result


def _contracting_power(matrix: _Array) -> tuple[int, float]:
    """A power of 2 with a norm of that power of the matrix below 1e-12, and that norm."""
    length, power = 1, matrix
    for _ in range(_MOST_DOUBLINGS):
        norm = float(np.linalg.norm(power, np.inf))
        if norm < _SMALL:
            return length, norm
        if not np.isfinite(norm):
            break
        with np.errstate(over="ignore", invalid="ignore"):
            length, power = 2 * length, power @ power
    radius = float(np.abs(np.linalg.eigvals(matrix)).max())
    raise DesignError(
        f"the loop has no bounded error: a pole lies at distance {radius:.6f} from 0; "
        "the bound needs a stable loop with the plant in it"
    )
