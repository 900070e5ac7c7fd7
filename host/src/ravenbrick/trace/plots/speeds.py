# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Speeds of both wheels against their set-points over a whole run."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario
from ravenbrick.trace.measures import RADIANS_PER_COUNT, setpoint_speed
from ravenbrick.trace.motion import fitted_speed
from ravenbrick.trace.plots.style import COLOURS, degrees_per_second, legend, new_figure
from ravenbrick.trace.recording import Recording

__all__ = ["speeds_figure"]


def _plot_motor(axis: Axes, robot: Robot, recording: Recording, motor: str, colour: str) -> None:
    times, counts = recording.signal(f"motor.{motor}.encoder")
    speed = fitted_speed(times, counts, RADIANS_PER_COUNT)
    role = robot.motor_ports[motor].role
    axis.plot(
        times, degrees_per_second(speed), color=colour, linewidth=1, label=f"{role}, measured"
    )
    setpoint = setpoint_speed(robot, recording, motor)
    if setpoint is not None:
        axis.step(
            setpoint[0],
            degrees_per_second(setpoint[1]),
            where="post",
            color=COLOURS["setpoint"],
            linewidth=1,
            linestyle="--",
            label="set-point",
        )
    axis.set_ylabel(f"motor {motor} (°/s)")
    low, high = axis.get_ylim()
    axis.set_ylim(low, high + 0.25 * (high - low))
    legend(axis, "upper right", 2)


def speeds_figure(robot: Robot, scenario: Scenario, recording: Recording) -> Figure:
    """One axis per driven wheel, with the notes of the scenario's inputs above."""
    wheels = [port for port in (robot.body.left, robot.body.right) if port]
    figure, axes = new_figure(8.0, 4.8, rows=len(wheels))
    for axis, motor, colour in zip(axes, wheels, ("left", "right"), strict=False):
        _plot_motor(axis, robot, recording, motor, COLOURS[colour])
        for event in scenario.inputs:
            if event.note:
                axis.axvline(event.at_ms / 1000, color=COLOURS["grid"], linewidth=1.2, zorder=0)
    for event in scenario.inputs:
        if event.note:
            axes[0].annotate(
                event.note,
                (event.at_ms / 1000, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 3),
                textcoords="offset points",
                fontsize=8,
                ha="center",
            )
    axes[-1].set_xlabel("time (s)")
    return figure
