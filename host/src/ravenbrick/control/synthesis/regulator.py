# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State feedback, observers and their union, on python-control's systems."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model.lazy import control

__all__ = [
    "Observer",
    "StateFeedback",
    "dlqr",
    "kalman",
    "lqg",
    "lqr",
    "observer_by_poles",
    "observer_system",
    "with_integrators",
]

_Array = npt.NDArray[np.float64]
_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """u = -gain x: `gain` has shape (inputs, states), `poles` are those of the closed loop."""

    gain: _Array
    poles: npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Observer:
    """Estimate of the state: x' = A x + B u + gain (y - C x - D u), x' the derivative or next x.

    `gain` has shape (states, outputs), `poles` are those of the estimation error.
    """

    gain: _Array
    poles: npt.NDArray[np.complex128]


def with_integrators(plant: control.StateSpace, rows: Sequence[Sequence[float]]) -> (
    control.StateSpace
):  # fmt: skip
    """A continuous plant with integrals of linear combinations of its states as further states.

    `rows` has shape (integrals, states). All states are outputs.
    """
    _require(plant, discrete=False)
    chosen = np.atleast_2d(np.asarray(rows, dtype=float))
    count = len(chosen)
    if chosen.shape[1] != plant.nstates:
        raise DesignError(
            f"the rows to integrate must have {plant.nstates} numbers, one per state, "
            f"not {chosen.shape[1]}"
        )
    order = plant.nstates + count
    matrix = np.zeros((order, order))
    matrix[: plant.nstates, : plant.nstates] = plant.A
    matrix[plant.nstates :, : plant.nstates] = chosen
    entry = np.vstack([plant.B, np.zeros((count, plant.ninputs))])
    return control.ss(matrix, entry, np.eye(order), np.zeros((order, plant.ninputs)))


def lqr(
    plant: control.StateSpace, state_weights: npt.ArrayLike, input_weights: npt.ArrayLike
) -> StateFeedback:
    """Continuous plant: the gain that minimises the integral of x'Qx + u'Ru."""
    _require(plant, discrete=False)
    return _optimal(plant, state_weights, input_weights, control.lqr)


def dlqr(
    plant: control.StateSpace, state_weights: npt.ArrayLike, input_weights: npt.ArrayLike
) -> StateFeedback:
    """Discrete plant: the gain that minimises the sum of x'Qx + u'Ru over all samples."""
    _require(plant, discrete=True)
    return _optimal(plant, state_weights, input_weights, control.dlqr)


def observer_by_poles(plant: control.StateSpace, poles: Sequence[complex]) -> Observer:
    """The observer whose error has these poles, one per state (in z for a discrete plant)."""
    if len(poles) != plant.nstates:
        raise DesignError(f"{plant.nstates} states need as many observer poles, not {len(poles)}")
    _require_rank(control.obsv(plant.A, plant.C), "observable from its outputs")
    try:
        gain = np.asarray(control.place(plant.A.T, plant.C.T, list(poles))).T
    except ValueError as error:
        raise DesignError(f"no observer has the poles {list(poles)}: {error}") from error
    return Observer(gain, np.linalg.eigvals(plant.A - gain @ plant.C))


def kalman(
    plant: control.StateSpace,
    process_noise: npt.ArrayLike,
    measurement_noise: npt.ArrayLike,
    noise_input: npt.ArrayLike | None = None,
) -> Observer:
    """Steady Kalman filter, as a predictor for a discrete plant.

    Covariances of white noises: `process_noise` enters by `noise_input` (default: each state),
    `measurement_noise` is added to the outputs; both per sample, or densities if continuous.
    """
    entry = np.eye(plant.nstates) if noise_input is None else np.asarray(noise_input, dtype=float)
    process = _weights(process_noise, entry.shape[1], "process noise", positive=False)
    measured = _weights(measurement_noise, plant.noutputs, "measurement noise", positive=True)
    solve = control.dlqe if control.isdtime(plant, strict=True) else control.lqe
    try:
        gain, _, _ = solve(plant.A, entry, plant.C, process, measured)
    except (ValueError, np.linalg.LinAlgError, control.ControlDimension) as error:
        raise DesignError(f"no steady Kalman filter: {error}") from error
    gain = np.asarray(gain)
    return Observer(gain, _stable(plant.A - gain @ plant.C, plant, "Kalman filter"))


