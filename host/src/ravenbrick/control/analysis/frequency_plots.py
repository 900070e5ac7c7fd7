# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bode, Nyquist and root-locus plots of an open loop, with its margins."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ravenbrick.control.analysis.flow import Array
from ravenbrick.control.analysis.metrics import Margins, margins
from ravenbrick.model.lazy import control, optimize

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "bode_figure",
    "frequency_response",
    "new_figure",
    "nyquist_figure",
    "plane_grid",
    "root_locus_figure",
    "unwrapped",
]

_POINTS = 600
_DECADES = 3.5
_LOCUS_STEPS = 400
_LOWEST_DB = -80
_STILL = 1e-6
_CROWDED = 0.1
_OWN, _OTHER, _MARK, _FAINT = "#1f5fa8", "#9a6a00", "#b3372f", "#bbbbbb"


def new_figure(width: float, height: float, rows: int = 1, columns: int = 1) -> Any:
    """Figure (inches) and its axes, with a grid, without a window."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    for axis in axes.flat:
        axis.grid(True, color="#e3e3e3", linewidth=0.7)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
    return figure, axes


def frequency_response(system: control.lti.LTI, frequencies: Array) -> Any:
    """Of first input and output at these frequencies (rad/s)."""
    realised = control.ss(system)
    dt = realised.dt if control.isdtime(realised, strict=True) else None
    points = np.exp(1j * frequencies * dt) if dt else 1j * frequencies
    identity = np.eye(realised.nstates)
    return np.array(
        [
            (realised.C @ np.linalg.solve(p * identity - realised.A, realised.B) + realised.D)[0, 0]
            for p in points
        ]
    )


def _highest(open_loop: control.lti.LTI, found: Margins) -> float:
    if control.isdtime(open_loop, strict=True):
        return float(math.pi / open_loop.dt)
    return 100.0 * (found.crossover if math.isfinite(found.crossover) else 10.0)


def _described(found: Margins) -> str:
    gain = found.gain_margin
    decibels = f"{20 * math.log10(gain):.1f} dB" if 0 < gain < math.inf else "none"
    if found.lowest_gain > 0 and found.highest_gain < math.inf:
        decibels += f" (factors {found.lowest_gain:.3g} to {found.highest_gain:.3g})"
    phase = found.phase_margin_deg
    degrees = f"{phase:.1f} deg at {found.crossover:.3g} rad/s" if math.isfinite(phase) else "none"
    return f"gain margin {decibels}, phase margin {degrees}"


def bode_figure(
    open_loop: control.lti.LTI, title: str, ideal: control.lti.LTI | None = None
) -> Figure:
    """Magnitude and phase over the frequency, crossovers marked.

    `ideal` is drawn beside it: the loop without sampling, estimator and delay.
    """
    found = margins(open_loop)
    highest = _highest(open_loop, found)
    frequencies = np.geomspace(highest * 10**-_DECADES, highest * (1 - 1e-6), _POINTS)
    figure, axes = new_figure(8, 6, rows=2)
    upper, lower = axes[:, 0]
    curves = [(open_loop, "the loop as it runs", _OWN, "-")]
    curves += [(ideal, "without sampling and delay", _OTHER, "--")] if ideal is not None else []
    for system, label, colour, style in curves:
        values = frequency_response(system, frequencies)
        upper.semilogx(frequencies, 20 * np.log10(np.abs(values)), style, color=colour, label=label)
        lower.semilogx(frequencies, unwrapped(values), style, color=colour)
    _mark_margins(upper, lower, open_loop, found, frequencies)
    upper.set_ylim(bottom=max(upper.get_ylim()[0], _LOWEST_DB))
    upper.set_ylabel("magnitude (dB)")
    lower.set_ylabel("phase (deg)")
    lower.set_xlabel("frequency (rad/s)")
    if control.isdtime(open_loop, strict=True):
        for axis in (upper, lower):
            axis.axvline(highest, color=_FAINT, linewidth=1)
        lower.annotate("half the sampling rate ", (highest, lower.get_ylim()[0]), ha="right",
                       va="bottom", fontsize=8)  # fmt: skip
    upper.legend(fontsize=9, loc="lower left")
    figure.suptitle(f"{title}: {_described(found)}", fontsize=10)
    return figure  # type: ignore[no-any-return]


def _mark_margins(
    upper: Axes, lower: Axes, open_loop: control.lti.LTI, found: Margins, frequencies: Array
) -> None:
    upper.axhline(0, color=_FAINT, linewidth=1)
    values = frequency_response(open_loop, frequencies)
    if math.isfinite(found.crossover):
        at = found.crossover
        for axis in (upper, lower):
            axis.axvline(at, color=_MARK, linewidth=0.8, linestyle=":")
        top = float(np.interp(math.log(at), np.log(frequencies), unwrapped(values)))
        foot = top - found.phase_margin_deg
        lower.axhline(foot, color=_FAINT, linewidth=1)
        lower.plot([at, at], [foot, top], color=_MARK, linewidth=2)
    if frequencies[0] <= found.phase_crossover <= frequencies[-1]:
        at = found.phase_crossover
        upper.plot([at, at], [-20 * math.log10(found.gain_margin), 0], color=_MARK, linewidth=2)


def unwrapped(values: Array) -> Any:
    """Continuous phase (deg) of a response, begun near -90."""
    phase = np.degrees(np.unwrap(np.angle(values)))
    return phase - 360 * round((phase[0] + 90) / 360)


def plane_grid(axis: Axes, sample_time: float | None) -> None:
    """Lines of equal damping ratio (0.1 to 0.9) and of equal natural frequency behind poles.

    In z, with `sample_time` (s), to half the sampling rate in tenths; in s within the axis' limits.
    """
    damping = np.arange(1, 10) / 10
    style: dict[str, Any] = {"color": _FAINT, "linewidth": 0.6, "zorder": 0}
    label: dict[str, Any] = {"fontsize": 7, "color": "#777777", "clip_on": True}
    if sample_time is None:
        left, reach = min(axis.get_xlim()[0], -1e-9), max(abs(y) for y in axis.get_ylim())
        radius = math.hypot(left, reach)
        ends = radius * np.exp(1j * (math.pi - np.arccos(damping)))
        for ratio, end in zip(damping, ends, strict=True):
            axis.plot([end.real, 0, end.real], [end.imag, 0, -end.imag], **style)
            axis.text(0.6 * end.real, 0.6 * end.imag, f"{ratio:.1f}", **label)
        for natural in radius * np.arange(1, 11) / 10:
            arc = natural * np.exp(1j * np.linspace(math.pi / 2, 1.5 * math.pi, 121))
            axis.plot(arc.real, arc.imag, **style)
            axis.text(0, natural, f"{natural:.3g}/s", **label)
        axis.set_xlim(left, axis.get_xlim()[1])
        axis.set_ylim(-reach, reach)
        return
    for ratio in damping:
        turn = np.linspace(0, math.pi, 181)
        spiral = np.exp(turn * (-ratio / math.sqrt(1 - ratio**2) + 1j))
        for part in (spiral, spiral.conj()):
            axis.plot(part.real, part.imag, **style)
        axis.text(spiral[60].real, spiral[60].imag, f"{ratio:.1f}", **label)
    for share in np.arange(1, 11) / 10:
        angle = np.linspace(math.pi / 2, math.pi, 91)
        curve = np.exp(share * math.pi * np.exp(1j * angle))
        for part in (curve, curve.conj()):
            axis.plot(part.real, part.imag, **style)
        axis.text(curve[0].real, curve[0].imag, f"{share * math.pi / sample_time:.3g}/s", **label)
    circle = np.exp(1j * np.linspace(0, 2 * math.pi, 361))
    axis.plot(circle.real, circle.imag, color=_FAINT, linewidth=1)
    axis.set_aspect("equal")


def nyquist_figure(
    open_loop: control.lti.LTI, title: str, ideal: control.lti.LTI | None = None
) -> Figure:
    """The open loop's response around -1, and how near it comes."""
    found = margins(open_loop)
    highest = _highest(open_loop, found)
    frequencies = np.geomspace(highest * 1e-4, highest * (1 - 1e-6), 4 * _POINTS)
    figure, axes = new_figure(6.5, 6)
    axis = axes[0, 0]
    angle = np.linspace(0, 2 * math.pi, 361)
    axis.plot(np.cos(angle), np.sin(angle), color=_FAINT, linewidth=1, label="unit circle")
    if ideal is not None:
        values = frequency_response(ideal, frequencies)
        axis.plot(values.real, values.imag, "--", color=_OTHER, label="without sampling and delay")
    values = frequency_response(open_loop, frequencies)
    axis.plot(values.real, values.imag, color=_OWN, label="the loop as it runs")
    axis.plot(values.real, -values.imag, color=_OWN, linewidth=0.7, linestyle=":")
    nearest = int(np.abs(values + 1).argmin())
    distance = float(abs(values[nearest] + 1))
    point = values[nearest]
    axis.plot([-1, point.real], [0, point.imag], color=_MARK, linewidth=1.5,
              label=f"nearest to -1: {distance:.2f}")  # fmt: skip
    axis.plot([-1], [0], "+", color=_MARK, markersize=12, markeredgewidth=2)
    axis.set_xlim(-2, 1.5)
    axis.set_ylim(-2, 2)
    axis.set_aspect("equal")
    axis.set_xlabel("real part of the open loop (V/V)")
    axis.set_ylabel("imaginary part of the open loop (V/V)")
    axis.legend(fontsize=9, loc="upper right")
    figure.suptitle(f"{title}: {_described(found)}", fontsize=10)
    return figure  # type: ignore[no-any-return]


