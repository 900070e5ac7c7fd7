# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A finished design: gains, controller diagram, step responses, and what the encoder does to it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ravenbrick.atomic_write import atomic_write
from ravenbrick.control.analysis.metrics import Margins, StepMetrics, step_metrics
from ravenbrick.control.analysis.sampled import SampledLoop, StepResponse
from ravenbrick.control.design.design_plots import DesignedLoop
from ravenbrick.control.estimation.encoder_run import (
    EncoderRun,
    RunMeasures,
    encoder_run,
    measure_runs,
)
from ravenbrick.control.estimation.estimator import LoopSpecification
from ravenbrick.control.synthesis.controller import pi_diagram
from ravenbrick.control.synthesis.tuning import DiscretePi, PiGains
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Diagram,
    Encoder,
    IntegrationMethod,
    SpeedLoop,
    diagram_svg,
    linear_system,
)
from ravenbrick.model.fidelity import TOLERANCE, as_held, fidelity
from ravenbrick.model.lazy import linalg

__all__ = ["Design", "EstimatorComparison", "finish_design"]

ENCODER_PHASES = 4
RUN_DURATION = 2.0
RESPONSE_DURATION = 1.0


@dataclass(frozen=True)
class EstimatorComparison:
    """What a speed estimate over `window` samples gives with certain gains.

    `quantum` (V) is the smallest step of the fed-back signal; `measures` come from encoder-true
    simulation at `set_point` (V).
    """

    name: str
    window: int
    gains: PiGains
    quantum: float
    set_point: float
    measures: RunMeasures

    def row(self) -> dict[str, float | int | str]:
        """Plain values by name: V, s and shares."""
        return {
            "name": self.name,
            "window": self.window,
            "quantum": self.quantum,
            "set_point": self.set_point,
            **vars(self.measures),
        }


@dataclass(frozen=True, eq=False)
class Design:
    """The result of design.py: gains and controller; what they give is computed when asked for.

    `continuous` are the gains without sampling, `discrete` those of `controller`, designed with
    estimator and delay in the loop. Responses are to a unit step, `encoder_response` to
    `set_point` (V) with the encoder's counts.
    """

    name: str
    loop: SpeedLoop
    specification: LoopSpecification
    supply_voltage: float
    set_point: float
    continuous: PiGains
    discrete: DiscretePi
    controller: Diagram

    @cached_property
    def continuous_metrics(self) -> StepMetrics:
        """Of the continuous loop's step response."""
        return step_metrics(self.continuous.closed_loop(self.loop))

    @cached_property
    def continuous_response(self) -> StepResponse:
        """Step response of the continuous loop."""
        closed = self.continuous.closed_loop(self.loop)
        time = np.linspace(0.0, RESPONSE_DURATION, 501)
        rest = -np.linalg.solve(closed.A, closed.B[:, 0])
        transition = linalg.expm(closed.A * time[1])
        states = [-rest]
        for _ in time[1:]:
            states.append(transition @ states[-1])
        return StepResponse(time, (np.array(states) + rest) @ closed.C[0])

    @cached_property
    def _sampled(self) -> SampledLoop:
        own = self.specification
        return SampledLoop(self.loop, linear_system(self.controller), own.window or 1, own.delay)

    @cached_property
    def sampled_metrics(self) -> StepMetrics:
        """Of the sampled loop's step response; linear, from the controller's own diagram."""
        return self._sampled.step_metrics()

    @cached_property
    def sampled_response(self) -> StepResponse:
        """Step response of the sampled loop, linear."""
        return self._sampled.step_response(RESPONSE_DURATION)

    @cached_property
    def margins(self) -> Margins:
        """Of the sampled loop."""
        return self._sampled.margins()

    @cached_property
    def encoder_response(self) -> EncoderRun:
        """Step of the set-point with the encoder's counts."""
        own = self.specification
        return encoder_run(
            self.loop,
            self.controller,
            self.set_point,
            RESPONSE_DURATION,
            own.window or 1,
            delay=own.delay,
        )

    @cached_property
    def estimators(self) -> tuple[EstimatorComparison, ...]:
        """The plain one-sample difference, and the estimator in use."""
        own = self.specification
        window = own.window or 1
        plain = self.continuous.discretised(IntegrationMethod.FORWARD_EULER, own.sample_time)
        candidates = {
            "difference over one sample": (1, plain),
            f"difference over {window} samples": (window, self.discrete),
        }
        return compare_estimators(
            self.loop, candidates, self.set_point, self.supply_voltage, own.delay
        )

    @property
    def designed_loop(self) -> DesignedLoop:
        """The loop for pictures, families of gains and tolerances."""
        controller = linear_system(self.controller)
        return DesignedLoop(self.loop, self.specification, self.continuous, controller)

    @property
    def estimator(self) -> EstimatorComparison:
        """The comparison's row of the estimator in use, the last one."""
        return self.estimators[-1]

    def figures(self) -> dict[str, float]:
        """Single numbers by name; SI units, voltages in V, overshoots and ripples as shares."""
        gains, plain, chosen = self.discrete.gains, self.estimators[0], self.estimator
        return {
            "plant_gain": self.loop.gain,
            "plant_time_constant": self.loop.time_constant,
            "sample_time": self.specification.sample_time,
            "continuous_proportional_gain": self.continuous.proportional,
            "continuous_integral_gain": self.continuous.integral,
            "proportional_gain": gains.proportional,
            "integral_gain": gains.integral,
            "estimator_window": float(chosen.window),
            "actuator_delay": self.specification.delay,
            "continuous_settling_time": self.continuous_metrics.settling_time,
            "settling_time": self.sampled_metrics.settling_time,
            "overshoot": self.sampled_metrics.overshoot,
            "phase_margin_deg": self.margins.phase_margin_deg,
            "gain_margin": self.margins.gain_margin,
            "encoder_settling_time": chosen.measures.settling_time,
            "encoder_overshoot": chosen.measures.overshoot,
            "encoder_ripple": chosen.measures.ripple,
            "speed_quantum": chosen.quantum,
            "control_peak_to_peak": chosen.measures.control_peak_to_peak,
            "plain_difference_speed_quantum": plain.quantum,
            "plain_difference_settling_time": plain.measures.settling_time,
            "plain_difference_ripple": plain.measures.ripple,
            "plain_difference_control_peak_to_peak": plain.measures.control_peak_to_peak,
        }

    def results(self) -> dict[str, Any]:
        """Everything the report shows, as JSON values; responses per volt of set-point."""
        run = self.encoder_response
        own = self.estimator.measures
        return {
            "name": self.name,
            "figures": self.figures(),
            "continuous": _response(self.continuous_response, self.continuous_metrics),
            "sampled": {
                "time": run.fine_time.tolist(),
                "value": (run.speed / run.set_point).tolist(),
                "settling_time": own.settling_time,
                "overshoot": own.overshoot,
            },
            "sampled_linear": _response(self.sampled_response, self.sampled_metrics),
            "estimators": [comparison.row() for comparison in self.estimators],
            "loop": self.designed_loop.written(),
            "fidelity": self.fidelity(),
            "diagram": diagram_svg(self.controller),
        }

    def fidelity(self) -> dict[str, Any]:
        """The loop with the controller's numbers as held beside the design; raises `DesignError`.

        Each figure of `loop` as designed and as held; `blocks` as `model.fidelity` compares them.
        """
        own = self.specification
        held = linear_system(as_held(self.controller.lower()))
        loops = {
            "designed": SampledLoop(self.loop, self.discrete.system(), own.window or 1, own.delay),
            "held": SampledLoop(self.loop, held, own.window or 1, own.delay),
        }
        rows = {name: _loop_figures(loop) for name, loop in loops.items()}
        for figure, wanted in rows["designed"].items():
            found = rows["held"][figure]
            if not abs(found - wanted) <= TOLERANCE * max(abs(wanted), TOLERANCE):
                raise DesignError(
                    f"with its numbers as held the loop has {figure} {found:.6g} instead of "
                    f"{wanted:.6g}; use double precision, or a longer sample time"
                )
        return {"loop": rows, **fidelity(self.controller).written()}

    def write_results(self, path: Path) -> None:
        """Write `results` as JSON."""
        atomic_write(path, json.dumps(self.results(), indent=1) + "\n")


