# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet about identification: the sheet's experiment, evaluated in several ways."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from ravenbrick.model import NXT_MOTOR
from ravenbrick.trace.recording import Recording

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, project, run
from tools.docs.lessons import SHEETS, edited, files_of, part, steps

SHEET = SHEETS / "03-identification.md"
STEP_MS = 20
WINDOWS_MS = (5, 10, 15, 20, 30, 40, 60, 80)
FITTED_S = (1.1, 2.9)
FRICTION = 0.0864  # V

Vector = NDArray[np.float64]


def _edits() -> Edits:
    """Of the template `motor`: the sheet's program and scenarios."""
    files = {
        name.removeprefix("lab03/"): text
        for name, text in files_of(SHEET).items()
        if name.startswith("lab03/")
    }
    for step in steps(part(SHEET.read_text("utf-8"), "Steps")):
        if step.kind == "edit":
            name = step.argument.removeprefix("lab03/")
            text = (project("motor") / name).read_text("utf-8")
            files[name] = edited(text, step.content)
    return files


def _recorded(name: str) -> tuple[Vector, Vector, Vector]:
    """Time (s), angle (rad) and voltage (V) each millisecond."""
    recording: Recording = run("motor", name, _edits())
    times, counts = recording.signal("motor.B.encoder")
    return times, np.radians(counts - counts[0]), recording.signal("motor.B.voltage")[1]


def _mean(values: Vector, samples: int) -> Vector:
    sums = np.concatenate([np.zeros(samples), np.cumsum(values)])
    return np.asarray((sums[samples:] - sums[:-samples]) / samples)


def _speed(angle: Vector, window_ms: int) -> Vector:
    past = np.concatenate([np.zeros(window_ms), angle[:-window_ms]])
    return np.asarray((angle - past) / (0.001 * window_ms))


def _time_constant_ms(window_ms: int, alike: bool) -> float:
    times, angle, voltage = _recorded("excite")
    speed = _speed(angle, window_ms)
    direction = np.sign(speed)
    if alike:
        voltage, direction = _mean(voltage, window_ms), _mean(direction, window_ms)
    voltage, direction = _mean(voltage, STEP_MS), _mean(direction, STEP_MS)
    fitted = (times > FITTED_S[0]) & (times < FITTED_S[1])
    rows = np.flatnonzero(fitted)[:-STEP_MS:STEP_MS]
    after = rows + STEP_MS
    columns = np.column_stack([speed[rows], voltage[after], -direction[after]])
    decay = np.linalg.lstsq(columns, speed[after], rcond=None)[0][0]
    return float(-STEP_MS / np.log(decay))


def data() -> str:
    """Voltage and speed of a second of the experiment."""
    times, angle, voltage = _recorded("excite")
    figure, (above, below) = new_figure(7.0, 3.8, rows=2)
    above.step(times, voltage, where="post", color=SERIES[1], lw=1.2)
    above.set(ylabel="voltage (V)")
    below.plot(times, _speed(angle, 10), color=SERIES[2], lw=0.8, label="window of 10 ms")
    below.plot(times, _speed(angle, 40), color=SERIES[0], lw=1.5, label="window of 40 ms")
    below.set(xlabel="time (s)", ylabel="speed (rad/s)", xlim=(1.0, 2.0), ylim=(-14, 20))
    legend(below, "upper right", 2)
    return picture(figure)


def window() -> str:
    """Estimated time constant over the window of the speed, with and without the same filter."""
    figure, (axis,) = new_figure(7.0, 3.2)
    for alike, colour, name in (
        (False, SERIES[1], "voltage as it is"),
        (True, SERIES[0], "voltage filtered like the speed"),
    ):
        found = [_time_constant_ms(window_ms, alike) for window_ms in WINDOWS_MS]
        axis.plot(WINDOWS_MS, found, "o-", color=colour, label=name)
    axis.axhline(1000 * NXT_MOTOR.time_constant, color="black", ls=":", lw=1)
    axis.set(xlabel="window of the speed (ms)", ylabel="time constant (ms)", ylim=(0, 130))
    legend(axis, "upper left")
    return picture(figure)


def check() -> str:
    """The second experiment, measured and simulated."""
    times, angle, voltage = _recorded("check")
    stays = np.exp(-0.001 / NXT_MOTOR.time_constant)
    speed, simulated = 0.0, []
    for volts in voltage:
        moves = speed != 0.0 or abs(volts) > FRICTION
        drive = volts - FRICTION * np.sign(speed or volts) if moves else 0.0
        speed = stays * speed + (1 - stays) * NXT_MOTOR.gain * drive
        simulated.append(speed)
    window_ms = 20
    figure, (axis,) = new_figure(7.0, 3.0)
    axis.plot(times, _speed(angle, window_ms), color=SERIES[0], lw=2, label="measured")
    # The measured speed is a mean over the window.
    smooth = _mean(np.array(simulated), window_ms)
    axis.plot(times, smooth, color="black", lw=1, ls="--", label="simulated")
    axis.set(xlabel="time (s)", ylabel="speed (rad/s)", xlim=(1.0, 2.0), ylim=(-12, 16))
    legend(axis, "upper right", 2)
    return picture(figure)
