# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a delay costs a loop, against the stability of the delayed loop itself."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import control
import numpy as np
import pytest

from ravenbrick.control import write_loop_results
from ravenbrick.errors import DesignError
from ravenbrick.timing.results.phase_margin import Loop, phase_margin, read_loop

SAMPLE_TIME = 0.004


def integrator() -> control.StateSpace:
    """20 / s, sampled."""
    return control.sample_system(control.ss(control.tf([20.0], [1.0, 0.0])), SAMPLE_TIME, "zoh")


def inverted() -> control.StateSpace:
    """10 (s + 5) / (s^2 - 9), unstable alone, sampled."""
    plant = control.tf([10.0, 50.0], [1.0, 0.0, -9.0])
    return control.sample_system(control.ss(plant), SAMPLE_TIME, "zoh")


def resonant() -> control.StateSpace:
    """30 s / (s^2 + 2 s + 400), sampled: crosses upwards with a lead, then downwards."""
    plant = control.tf([30.0, 0.0], [1.0, 2.0, 400.0])
    return control.sample_system(control.ss(plant), SAMPLE_TIME, "zoh")


def left_behind(open_loop: control.StateSpace, folder: Path) -> Path:
    """What a design.py with this loop writes."""
    file = folder / "design.json"
    continuous = control.feedback(control.ss(control.tf([20.0], [1.0, 0.0])))
    loops = (continuous, control.feedback(integrator()))
    write_loop_results(file, "loop", loops, {}, 2.0, open_loop)
    return file


@pytest.mark.parametrize("make", [integrator, inverted, resonant])
def test_the_loop_gets_unstable_where_the_margin_ends(
    make: Callable[[], control.StateSpace], tmp_path: Path
) -> None:
    """Delays of whole samples: the eigenvalues of the closed loop say from which one on."""
    open_loop = make()
    loop = read_loop(left_behind(open_loop, tmp_path))
    assert loop is not None

    def is_stable(samples: int) -> bool:
        shift = np.eye(samples, k=-1)
        line = control.ss(shift, np.eye(samples)[:, :1], np.eye(samples)[-1:], 0, SAMPLE_TIME)
        return bool(max(abs(control.feedback(line * open_loop).poles())) < 1)

    first_unstable = next(count for count in range(1, 100) if not is_stable(count))
    assert first_unstable > 3
    assert phase_margin(loop, (first_unstable - 1) * SAMPLE_TIME) > 0
    assert phase_margin(loop, first_unstable * SAMPLE_TIME) < 0


def test_a_delay_costs_its_product_with_the_crossover_beyond_the_designed_one() -> None:
    loop = Loop(((10.0, 60.0),), 0.002)
    assert phase_margin(loop, 0.002) == 60.0
    assert phase_margin(loop, 0.012) == pytest.approx(60.0 - math.degrees(0.1))


def test_a_design_without_a_loop_has_none_and_a_broken_one_is_named(tmp_path: Path) -> None:
    file = tmp_path / "design.json"
    assert read_loop(file) is None
    file.write_text(json.dumps({"figures": {}}))
    assert read_loop(file) is None
    file.write_text(json.dumps({"figures": {}, "loop": {"open_loop": {}}}))
    with pytest.raises(DesignError, match=r"design\.json: not a design .*run 'ravenbrick design'"):
        read_loop(file)
