# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a design: named axes with units, margins of the loop as it runs, gain families."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import control
import numpy as np
import pytest

from ravenbrick.control import (
    DesignedLoop,
    DiscretePi,
    Extreme,
    FamilyMember,
    LoopSpecification,
    MonteCarlo,
    Robustness,
    bode_figure,
    gain_family,
    nyquist_figure,
    pi_by_lambda,
    root_locus_figure,
    write_figure,
)
from ravenbrick.control.design import family
from ravenbrick.control.design.schedule_effect import schedule_effect, schedule_figure, timing_row
from ravenbrick.control.estimation.encoder_run import SampleTiming
from ravenbrick.model import IntegrationMethod, SpeedLoop

LOOP = SpeedLoop(2.029, 0.037, 116.0)
WANTED = LoopSpecification(0.4, 0.005, 0.004, 8, 0.0023)
LONG = pytest.mark.long("seconds of root finding")
PI = DiscretePi(0.314445, 0.032221, 0.004, IntegrationMethod.FORWARD_EULER)


@pytest.fixture(scope="module")
def design() -> DesignedLoop:
    """The vehicle's loop, written and read again."""
    own = DesignedLoop(LOOP, WANTED, pi_by_lambda(LOOP, 0.4), control.ss(PI.controller()))
    return DesignedLoop.read(json.loads(json.dumps(own.written())))


def labels(figure: Any) -> list[str]:
    """Labels of all axes that have data, without those that share one."""
    return [
        text
        for axis in figure.axes
        if axis.has_data()
        for text in (axis.get_xlabel(), axis.get_ylabel())
        if text
    ]


def test_every_axis_is_named_with_its_unit(design: DesignedLoop) -> None:
    """In all pictures of a design."""
    member = FamilyMember("lambda", "continuous", design.continuous, 0.4, 0.0)
    names = ("gain", "time_constant", "settling_time")
    arrays = {name: np.array([1.0, 2.0]) for name in names}
    ends = (Extreme(1.0, {}), Extreme(2.0, {}))
    robustness = Robustness(MonteCarlo(arrays, arrays, ()), {"settling_time": ends})
    figures = [
        *design.frequency_figures().values(),
        design.discretisation_figure(),
        design.family_figure([member]),
        design.robustness_figure(robustness),
    ]
    low, high = figures[4].axes[0].get_ylim()
    assert low < 0.0 and 1.02 < high  # the beginning of a response, and the band that it enters
    for figure in figures:
        found = labels(figure)
        assert len(found) >= 2
        for text in found:
            assert text.endswith(")") or text in ("real part of z", "imaginary part of z") or (
                text.startswith("samples of")
            ), text  # fmt: skip


def test_the_margins_in_the_title_are_those_with_window_and_delay(design: DesignedLoop) -> None:
    """The loop as it runs has 80.7 deg, the ideal one 90."""
    title = design.frequency_figures()["bode"].get_suptitle()
    assert "gain margin 22.0 dB" in title
    assert "phase margin 80.7 deg at 8.05 rad/s" in title
    ideal = bode_figure(LOOP.plant() * pi_by_lambda(LOOP, 0.4).controller(), "ideal")
    assert "gain margin none, phase margin 90.0 deg" in ideal.get_suptitle()


def test_a_discrete_controller_is_seen_beside_its_steps(design: DesignedLoop) -> None:
    """Steps above end near the set-point, and what they differ by, below, near nothing."""
    steps, differences = (
        axis for axis in design.discretisation_figure().axes if "V/V" in axis.get_ylabel()
    )
    assert len(steps.lines) == len(differences.lines) + 1
    for axis, end in ((steps, 1.0), (differences, 0.0)):
        for line in axis.lines:
            assert np.asarray(line.get_ydata())[-1] == pytest.approx(end, abs=0.05)


def test_the_bode_plot_draws_what_python_control_computes() -> None:
    """Magnitude and phase of a sampled and of a continuous system."""
    for system in (
        control.tf([0.5], [1.0, -0.7, 0.1], 0.01),
        control.tf([2.0], [0.1, 1.0, 0.0]),
    ):
        figure = bode_figure(system, "loop")
        line, phase = (axis.lines[0] for axis in figure.axes)
        frequencies, decibels = map(np.asarray, line.get_data())
        if system.dt:
            assert frequencies[-1] == pytest.approx(np.pi / system.dt, rel=1e-5)
        wanted = control.frequency_response(system, frequencies)
        assert decibels == pytest.approx(20 * np.log10(wanted.magnitude), abs=1e-6)
        assert np.cos(np.radians(phase.get_ydata())) == pytest.approx(
            np.cos(wanted.phase), abs=1e-6
        )


