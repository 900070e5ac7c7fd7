# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What was recorded over a whole run: motors, sensors, the body, probes and inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.report.chart import COLOURS, SERIES, Anchor, Drawing, Panel
from ravenbrick.trace.measures import setpoint_speed
from ravenbrick.trace.recording import Recording

__all__ = ["signals_drawing"]

Floats = NDArray[np.float64]
WIDTH, LEFT, RIGHT, TOP, GAP, HEIGHT, LANE = 930, 62, 14, 44, 34, 104, 32
DEGREES = 180 / np.pi
MOST_PLOTS, MOST_INPUTS = 9, 8
RAW = ("encoder", "current", "voltage")


@dataclass(frozen=True)
class Curve:
    """Values over s; `held`: each holds until the next."""

    label: str
    colour: str
    times: Floats
    values: Floats
    dash: str = ""
    held: bool = False


@dataclass
class Plot:
    """Curves over one pair of axes."""

    title: str
    curves: list[Curve] = field(default_factory=list)


def _changes(values: Floats) -> bool:
    return values.size > 0 and bool(np.any(values != values[0]))


class _Signals:
    """The signals of a recording, each asked for once; `rest` is what nobody asked for."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self._asked: set[str] = set()

    def take(self, name: str) -> tuple[Floats, Floats] | None:
        """Instants (s) and values; None when it was not recorded or never changed."""
        self._asked.add(name)
        signal = self.recording.signals.get(name)
        if signal is None or not _changes(signal.values):
            return None
        return self.recording.signal(name)

    def rest(self) -> Iterator[str]:
        """Names of the others."""
        return (name for name in self.recording.signals if name not in self._asked)


def _motor_plots(robot: Robot, signals: _Signals) -> list[Plot]:
    """Speeds with set-points, duties, and angles where no driving turns the shaft."""
    speeds, duties, angles = Plot("speed (°/s)"), Plot("duty (%)"), Plot("angle (°)")
    for number, port in enumerate(robot.motor_ports):
        name, colour = f"motor {port}", SERIES[number % len(SERIES)]
        speed = signals.take(f"motor.{port}.angular_velocity")
        duty = signals.take(f"motor.{port}.duty")
        angle = signals.take(f"motor.{port}.angle")
        for raw in RAW:
            signals.take(f"motor.{port}.{raw}")
        if duty is not None:
            duties.curves.append(Curve(name, colour, duty[0], 100 * duty[1], held=True))
        if speed is not None and duty is not None:
            speeds.curves.append(Curve(name, colour, speed[0], DEGREES * speed[1]))
        if angle is not None and (duty is None or robot.body.kind == "bench"):
            angles.curves.append(Curve(name, colour, angle[0], DEGREES * angle[1]))
    for setpoint in robot.setpoints:
        signals.take(f"probe.{setpoint.symbol}")
        if f"probe.{setpoint.symbol}" not in signals.recording.signals:
            continue
        wanted = setpoint_speed(robot, signals.recording, setpoint.port)
        if wanted is not None and _changes(wanted[1]):
            label = f"set-point {setpoint.port}"
            values = DEGREES * wanted[1]
            speeds.curves.append(
                Curve(label, COLOURS["setpoint"], wanted[0], values, "5 3", held=True)
            )
    return [plot for plot in (speeds, duties, angles) if plot.curves]


def _scaled(name: str) -> tuple[str, float, float]:
    """Title, factor and offset of a signal that is not a motor's."""
    kind, _, rest = name.partition(".")
    port = rest.partition(".")[0]
    known: dict[str, tuple[str, float, float]] = {
        "body.pitch": ("body: pitch (°)", DEGREES, 0.0),
        "body.pitch_rate": ("body: pitch rate (°/s)", DEGREES, 0.0),
        "body.heading": ("body: heading (°)", DEGREES, 0.0),
        "body.x": ("body: x (m)", 1.0, 0.0),
        "body.y": ("body: y (m)", 1.0, 0.0),
        "battery.voltage": ("battery (V)", 1.0, 0.0),
    }
    if name in known:
        return known[name]
    if kind == "gyro":
        return f"gyro {port} (°/s)", DEGREES, 0.0
    if kind == "distance":
        return f"ultrasonic sensor {port}: distance (m)", 1.0, 0.0
    if rest.endswith("reflectance"):
        return f"light sensor {port}: reflectance", 1.0, 0.0
    return (rest if kind == "probe" else name), 1.0, 0.0


