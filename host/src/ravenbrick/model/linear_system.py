# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A linear system as four matrices, for what needs no more: python-control loads slowly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ravenbrick.model.lazy import control

__all__ = ["LinearSystem"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """dx/dt = A x + B u, or x(k + 1) = A x(k) + B u(k); y = C x + D u.

    `dt` is the sample time in s, 0 in continuous time. Names are those of python-control.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float = 0.0

    @classmethod
    def of(cls, system: Any) -> LinearSystem:
        """The same system, which may be one of python-control's."""
        if isinstance(system, cls):
            return system
        realised = control.ss(system)
        a, b, c, d = (np.asarray(getattr(realised, name), dtype=float) for name in "ABCD")
        return cls(a, b, c, d, float(realised.dt or 0.0))

    def for_control(self) -> control.StateSpace:
        """For python-control."""
        return control.ss(self.A, self.B, self.C, self.D, self.dt)

    @property
    def nstates(self) -> int:
        """Number of states."""
        return len(self.A)

    @property
    def ninputs(self) -> int:
        """Number of inputs."""
        return int(self.D.shape[1])

    def isdtime(self, strict: bool = False) -> bool:
        """Whether it is a sampled system; each is either that or continuous."""
        return self.dt > 0

    def __mul__(self, first: LinearSystem) -> LinearSystem:
        """This system behind `first`, whose states come first."""
        upper = np.hstack([first.A, np.zeros((first.nstates, self.nstates))])
        return LinearSystem(
            np.vstack([upper, np.hstack([self.B @ first.C, self.A])]),
            np.vstack([first.B, self.B @ first.D]),
            np.hstack([self.D @ first.C, self.C]),
            self.D @ first.D,
            self.dt,
        )

    def __call__(self, points: npt.ArrayLike) -> Any:
        """C (p I - A)^-1 B + D of one input and output at complex points, with their shape."""
        at = np.asarray(points, dtype=complex)[..., np.newaxis, np.newaxis]
        states = np.linalg.solve(at * np.eye(self.nstates) - self.A, self.B.astype(complex))
        return (self.C @ states + self.D)[..., 0, 0]