def _loop_figures(loop: SampledLoop) -> dict[str, float]:
    """What is compared of a loop: poles by the largest, margins, step response."""
    margins, metrics = loop.margins(), loop.step_metrics()
    return {
        "largest_pole": float(np.abs(loop.poles()).max()),
        "phase_margin_deg": margins.phase_margin_deg,
        "crossover_rad_s": margins.crossover,
        "gain_margin": margins.gain_margin,
        "settling_time": metrics.settling_time,
        "overshoot": metrics.overshoot,
        "final_value": metrics.final_value,
    }


def _response(response: StepResponse, metrics: StepMetrics) -> Mapping[str, Any]:
    return {
        "time": response.time.tolist(),
        "value": response.output.tolist(),
        "settling_time": metrics.settling_time,
        "overshoot": metrics.overshoot,
    }


def compare_estimators(
    loop: SpeedLoop,
    candidates: Mapping[str, tuple[int, DiscretePi]],
    set_point: float,
    supply_voltage: float,
    delay: float,
) -> tuple[EstimatorComparison, ...]:
    """Encoder-true simulation of each candidate (window in samples, gains), in the given order."""
    rows = []
    for name, (window, pi) in candidates.items():
        diagram = pi_diagram(pi, supply_voltage, loop.time_constant)
        runs = [
            encoder_run(
                loop,
                diagram,
                set_point,
                RUN_DURATION,
                window,
                delay=delay,
                phase=index / ENCODER_PHASES,
            )
            for index in range(ENCODER_PHASES)
        ]
        quantum = Encoder().speed_quantum(window * pi.sample_time) * loop.feedback_gain
        rows.append(
            EstimatorComparison(name, window, pi.gains, quantum, set_point, measure_runs(runs))
        )
    return tuple(rows)


def finish_design(
    name: str,
    loop: SpeedLoop,
    specification: LoopSpecification,
    continuous: PiGains,
    discrete: DiscretePi,
    supply_voltage: float,
    set_point: float = 4.0,
) -> Design:
    """The chosen gains with their controller's diagram, ready to generate C from.

    `set_point` (V) is that of the encoder-true simulations.
    """
    return Design(
        name=name,
        loop=loop,
        specification=specification,
        supply_voltage=supply_voltage,
        set_point=set_point,
        continuous=continuous,
        discrete=discrete,
        controller=pi_diagram(discrete, supply_voltage, loop.time_constant),
    )