def _other_plots(robot: Robot, signals: _Signals, place_is_drawn: bool) -> Iterator[Plot]:
    """Sensors, then the body, then what is left."""
    order: list[Callable[[str], bool]] = [
        lambda name: not name.startswith(("body.", "battery.")),
        lambda _name: True,
    ]
    if place_is_drawn:
        for name in ("body.x", "body.y", "body.heading"):
            signals.take(name)
    if "body.pitch" in signals.recording.signals:
        for name in ("body.y", "body.heading", "body.pitch_rate"):
            signals.take(name)
    for wanted in order:
        for name in [name for name in signals.rest() if wanted(name)]:
            found = signals.take(name)
            if found is None:
                continue
            title, factor, offset = _scaled(name)
            port = robot.sensor_ports.get(name.split(".")[1])
            if port is not None and not name.startswith(("motor.", "probe.")):
                title += f", {port.role}"
            curve = Curve("", SERIES[0], found[0], factor * found[1] + offset)
            yield Plot(title, [curve])


def _inputs(recording: Recording) -> dict[str, Curve]:
    """Each input over time, held until its next value."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    end = recording.clock.seconds(recording.stop.at_cycles)
    for timed in recording.inputs:
        times, values = found.setdefault(timed.name, ([0.0], [0.0]))
        times.append(recording.clock.seconds(timed.at_cycles))
        values.append(timed.value)
    return {
        name: Curve(
            name, SERIES[0], np.array([*times, end]), np.array([*values, values[-1]]), held=True
        )
        for name, (times, values) in found.items()
    }


def _draw_plot(panel: Panel, plot: Plot) -> None:
    panel.y_axis(plot.title)
    if panel.y[0] < 0 < panel.y[1]:
        panel.horizontal(0, COLOURS["faint"], 0.8)
    for curve in plot.curves:
        panel.line(curve.times, curve.values, curve.colour, 1.4, dash=curve.dash, held=curve.held)
    if len(plot.curves) > 1 or plot.curves[0].label:
        panel.legend([(curve.label, curve.colour, curve.dash) for curve in plot.curves])


def _draw_inputs(drawing: Drawing, top: float, end: float, inputs: dict[str, Curve]) -> None:
    """A lane per input; its values are written where it changes."""
    drawing.text(LEFT, top - 7, "inputs", bold=True)
    for number, (name, curve) in enumerate(inputs.items()):
        low, high = float(curve.values.min()), float(curve.values.max())
        place = (LEFT, top + LANE * number + 14, WIDTH - LEFT - RIGHT, LANE - 18)
        panel = Panel(drawing, *place, (0.0, end), (low, high if high > low else low + 1))
        panel.horizontal(low, COLOURS["grid"])
        panel.line(curve.times, curve.values, SERIES[number % len(SERIES)], 1.6, held=True)
        drawing.text(LEFT + 4, panel.top - 3, f"{name} ({low:g} to {high:g})", size=10)


def _limits(plot: Plot) -> tuple[float, float]:
    low = min(float(np.min(curve.values)) for curve in plot.curves)
    high = max(float(np.max(curve.values)) for curve in plot.curves)
    margin = 0.06 * (high - low) or 0.5
    return low - margin, high + margin


def signals_drawing(
    robot: Robot, scenario: Scenario, recording: Recording, place_is_drawn: bool
) -> Drawing | None:
    """One below the other over the time of the run, with the notes of the scenario's inputs.

    `place_is_drawn`: the path is drawn elsewhere. None when nothing was recorded that changed.
    """
    end = recording.clock.seconds(recording.stop.at_cycles)
    signals = _Signals(recording)
    plots = _motor_plots(robot, signals)
    plots += list(_other_plots(robot, signals, place_is_drawn))
    plots, inputs = plots[:MOST_PLOTS], dict(list(_inputs(recording).items())[:MOST_INPUTS])
    if not (plots or inputs) or end <= 0:
        return None
    lanes = GAP + LANE * len(inputs) if inputs else 0
    inner = (HEIGHT + GAP) * len(plots) + lanes - GAP
    drawing = Drawing(WIDTH, TOP + inner + 40, f"Signals of the run '{scenario.name}'")
    whole = Panel(drawing, LEFT, TOP, WIDTH - LEFT - RIGHT, inner, (0.0, end), (0, 1))
    whole.x_axis("time (s)")
    for event in scenario.inputs:
        if event.note:
            whole.vertical(event.at_ms / 1000, COLOURS["faint"], 0.8, "2 3")
            x = float(whole.at_x(event.at_ms / 1000))
            anchor: Anchor = "end" if x > WIDTH - 60 else "middle"
            drawing.text(x, 14, event.note, anchor=anchor, size=11)
    for number, plot in enumerate(plots):
        place = (LEFT, TOP + (HEIGHT + GAP) * number, whole.width, HEIGHT)
        _draw_plot(Panel(drawing, *place, whole.x, _limits(plot)), plot)
    if inputs:
        _draw_inputs(drawing, TOP + (HEIGHT + GAP) * len(plots), end, inputs)
    return drawing
