# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Random systems against SciPy's and python-control's own results."""

from __future__ import annotations

import control
import numpy as np
import pytest
from scipy import signal

from ravenbrick.control import DiscretisationMethod, discretise, margins
from ravenbrick.model import (
    Block,
    DataType,
    Diagram,
    Execution,
    Inport,
    Outport,
    state_space_block,
    transfer_function_block,
)

SEEDS = range(4)
SCIPY_NAMES = {
    DiscretisationMethod.ZERO_ORDER_HOLD: "zoh",
    DiscretisationMethod.TUSTIN: "bilinear",
    DiscretisationMethod.FORWARD_EULER: "euler",
    DiscretisationMethod.BACKWARD_EULER: "backward_diff",
    DiscretisationMethod.FIRST_ORDER_HOLD: "foh",
    DiscretisationMethod.IMPULSE_INVARIANT: "impulse",
}


def random_poles(random: np.random.Generator, count: int) -> np.ndarray:
    """Stable, some in pairs."""
    real = -random.uniform(0.5, 20.0, count % 2)
    pairs = -random.uniform(0.5, 20.0, count // 2) + 1j * random.uniform(0.5, 20.0, count // 2)
    return np.concatenate([real, pairs, pairs.conj()])


def random_system(seed: int) -> control.TransferFunction:
    """Second to fourth order, strictly proper."""
    random = np.random.default_rng(seed)
    order = int(random.integers(2, 5))
    numerator = random.uniform(-1.0, 1.0, order)
    return control.tf(numerator, np.real(np.poly(random_poles(random, order))))


def through(block: Block, values: np.ndarray) -> np.ndarray:
    """The outputs of a block of the diagram in double precision."""
    diagram = Diagram("one", 0.01)
    wide = DataType.REAL64
    diagram.connect_chain(
        diagram.add(Inport("In", wide)), diagram.add(block), diagram.add(Outport("Out", wide))
    )
    execution = Execution(diagram)
    return np.array([execution.step({"In": float(v)})["Out"] for v in values])


@pytest.mark.parametrize("seed", SEEDS)
def test_discretisation_is_scipy_s(seed: int) -> None:
    """Each method that SciPy has, as frequency responses."""
    system = random_system(seed)
    points = np.exp(1j * np.geomspace(0.1, 300, 50) * 0.01)
    for method, name in SCIPY_NAMES.items():
        num, den, _ = signal.cont2discrete((system.num[0][0], system.den[0][0]), 0.01, name)
        wanted = np.polyval(np.squeeze(num), points) / np.polyval(den, points)
        assert discretise(system, 0.01, method)(points) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_margins_of_discrete_loops_are_python_control_s(seed: int) -> None:
    """Among the crossings of its frequency response, the nearest to -1 in phase.

    Its other method, by roots of polynomials, is off by some per cent on these systems.
    """
    system = control.sample_system(random_system(seed), 0.01, "zoh")
    system = system * (3.0 / abs(complex(system(np.exp(0.02j)))))
    found = margins(system)
    _, phases, _, _, crossings, _ = control.stability_margins(system, returnall=True, method="frd")
    assert found.crossover == pytest.approx(
        crossings[_nearest(found.crossover, crossings)], rel=1e-3
    )
    wrapped = (np.asarray(phases) + 180) % 360 - 180
    assert abs(found.phase_margin_deg) == pytest.approx(np.abs(wrapped).min(), abs=0.1)


def _nearest(value: float, values: np.ndarray) -> int:
    return int(np.abs(np.asarray(values) - value).argmin())


@pytest.mark.parametrize("seed", SEEDS)
def test_a_transfer_function_block_filters_as_scipy_does(seed: int) -> None:
    """In double precision, step by step."""
    system = control.sample_system(random_system(seed), 0.01, "zoh")
    values = np.random.default_rng(seed).uniform(-5, 5, 80)
    block = transfer_function_block("B", system, DataType.REAL64)
    wanted = signal.lfilter(*_padded(system), values)
    assert through(block, values) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def _padded(system: control.TransferFunction) -> tuple[np.ndarray, np.ndarray]:
    numerator, denominator = system.num[0][0], system.den[0][0]
    return np.pad(numerator, (len(denominator) - len(numerator), 0)), denominator


@pytest.mark.parametrize("seed", SEEDS)
def test_a_state_space_block_answers_as_python_control_does(seed: int) -> None:
    """A random stable system with feed-through."""
    random = np.random.default_rng(seed)
    matrix = random.uniform(-1, 1, (3, 3))
    matrix *= 0.9 / np.abs(np.linalg.eigvals(matrix)).max()
    system = control.ss(matrix, random.uniform(-1, 1, (3, 1)), random.uniform(-1, 1, (1, 3)),
                        [[0.3]], 0.01)  # fmt: skip
    values = random.uniform(-5, 5, 80)
    wanted = control.forced_response(system, np.arange(80) * 0.01, values).outputs
    block = state_space_block("B", system, data_type=DataType.REAL64)
    assert through(block, values) == pytest.approx(wanted, rel=1e-9, abs=1e-9)
