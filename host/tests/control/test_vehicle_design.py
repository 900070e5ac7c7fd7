# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle's design.py and what it leaves."""

from __future__ import annotations

import importlib.util
import json
import math
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import control
import numpy as np
import pytest

from ravenbrick.control import Design
from ravenbrick.control.design.responses import write_loop_results
from ravenbrick.trace.design import read_design

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """design.py as a module."""
    specification = importlib.util.spec_from_file_location("design", VEHICLE / "design.py")
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def design(script: ModuleType) -> Design:
    """The finished design."""
    result = script.design()
    assert isinstance(result, Design)
    return result


def test_the_design_settles_in_400_ms_with_almost_no_overshoot(design: Design) -> None:
    """With rounded gains, window and delay: 400 ms to 10 us; with encoder counts to 10 ms."""
    assert design.sampled_metrics.settling_time == pytest.approx(0.4, abs=1e-5)
    assert design.sampled_metrics.overshoot == 0.0
    assert design.estimator.measures.settling_time == pytest.approx(0.4, abs=0.01)
    assert design.estimator.measures.overshoot < 0.005


def test_the_window_quietens_what_the_plain_difference_would_give(design: Design) -> None:
    """2.155 V quantum and 0.78 V chatter become an eighth of both."""
    plain, chosen = design.estimators
    assert plain.quantum == pytest.approx(2.155, abs=1e-3)
    assert plain.measures.control_peak_to_peak == pytest.approx(0.78, abs=0.01)
    assert chosen.quantum == pytest.approx(plain.quantum / 8)
    assert chosen.measures.control_peak_to_peak < plain.measures.control_peak_to_peak / 8
    assert chosen.measures.ripple < plain.measures.ripple / 5


def test_the_generated_files_are_those_of_the_design(
    script: ModuleType, design: Design, tmp_path: Path
) -> None:
    """Generating again gives the same files, byte for byte and no others."""
    script.generate(design, tmp_path)
    committed = {path.name: path.read_bytes() for path in (VEHICLE / "generated").iterdir()}
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == committed


def test_the_report_can_read_the_results(design: Design, tmp_path: Path) -> None:
    """The JSON holds both responses and plain numbers."""
    path = tmp_path / "design.json"
    design.write_results(path)
    read = read_design(path)
    assert read.responses["continuous"].settling_time == pytest.approx(0.4)
    assert read.responses["sampled"].values[-1] == pytest.approx(1.0, abs=0.01)
    assert all(isinstance(value, float) for value in read.figures.values())
    rows = json.loads(path.read_text())["estimators"]
    assert [row["window"] for row in rows] == [1, 8]


def test_the_responses_are_arrays_over_time(design: Design) -> None:
    """Times rise evenly and lengths agree."""
    for response in (design.continuous_response, design.sampled_response):
        assert response.time.shape == response.output.shape
        assert np.all(np.diff(response.time) > 0)


def test_of_any_loop_the_settling_time_is_that_of_its_samples(tmp_path: Path) -> None:
    """1 / (T s + 1) is within 2 % after T ln 50, to one sample; a double one with 1.6 overshoots
    by exp(-pi z / sqrt(1 - z^2)), z = 0.8."""
    lag, swing = control.ss(control.tf([1.0], [0.1, 1.0])), control.tf([1.0], [0.01, 0.16, 1.0])
    write_loop_results(tmp_path / "d.json", "d", (lag, control.ss(swing)), {}, 2.0)
    first, second = (
        json.loads((tmp_path / "d.json").read_text())[k] for k in ("continuous", "sampled")
    )
    assert 0.0 <= first["settling_time"] - 0.1 * math.log(50) <= 0.004
    assert second["overshoot"] == pytest.approx(math.exp(-math.pi * 0.8 / 0.6), abs=1e-4)


def test_the_continuous_response_is_that_of_the_closed_loop(design: Design) -> None:
    """As python-control computes it from the transfer functions."""
    found = design.continuous_response
    closed = design.loop.closed_loop(design.continuous.controller())
    expected = control.step_response(closed, found.time).outputs
    assert found.output == pytest.approx(expected, abs=1e-9)


def test_a_design_without_a_window_runs_with_the_plain_difference(design: Design) -> None:
    """Its speeds are whole counts in one sample: multiples of 1 degree in 4 ms, in V."""
    plain = replace(design, specification=replace(design.specification, window=None))
    quanta = plain.encoder_response.measured / (1.0 / 0.004 / 116.0)
    assert quanta == pytest.approx(np.round(quanta), abs=1e-6) and set(np.round(quanta)) >= {1.0}
