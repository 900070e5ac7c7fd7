# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A design with a slider per gain: poles, frequency response, step and code follow it at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ravenbrick.control.analysis.frequency_plots import frequency_response, plane_grid, unwrapped
from ravenbrick.control.analysis.metrics import Margins
from ravenbrick.control.analysis.plant_loop import PlantLoop
from ravenbrick.control.analysis.sampled import SampledLoop
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, LinearSystem, SpeedLoop, linear_system
from ravenbrick.model import program as ir

__all__ = ["InteractiveDesign", "TunableLoop"]

_POINTS = 240
_REACH = 4.0
_LEFT, _SLIDER_HEIGHT = 0.36, 0.045
_OWN, _BEFORE, _MARK, _FAINT = "#1f5fa8", "#9a6a00", "#b3372f", "#bbbbbb"


@dataclass(frozen=True, eq=False)
class TunableLoop:
    """A loop whose controller keeps its gains open.

    `program` is the controller's step with the values that it has now, `closed` makes the loop of
    a controller, and its step is shown for `duration` (s).
    """

    program: ir.Program
    closed: Callable[[LinearSystem], SampledLoop | PlantLoop]
    duration: float = 1.0

    @classmethod
    def of(
        cls, loop: SpeedLoop, specification: LoopSpecification, controller: Diagram
    ) -> TunableLoop:
        """A speed loop with a diagram's own values; raises `DesignError` if none can be tuned."""
        window, delay = specification.window or 1, specification.delay
        program = controller.lower()
        return cls(program, lambda system: SampledLoop(loop, system, window, delay))._with_gains()

    @classmethod
    def around(
        cls, plant: Any, controller: Diagram, measured: Mapping[str, int], duration: float = 1.0
    ) -> TunableLoop:
        """The loop of a diagram with a continuous plant, such as python-control's, of one input.

        The diagram has one output. `measured` gives for its inputs the number of the plant's
        output that they read; the one that is not named is the set-point, which the plant's first
        output follows.
        """
        program = controller.lower()
        names = [slot.name for slot in program.inputs]
        for name in measured:
            if name not in names:
                raise DesignError(f"the controller has no input '{name}'; it has {names}")
        ports = [measured.get(name) for name in names]
        own = cls(program, lambda system: PlantLoop(plant, system, ports), duration)
        return own._with_gains()

    def _with_gains(self) -> TunableLoop:
        if not self.gains:
            raise DesignError(
                f"diagram '{self.program.name}' has no gain to drag; give one of its blocks a "
                "Parameter instead of a number"
            )
        return self

    def tuned(self, values: Mapping[str, float]) -> TunableLoop:
        """The same loop with other values of parameters, by name."""
        slots = tuple(
            replace(slot, initial=float(values.get(slot.name, slot.initial)))
            for slot in self.program.parameters
        )
        return replace(self, program=replace(self.program, parameters=slots))

    @cached_property
    def gains(self) -> dict[str, float]:
        """Parameters on which the loop depends as long as no limit is reached, by name."""
        present = linear_system(self.program)
        found = {}
        for slot in self.program.parameters:
            value = slot.initial
            other = linear_system(self.tuned({slot.name: 1.1 * value + 0.1}).program)
            if any(
                not np.array_equal(getattr(present, name), getattr(other, name)) for name in "ABCD"
            ):
                found[slot.name] = value
        return found

    @cached_property
    def sampled(self) -> SampledLoop | PlantLoop:
        """The loop as it runs, of a speed loop with estimator and delay."""
        return self.closed(linear_system(self.program))

    @property
    def stable(self) -> bool:
        """Whether all poles are inside the unit circle."""
        return bool(np.abs(self.sampled.poles()).max() < 1.0)