def root_locus_figure(open_loop: control.lti.LTI, title: str) -> Figure:
    """Closed-loop poles while one factor multiplies the loop's gain, from 0 to past stability.

    Poles that do not move are cancelled by zeros and left out. Slow poles of a discrete loop crowd
    around z = 1: a second picture enlarges them.
    """
    found = margins(open_loop)
    edges = [edge for edge in (found.lowest_gain, found.highest_gain) if 0 < edge < math.inf]
    most = max(edges, default=10.0)
    grid = np.geomspace(1e-3, 1.3 * max(most, 2.0), _LOCUS_STEPS)
    factors = np.unique(np.concatenate([[0.0, 1.0, *edges], grid]))
    branches = _branches(control.ss(open_loop), factors)
    branches = branches[:, np.abs(branches - branches[0]).max(axis=0) > _STILL]
    discrete = control.isdtime(open_loop, strict=True)
    present = branches[np.searchsorted(factors, 1.0)]
    near = np.abs(np.concatenate([branches[0], present]) - 1)
    crowd = near[near < _CROWDED] if discrete else near[:0]
    columns = 2 if len(crowd) > 2 else 1
    figure, axes = new_figure(6.5 * columns, 6, columns=columns)
    for axis in axes[0]:
        if discrete:
            angle = np.linspace(0, 2 * math.pi, 7201)
            axis.plot(np.cos(angle), np.sin(angle), color=_FAINT, linewidth=1, label="unit circle")
        else:
            axis.axvline(0, color=_FAINT, linewidth=1)
        axis.plot(branches.real, branches.imag, color=_OWN, linewidth=1)
        axis.plot(branches[0].real, branches[0].imag, "x", color="#555555", label="open loop")
        axis.plot(present.real, present.imag, "o", color=_OTHER, label="the design (factor 1)")
        for edge, mark in zip(edges, "sD", strict=False):
            there = branches[np.searchsorted(factors, edge)]
            axis.plot(there.real, there.imag, mark, color=_MARK, markersize=4,
                      label=f"edge of stability (factor {edge:.3g})")  # fmt: skip
        plane_grid(axis, float(open_loop.dt) if discrete else None)
        axis.set_aspect("equal")
        axis.set_xlabel("real part of z" if discrete else "real part of s (1/s)")
        axis.set_ylabel("imaginary part of z" if discrete else "imaginary part of s (1/s)")
    axes[0, 0].legend(fontsize=9, loc="upper left")
    if columns == 2:
        reach = 1.2 * float(crowd.max())
        axes[0, 1].set_xlim(1 - reach, 1 + reach)
        axes[0, 1].set_ylim(-reach, reach)
        axes[0, 1].set_title("around z = 1", fontsize=10)
    figure.suptitle(f"{title}: closed-loop poles over the gain", fontsize=10)
    return figure  # type: ignore[no-any-return]


def _branches(system: control.StateSpace, factors: Array) -> Any:
    """Poles for each factor, shape (factors, states), each column one branch."""
    rows: list[Any] = []
    for factor in factors:
        feedback = factor / (1 + factor * system.D[0, 0])
        poles = np.linalg.eigvals(system.A - feedback * system.B @ system.C)
        if rows:
            distance = np.abs(rows[-1][:, np.newaxis] - poles[np.newaxis])
            poles = poles[optimize.linear_sum_assignment(distance)[1]]
        rows.append(poles)
    return np.array(rows)