def observer_system(plant: control.StateSpace, observer: Observer) -> control.StateSpace:
    """The observer as a system: from the plant's inputs, then its outputs, to the estimated state.

    Of a discrete plant each estimate becomes a block by `state_space_block(name, system, output)`.
    """
    gain = observer.gain
    matrix = plant.A - gain @ plant.C
    entry = np.hstack([plant.B - gain @ plant.D, gain])
    order = plant.nstates
    return control.ss(matrix, entry, np.eye(order), np.zeros((order, entry.shape[1])), plant.dt)


def lqg(
    plant: control.StateSpace, feedback: StateFeedback, observer: Observer
) -> control.StateSpace:
    """Feedback of the estimated state: a system from the plant's outputs to its inputs.

    The sign is in it: connect its output to the plant's input as it is. The closed loop has the
    poles of both designs (separation principle).
    """
    gain, correction = feedback.gain, observer.gain
    if gain.shape != (plant.ninputs, plant.nstates):
        raise DesignError(
            f"the feedback must have shape {(plant.ninputs, plant.nstates)}, not {gain.shape}"
        )
    if correction.shape != (plant.nstates, plant.noutputs):
        raise DesignError(
            f"the observer must have shape {(plant.nstates, plant.noutputs)}, "
            f"not {correction.shape}"
        )
    matrix = plant.A - plant.B @ gain - correction @ (plant.C - plant.D @ gain)
    still = np.zeros((plant.ninputs, plant.noutputs))
    return control.ss(matrix, correction, -gain, still, plant.dt)


def _optimal(
    plant: control.StateSpace,
    state_weights: npt.ArrayLike,
    input_weights: npt.ArrayLike,
    solve: Callable[..., tuple[_Array, _Array, _Array]],
) -> StateFeedback:
    states = _weights(state_weights, plant.nstates, "state weights", positive=False)
    inputs = _weights(input_weights, plant.ninputs, "input weights", positive=True)
    try:
        gain, _, _ = solve(plant.A, plant.B, states, inputs)
    except (ValueError, np.linalg.LinAlgError, control.ControlDimension) as error:
        raise DesignError(f"no optimal feedback: {error}; is the plant controllable?") from error
    gain = np.asarray(gain)
    return StateFeedback(gain, _stable(plant.A - plant.B @ gain, plant, "feedback"))


def _stable(matrix: _Array, plant: control.StateSpace, what: str) -> npt.NDArray[np.complex128]:
    poles = np.linalg.eigvals(matrix).astype(np.complex128)
    discrete = control.isdtime(plant, strict=True)
    if np.any(np.abs(poles) >= 1.0) if discrete else np.any(poles.real >= 0.0):
        raise DesignError(
            f"the {what} leaves a pole that is not stable ({poles}); weigh each state that the "
            "plant does not bring to rest by itself"
        )
    return poles


def _weights(value: npt.ArrayLike, size: int, what: str, *, positive: bool) -> _Array:
    """A symmetric matrix; a vector is its diagonal."""
    matrix = np.asarray(value, dtype=float)
    matrix = np.diag(matrix) if matrix.ndim == 1 else np.atleast_2d(matrix)
    if matrix.shape != (size, size):
        raise DesignError(f"the {what} must have shape {(size, size)}, not {matrix.shape}")
    if not np.allclose(matrix, matrix.T):
        raise DesignError(f"the {what} must be symmetric")
    least = float(np.linalg.eigvalsh(matrix).min())
    if (positive and least <= 0) or least < -_TOLERANCE * np.abs(matrix).max():
        raise DesignError(f"the {what} must be positive, but an eigenvalue is {least:.6g}")
    return matrix


def _require(plant: control.StateSpace, *, discrete: bool) -> None:
    if control.isdtime(plant, strict=True) != discrete:
        wanted, use = ("discrete", "lqr") if discrete else ("continuous", "dlqr")
        raise DesignError(f"the plant must be {wanted}; for the other kind use {use}")


def _require_rank(matrix: _Array, what: str) -> None:
    rank = int(np.linalg.matrix_rank(matrix))
    if rank < matrix.shape[1]:
        raise DesignError(f"only {rank} of the plant's {matrix.shape[1]} states are {what}")
