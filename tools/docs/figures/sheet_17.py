# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about sensor fusion: one run of the sheet's program, filtered again."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ravenbrick.model import diagram_svg
from ravenbrick.trace.recording import Recording

from tools.docs.figures import COLOURS, SERIES, Edits, legend, new_figure, picture, project
from tools.docs.lessons import SHEETS, edited, files_of, part, steps

SHEET = SHEETS / "17-fusion.md"
PERIOD = 0.004
LATE = 4.0  # s: the robot was let go at 2 s
PUSHES = ((10.0, 10.1), (17.0, 17.1))
EVERY = 5  # of the samples is drawn in long curves
WINDOW = 251  # samples of the weighted mean of the pitch from the wheels

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class _Run:
    """What the program saw, the true pitch in degrees, and the sheet's `fusion.py`."""

    log: Any
    truth: Vector
    fusion: Any

    @property
    def time(self) -> Vector:
        return np.asarray(self.log["time"])

    def degrees(self, name: str) -> Vector:
        return np.asarray(np.degrees(self.log[name]))

    def errors_of(self, estimate: Vector) -> Vector:
        """In degrees, once the filters know the robot."""
        return np.asarray((estimate - self.truth)[self.time > LATE])


def _edits() -> Edits:
    """Of the template `balance`: the sheet's steps."""
    folder, files = project("balance"), {}
    for name, text in files_of(SHEET).items():
        if name.startswith("lab17/"):
            files[name.removeprefix("lab17/")] = text
    for step in steps(part(SHEET.read_text("utf-8"), "Steps")):
        if step.kind == "edit":
            name = step.argument.removeprefix("lab17/")
            files[name] = edited((folder / name).read_text("utf-8"), step.content)
    return files


@cache
def _seen() -> _Run:
    folder = project("balance", _edits())
    recorded = folder / "out" / "robot" / "recordings" / "fuse.npz"
    if not recorded.is_file():
        record = folder.parent / "record.py"
        record.write_text(files_of(SHEET)["record.py"], encoding="utf-8")
        command = Path(sys.executable).with_name("ravenbrick")
        options = ("--callback", "record.py:record", "--callback-period-ms", "4")
        subprocess.run(
            [command, "run", "robot", "fuse", *options],
            cwd=folder.parent,
            capture_output=True,
            check=True,
        )
    place = importlib.util.spec_from_file_location("fusion", folder / "fusion.py")
    assert place is not None and place.loader is not None
    fusion = importlib.util.module_from_spec(place)
    place.loader.exec_module(fusion)
    rows = np.genfromtxt(folder.parent / "log.csv", delimiter=",", names=True)
    truth = np.interp(rows["time"], *Recording.load(recorded).signal("body.pitch"))
    return _Run(rows, np.degrees(truth), fusion)


def _momentum(run: _Run) -> Vector:
    """p in degrees times seconds."""
    c1, c = run.fusion.constants()
    rolling = np.diff(run.degrees("wheel"), prepend=0.0) / PERIOD
    return np.asarray(c1 * rolling + c * run.degrees("rate"))


def _complementary(run: _Run, time_constant: float) -> Vector:
    weight, estimate, found = time_constant / (time_constant + PERIOD), 0.0, []
    slow = np.diff(_momentum(run), prepend=0.0) / PERIOD
    for rate, tilt in zip(run.degrees("rate"), slow, strict=True):
        estimate = weight * (estimate + PERIOD * rate) + (1 - weight) * tilt
        found.append(estimate)
    return np.array(found)


@dataclass(frozen=True)
class _Filtered:
    """Of the filter with the gain of the recursion, in degrees, from the release on."""

    time: Vector
    error: Vector
    claimed: Vector
    offset: Vector
    offset_claimed: Vector


@cache
def _filtered() -> _Filtered:
    run = _seen()
    system, (process, entry, measured) = run.fusion.model(), run.fusion.noises()
    matrix, rate_entry, output = system.A, system.B[:, 0], system.C[0]
    covariance = entry @ process @ entry.T
    state, doubt = np.zeros(4), np.diag(np.radians([0.1, 0.1, 2, 0.5]) ** 2)
    rows = []
    free = run.time > 2
    for sample, pitch in zip(run.log[free], np.radians(run.truth[free]), strict=True):
        variance = output @ doubt @ output + measured[0][0]
        sigma = np.sqrt(np.diag(doubt))
        rows.append((state[2] - pitch, sigma[2], state[3], sigma[3]))
        gain = matrix @ doubt @ output / variance
        innovation = sample["wheel"] - output @ state
        state = matrix @ state + rate_entry * sample["rate"] + gain * innovation
        doubt = matrix @ doubt @ matrix.T + covariance - variance * np.outer(gain, gain)
    return _Filtered(run.time[free], *np.degrees(rows).T)


def _mark_pushes(axis: Any) -> None:
    for begin, end in PUSHES:
        axis.axvspan(begin, end, color=COLOURS["grid"], lw=0)


