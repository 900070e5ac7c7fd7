# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Our own linear systems beside python-control's."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import control
import numpy as np
import pytest

from ravenbrick.control import DiscretePi, PiGains, step_metrics
from ravenbrick.model import NXT_MOTOR, IntegrationMethod, LinearSystem, SpeedLoop


@pytest.mark.parametrize("seed", range(5))
def test_series_and_response_are_those_of_python_control(seed: int) -> None:
    np.random.seed(seed)
    first, second = (control.drss(seed + order, 1, 1) for order in (1, 3))
    points = np.exp(1j * np.linspace(0.1, 3.0, 20))
    own = LinearSystem.of(second) * LinearSystem.of(first)
    both = second * first
    assert np.allclose(own(points), np.squeeze(both(points)))
    assert np.allclose(own.for_control().poles(), both.poles())
    assert own.isdtime() and own.dt == both.dt


def test_a_loop_in_matrices_is_the_loop_of_transfer_functions() -> None:
    loop = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
    gains = PiGains(0.3, 12.0)
    own = step_metrics(gains.closed_loop(loop))
    wanted = step_metrics(loop.closed_loop(gains.controller()))
    assert own.settling_time == pytest.approx(wanted.settling_time, abs=1e-9)
    assert own.overshoot == pytest.approx(wanted.overshoot, abs=1e-9)


def test_systems_are_compared_as_objects() -> None:
    """Matrices are neither equal nor unequal as a whole; a system can be a key."""
    system = LinearSystem.of(control.drss(2, 1, 1))
    twin = replace(system)
    assert system == system and system != twin and len({system, twin}) == 2


@pytest.mark.parametrize("method", IntegrationMethod)
def test_a_discrete_controller_in_matrices_is_its_transfer_function(
    method: IntegrationMethod,
) -> None:
    pi = DiscretePi(0.3, 0.03, 0.004, method)
    points = np.exp(1j * np.linspace(0.1, 3.0, 20))
    assert np.allclose(pi.system()(points), np.squeeze(pi.controller()(points)))


def test_slow_libraries_are_loaded_at_their_first_use() -> None:
    """A child that only names them has executed none of them, and then one."""
    program = (
        "import sys\nfrom ravenbrick.model.lazy import control, optimize, stats\n"
        "inner = {'control.statesp', 'scipy.optimize._optimize', 'scipy.stats._stats_py'}\n"
        "assert not inner & set(sys.modules)\n"
        "assert optimize.brentq(lambda x: x - 1.0, 0.0, 2.0) == 1.0\n"
        "assert inner & set(sys.modules) == {'scipy.optimize._optimize'}\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