def test_the_bars_of_both_margins_end_on_the_curves() -> None:
    """Also where the phase at the crossover is not between -180 and 180 degrees."""
    loop = control.sample_system(control.tf([40.0, 80.0], [1.0, 2.0, -30.0, 0.0]), 0.01, "zoh")
    upper, lower = bode_figure(loop, "loop").axes
    for axis in (upper, lower):
        frequencies, curve = map(np.asarray, axis.lines[0].get_data())
        bars = [line for line in axis.lines if line.get_linewidth() == 2]
        for at, ends in (map(np.asarray, line.get_data()) for line in bars):
            level = np.interp(np.log(at[0]), np.log(frequencies), curve)
            assert np.abs(np.asarray(ends) - level).min() < 0.1
    assert [line for line in lower.lines if line.get_linewidth() == 2]


def test_no_member_of_the_family_has_a_negative_gain() -> None:
    """A damping of 0.9 would need one."""
    seen: list[tuple[int, int]] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(family, "IntegrationMethod", ())
        members = family.gain_family(LOOP, WANTED, progress=lambda *n: seen.append(n))
    assert min(min(vars(member.gains).values()) for member in members) >= 0
    assert "damping 0.9" not in [member.design for member in members]
    assert seen[-1] == (len(members), len(members))


def test_the_nyquist_plot_says_how_near_the_curve_comes() -> None:
    """1 / largest sensitivity."""
    system = control.tf([2.0], [0.1, 1.0, 0.0])
    legend = nyquist_figure(system, "loop").axes[0].get_legend_handles_labels()[1]
    frequencies = np.geomspace(0.01, 1000, 20_000)
    sensitivity = control.frequency_response(1 / (1 + system), frequencies).magnitude.max()
    assert f"nearest to -1: {1 / sensitivity:.2f}" in legend


def test_a_schedule_changes_the_loop_as_its_delay_does(design: DesignedLoop) -> None:
    """The design's delay as a schedule is the design; 30 ms make the overdamped loop faster."""
    same = schedule_effect(design, SampleTiming.constant(WANTED.delay))
    assert np.array_equal(same[1].run.speed, same[2].run.speed)
    late = SampleTiming(np.full(2, 1e-4), np.array([0.028, 0.032]))
    cases = schedule_effect(design, late)
    assert cases[2].measures.settling_time < cases[0].measures.settling_time - 0.1
    figure = schedule_figure(cases, late)
    assert labels(figure)[0] == "true speed / set-point"
    assert labels(figure)[-1] == "after the period's begin (us)"
    assert timing_row(late)["delay_us"] == pytest.approx([28000.0, 32000.0])


def test_the_root_locus_ends_where_the_gain_margin_says(design: DesignedLoop) -> None:
    """The squares lie on the unit circle at most; one pair of them on it; still poles are gone."""
    axis = root_locus_figure(design.sampled().open_loop(), "loop").axes[0]
    by_label = {line.get_label(): line for line in axis.lines}
    edge = next(line for name, line in by_label.items() if str(name).startswith("edge"))
    radius = np.hypot(*edge.get_data())
    assert radius.max() == pytest.approx(1.0, abs=1e-4)
    present = by_label["the design (factor 1)"]
    poles = np.asarray(present.get_xdata()) + 1j * np.asarray(present.get_ydata())
    assert len(poles) < design.sampled().open_loop().nstates
    assert np.abs(poles).max() < 1.0


@LONG
def test_each_integrator_has_gains_that_settle_in_time_with_and_without_delay() -> None:
    """Exactly; the published ones among them; progress counts to the end."""
    seen: list[tuple[int, int]] = []
    members = gain_family(LOOP, WANTED, (), lambda done, total: seen.append((done, total)))
    assert seen[-1] == (len(members), len(members)) == (7, 7)
    for member in members:
        assert member.settling_time == pytest.approx(0.4, abs=1e-6)
        assert member.overshoot < 0.005
    found = {(m.design, m.where): m.gains for m in members}
    assert found["lambda", "continuous"].proportional == pytest.approx(0.361074, abs=1e-6)
    assert found["lambda", "continuous"].integral == pytest.approx(9.758762, abs=1e-6)
    direct = found["forward euler", "sampled, ideal speed"]
    assert (direct.proportional, direct.integral) == pytest.approx((0.373588, 9.570341), abs=1e-5)


@LONG
def test_tolerances_are_sampled_with_progress(design: DesignedLoop) -> None:
    """The worst case encloses the samples, and the share done only grows."""
    seen: list[tuple[int, int]] = []
    found = design.robustness(lambda done, total: seen.append((done, total)), samples=4)
    shares = [done / total for done, total in seen]
    assert shares == sorted(shares) and shares[-1] == 1.0
    for row in found.rows():
        assert float(row["least"]) <= float(row["median"]) <= float(row["largest"])
    low, high = found.extremes["settling_time"]
    assert low.value < 0.3 and high.value > 0.5


def test_a_picture_has_the_same_bytes_each_time(design: DesignedLoop, tmp_path: Path) -> None:
    """No dates, no random names."""
    for name in ("first.svg", "second.svg"):
        write_figure(nyquist_figure(design.sampled().open_loop(), "loop"), tmp_path / name)
    assert (tmp_path / "first.svg").read_bytes() == (tmp_path / "second.svg").read_bytes()
    assert math.isfinite((tmp_path / "first.svg").stat().st_size)
