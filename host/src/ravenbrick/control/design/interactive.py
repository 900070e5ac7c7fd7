# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A design with a slider per gain: poles, frequency response, step and code follow it at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ravenbrick.control.analysis.frequency_plots import frequency_response, plane_grid, unwrapped
from ravenbrick.control.analysis.metrics import Margins
from ravenbrick.control.analysis.plant_loop import PlantLoop, Wiring
from ravenbrick.control.analysis.sampled import SampledLoop
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, LinearSystem, SpeedLoop
from ravenbrick.model import program as ir
from ravenbrick.model.rates import systems_of_steps

__all__ = ["InteractiveDesign", "TunableLoop"]

_POINTS = 240
_NO_RESPONSE = "several rates: a sine is not answered by one sine, so no Bode plot"
_REACH = 4.0
_LEFT, _SLIDER_HEIGHT = 0.36, 0.045
_OWN, _BEFORE, _MARK, _FAINT = "#1f5fa8", "#9a6a00", "#b3372f", "#bbbbbb"


@dataclass(frozen=True, eq=False)
class TunableLoop:
    """A loop whose controller keeps its gains open.

    `program` is the controller's step with the values that it has now, `closed` makes the loop of
    a controller's systems (`systems_of_steps`), and its step is shown for `duration` (s). `cut`
    says where the open loop is cut, if there is a choice.
    """

    program: ir.Program
    closed: Callable[[Sequence[LinearSystem]], SampledLoop | PlantLoop]
    duration: float = 1.0
    cut: str = ""

    @classmethod
    def of(
        cls, loop: SpeedLoop, specification: LoopSpecification, controller: Diagram
    ) -> TunableLoop:
        """A speed loop with a diagram's own values; raises `DesignError` if none can be tuned."""
        window, delay = specification.window or 1, specification.delay
        program = controller.lower()
        own = cls(program, lambda systems: SampledLoop(loop, systems[0], window, delay))
        if len(own.systems) > 1 or len(program.outputs) > 1:
            raise DesignError(
                f"the controller '{program.name}' of a speed loop has several rates or outputs; "
                "give it with its plant to TunableLoop.around"
            )
        return own._with_gains()

    @classmethod
    def around(
        cls,
        plant: Any,
        controller: Diagram,
        measured: Mapping[str, int],
        duration: float = 1.0,
        *,
        driven: Mapping[str, int] | None = None,
        set_point: str | None = None,
        followed: int = 0,
        cut: str | None = None,
    ) -> TunableLoop:
        """The loop of a diagram with a continuous plant, such as python-control's.

        `measured` gives for the diagram's inputs the number of the plant's output that they read,
        `driven` for its outputs the number of the plant's input; one output drives the first
        input. The other inputs are set-points: `set_point` is the one that steps, the others are
        zero. `followed` is the plant's output that is shown, and `cut` the output at which the
        open loop is cut while the other loops stay closed: the first that drives the plant.
        """
        program = controller.lower()
        inputs, outputs = ([s.name for s in group] for group in (program.inputs, program.outputs))
        if not driven:
            driven = {outputs[0]: 0}
            if len(outputs) > 1:
                raise DesignError(
                    f"the controller has the outputs {outputs}; say which input of the plant each "
                    f"drives: driven={{'{outputs[0]}': 0}}"
                )
        for what, names, given in (("input", inputs, measured), ("output", outputs, driven)):
            for name in given:
                if name not in names:
                    raise DesignError(f"the controller has no {what} '{name}'; it has {names}")
        step = _chosen(
            "input", set_point, "set_point", [name for name in inputs if name not in measured]
        )
        at = cut or next(name for name in outputs if name in driven)
        _chosen("output that drives the plant", at, "cut", list(driven))
        wiring = Wiring(
            [measured.get(name) for name in inputs],
            [driven.get(name) for name in outputs],
            inputs.index(step),
            followed,
            outputs.index(at),
        )
        place = f", cut at {at}, other loops closed" if len(driven) > 1 else ""
        own = cls(program, lambda systems: PlantLoop(plant, systems, wiring), duration, place)
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
        found = {}
        for slot in self.program.parameters:
            value = slot.initial
            others = self.tuned({slot.name: 1.1 * value + 0.1}).systems
            if any(
                not np.array_equal(getattr(present, name), getattr(other, name))
                for present, other in zip(self.systems, others, strict=True)
                for name in "ABCD"
            ):
                found[slot.name] = value
        return found

    @cached_property
    def systems(self) -> tuple[LinearSystem, ...]:
        """The controller in each step of the period in which all of its rates run."""
        return systems_of_steps(self.program)

    @property
    def period(self) -> float:
        """That period in s; the poles are those of this period."""
        return self.program.sample_time * len(self.systems)

    @cached_property
    def sampled(self) -> SampledLoop | PlantLoop:
        """The loop as it runs, of a speed loop with estimator and delay."""
        return self.closed(self.systems)

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
        """Settling time, overshoot and, of one rate, margins; none if the loop is not stable."""
        if not self.loop.stable:
            return {}
        step = self.loop.sampled.step_metrics()
        found = {"settling_time": step.settling_time, "overshoot": step.overshoot}
        if self._several:
            return found
        margins = self.loop.sampled.margins()
        return {
            **found,
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
        plane_grid(axis, self.loop.period)
        for loop, colour, mark in ((self._begun, _BEFORE, "+"), (self.loop, _OWN, "x")):
            poles = loop.sampled.poles()
            axis.plot(poles.real, poles.imag, mark, color=colour, markersize=8)
        several = f", period of {1000 * self.loop.period:g} ms" if self._several else ""
        axis.set_title(f"poles of the closed loop (z{several})", fontsize=10)

    def _draw_step(self) -> None:
        axis = self._step
        axis.clear()
        axis.axhline(1.0, color=_FAINT, linewidth=1)
        for loop, colour in ((self._begun, _BEFORE), (self.loop, _OWN)):
            response = loop.sampled.step_response(self.loop.duration, 1)
            axis.plot(response.time, response.output, color=colour)
        axis.set_ylim(-0.1, 2.0)
        axis.set_title("unit step over s", fontsize=10)

    @property
    def _several(self) -> bool:
        """Whether the controller has several rates."""
        return len(self.loop.systems) > 1

    def _draw_response(self) -> None:
        if self._several:
            for axis in (self._magnitude, self._phase):
                axis.axis("off")
            self._magnitude.set_title(_NO_RESPONSE, fontsize=10)
            return
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
        self._magnitude.set_title(f"open loop (dB, deg) over rad/s{self.loop.cut}", fontsize=10)

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
        values = [line for line in lines if not line.lstrip().startswith("/*")]
        return "\n".join(line for line in values if any(f"/* {name}:" in line for name in names))


def _described(figures: Mapping[str, float]) -> str:
    if not figures:
        return "not stable"
    step = (
        f"settles in {figures['settling_time'] * 1e3:.0f} ms, overshoot {figures['overshoot']:.1%}"
    )
    if "gain_margin" not in figures:
        return step
    gain = figures["gain_margin"]
    decibels = f"{20 * math.log10(gain):.1f} dB" if 0 < gain < math.inf else "none"
    return f"{step}, phase margin {figures['phase_margin_deg']:.1f} deg, gain margin {decibels}"


def _chosen(what: str, given: str | None, keyword: str, names: Sequence[str]) -> str:
    """The name that was given, or the only one; raises `DesignError` with the choice."""
    if given in names:
        return str(given)
    if given is None and len(names) == 1:
        return names[0]
    if not names:
        raise DesignError("the controller has no set-point: each of its inputs reads the plant")
    wrong = "" if given is None else f"'{given}' is no such {what}; "
    raise DesignError(f"{wrong}choose one with {keyword}: {', '.join(names)}")