class InteractiveDesign:
    """Draws a loop and its sliders into a figure of any backend, in a page or in a notebook.

    `code` makes text of the controller's program; its lines with the gains stand beside.
    """

    def __init__(
        self, figure: Any, loop: TunableLoop, code: Callable[[ir.Program], str] | None = None
    ) -> None:
        self._figure = figure
        self._begun = self.loop = loop
        self._code = code
        self.sliders: dict[str, Any] = {}
        figure.clear()
        bottom = 0.08 + _SLIDER_HEIGHT * (len(loop.gains) + 1)
        grid = figure.add_gridspec(
            3, 2, left=0.06, right=0.98, top=0.93, bottom=bottom, hspace=0.45, wspace=0.18
        )
        self._plane = figure.add_subplot(grid[:2, 0])
        self._text = figure.add_subplot(grid[2, 0])
        self._step, self._magnitude, self._phase = (
            figure.add_subplot(grid[row, 1]) for row in range(3)
        )
        self._add_sliders()
        self.draw()

    def _add_sliders(self) -> None:
        from matplotlib.widgets import Slider

        for row, (name, value) in enumerate(self.loop.gains.items()):
            place = self._figure.add_axes((_LEFT, 0.02 + _SLIDER_HEIGHT * row, 0.5, 0.03))
            ends = sorted((0.0, _REACH * value)) if value else (-1.0, 1.0)
            slider = Slider(place, name, *ends, valinit=value, valfmt="%.5g")
            slider.on_changed(self._moved(name))
            self.sliders[name] = slider

    def _moved(self, name: str) -> Callable[[float], None]:
        return lambda value: self.set({name: value})

    def set(self, values: Mapping[str, float]) -> None:
        """Other values of gains: everything is drawn again."""
        self.loop = self.loop.tuned(values)
        self.draw()
        self._figure.canvas.draw_idle()

    def figures(self) -> dict[str, float]:
        """Settling time, overshoot and margins; none of the step where the loop is not stable."""
        if not self.loop.stable:
            return {}
        margins, step = self.loop.sampled.margins(), self.loop.sampled.step_metrics()
        return {
            "settling_time": step.settling_time,
            "overshoot": step.overshoot,
            "phase_margin_deg": margins.phase_margin_deg,
            "gain_margin": margins.gain_margin,
        }

    def draw(self) -> None:
        """All pictures of the present gains, those of the first ones behind them."""
        self._draw_poles()
        self._draw_step()
        self._draw_response()
        self._draw_code()
        self._figure.suptitle(_described(self.figures()), fontsize=11)

    def _draw_poles(self) -> None:
        axis = self._plane
        axis.clear()
        plane_grid(axis, self.loop.sampled.sample_time)
        for loop, colour, mark in ((self._begun, _BEFORE, "+"), (self.loop, _OWN, "x")):
            poles = loop.sampled.poles()
            axis.plot(poles.real, poles.imag, mark, color=colour, markersize=8)
        axis.set_title("poles of the closed loop (z)", fontsize=10)

    def _draw_step(self) -> None:
        axis = self._step
        axis.clear()
        axis.axhline(1.0, color=_FAINT, linewidth=1)
        for loop, colour in ((self._begun, _BEFORE), (self.loop, _OWN)):
            response = loop.sampled.step_response(self.loop.duration, 1)
            axis.plot(response.time, response.output, color=colour)
        axis.set_ylim(-0.1, 2.0)
        axis.set_title("unit step over s", fontsize=10)

    def _draw_response(self) -> None:
        highest = math.pi / self.loop.sampled.sample_time
        frequencies = np.geomspace(highest * 1e-4, highest * (1 - 1e-6), _POINTS)
        for axis in (self._magnitude, self._phase):
            axis.clear()
            axis.grid(True, color="#e3e3e3", linewidth=0.7)
        for loop, colour in ((self._begun, _BEFORE), (self.loop, _OWN)):
            values = frequency_response(loop.sampled.open_loop(), frequencies)
            decibels = 20 * np.log10(np.maximum(np.abs(values), 1e-12))
            self._magnitude.semilogx(frequencies, decibels, color=colour)
            self._phase.semilogx(frequencies, unwrapped(values), color=colour)
        self._magnitude.axhline(0.0, color=_FAINT, linewidth=1)
        self._magnitude.set_ylim(-60, 60)
        self._mark(self.loop.sampled.margins() if self.loop.stable else None)
        self._magnitude.set_title("open loop (dB, deg) over rad/s", fontsize=10)

    def _mark(self, margins: Margins | None) -> None:
        if margins is None or not math.isfinite(margins.crossover):
            return
        for axis in (self._magnitude, self._phase):
            axis.axvline(margins.crossover, color=_MARK, linewidth=0.8, linestyle=":")

    def _draw_code(self) -> None:
        axis = self._text
        axis.clear()
        axis.axis("off")
        if self._code is not None:
            axis.text(
                0.0, 1.0, self.lines().replace("$", r"\$"), va="top", family="monospace", fontsize=8
            )

    def lines(self) -> str:
        """The lines of the code that hold the parameters' values."""
        if self._code is None:
            return ""
        names = [slot.name for slot in self.loop.program.parameters]
        lines = self._code(self.loop.program).split("\n")
        return "\n".join(line for line in lines if any(f"/* {name}:" in line for name in names))


def _described(figures: Mapping[str, float]) -> str:
    if not figures:
        return "not stable"
    gain = figures["gain_margin"]
    decibels = f"{20 * math.log10(gain):.1f} dB" if 0 < gain < math.inf else "none"
    return (
        f"settles in {figures['settling_time'] * 1e3:.0f} ms, overshoot "
        f"{figures['overshoot']:.1%}, phase margin {figures['phase_margin_deg']:.1f} deg, gain "
        f"margin {decibels}"
    )