def sources() -> str:
    """The integral of the gyro and the pitch from the wheels beside the truth."""
    run = _seen()
    figure, (above, below) = new_figure(7.0, 4.6, rows=2)
    integral = PERIOD * np.cumsum(run.degrees("rate"))
    above.plot(run.time, integral, color=SERIES[1], label="integral of the gyro")
    slow = np.diff(_momentum(run), prepend=0.0) / PERIOD
    weights = np.hanning(WINDOW)
    mean = np.convolve(slow, weights / sum(weights), "same")
    below.plot(run.time, mean, color=SERIES[2], label="from the wheels, mean of a second")
    for axis in (above, below):
        axis.plot(run.time, run.truth, color=SERIES[0], lw=1, label="truth")
        axis.set(ylabel="pitch (°)", xlim=(2, 24))
        _mark_pushes(axis)
        legend(axis, "upper left", 2)
    below.set(xlabel="time (s)", ylim=(-8, 8))
    return picture(figure)


def time_constant() -> str:
    """Error of the complementary filter over its time constant."""
    from matplotlib.ticker import FixedLocator, NullFormatter  # slow to load

    run = _seen()
    figure, (axis,) = new_figure(7.0, 3.2)
    times = np.array([0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0])
    errors = [run.errors_of(_complementary(run, one)) for one in times]
    found = [float(np.sqrt(np.mean(error**2))) for error in errors]
    offset = float(np.mean(run.degrees("rate")[run.time > LATE]))
    noise = times[0] * float(np.std(errors[0]))
    axis.loglog(times, found, "o", color=SERIES[0], label="recording")
    smooth = np.geomspace(0.1, 5, 100)
    curve = np.hypot(offset * smooth, noise / smooth)
    axis.loglog(smooth, curve, color="black", lw=1, label="formula (4)")
    for part_of, style in ((offset * smooth, "--"), (noise / smooth, ":")):
        axis.loglog(smooth, part_of, style, color=COLOURS["faint"], lw=1)
    axis.set(xlabel="time constant (s)", ylabel="error (°)", ylim=(0.1, 8))
    for side, ticks in ((axis.xaxis, (0.1, 0.3, 1, 3)), (axis.yaxis, (0.1, 0.3, 1, 3))):
        side.set_major_locator(FixedLocator(ticks))
        side.set_major_formatter("{x:g}")
        side.set_minor_formatter(NullFormatter())
    legend(axis, "upper right")
    return picture(figure)


def diagram() -> str:
    """The Kalman filter's diagram."""
    return diagram_svg(_seen().fusion.kalman_diagram())


def estimates() -> str:
    """Truth and estimates around the first push."""
    run = _seen()
    figure, (axis,) = new_figure(7.0, 3.4)
    shown = (run.time > 9) & (run.time < 13)
    for name, colour, width in (("complementary", SERIES[2], 0.7), ("program", SERIES[4], 1.3)):
        axis.plot(run.time[shown], run.degrees(name)[shown], color=colour, lw=width, label=name)
    axis.plot(run.time[shown], run.degrees("kalman")[shown], color=SERIES[1], label="Kalman")
    axis.plot(run.time[shown], run.truth[shown], color=SERIES[0], lw=2, label="truth")
    _mark_pushes(axis)
    axis.set(xlabel="time (s)", ylabel="pitch (°)", xlim=(9, 13))
    legend(axis, "lower right", 2)
    return picture(figure)


def error() -> str:
    """Error of the estimate within the band that the filter claims."""
    found = _filtered()
    figure, (axis,) = new_figure(7.0, 3.0)
    claimed = 2 * found.claimed[::EVERY]
    axis.fill_between(found.time[::EVERY], -claimed, claimed, color="0.88", lw=0)
    axis.plot(found.time[::EVERY], found.error[::EVERY], color=SERIES[0], lw=0.8)
    axis.set(xlabel="time (s)", ylabel="error of the pitch (°)", xlim=(2, 24), ylim=(-3, 3))
    return picture(figure)


def offset() -> str:
    """The estimated offset of the gyro."""
    found, run = _filtered(), _seen()
    figure, (axis,) = new_figure(7.0, 3.0)
    times, estimate = found.time[::EVERY], found.offset[::EVERY]
    claimed = 2 * found.offset_claimed[::EVERY]
    axis.fill_between(times, estimate - claimed, estimate + claimed, color="0.88", lw=0)
    axis.plot(times, estimate, color=SERIES[0], label="gain of the recursion")
    steady = run.degrees("offset")[run.time > 2]
    axis.plot(times, steady[::EVERY], color=SERIES[1], label="constant gain, on the robot")
    axis.axhline(0.4, color="black", ls=":", lw=1)
    _mark_pushes(axis)
    axis.set(xlabel="time (s)", ylabel="offset (°/s)", xlim=(2, 24), ylim=(-0.6, 1.2))
    legend(axis, "lower right")
    return picture(figure)
