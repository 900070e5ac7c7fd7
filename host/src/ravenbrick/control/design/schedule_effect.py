# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the schedule does to a loop: periodic samples beside the instants of a recorded run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ravenbrick.control.design.design_plots import DesignedLoop
from ravenbrick.control.estimation.encoder_run import (
    EncoderRun,
    RunMeasures,
    SampleTiming,
    encoder_run,
    measure_runs,
)
from ravenbrick.control.synthesis.controller import pi_diagram
from ravenbrick.control.synthesis.tuning import DiscretePi
from ravenbrick.model import IntegrationMethod
from ravenbrick.model.lazy import control

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["schedule_effect", "schedule_figure", "timing_row"]

_PHASES = (0.0, 0.25, 0.5, 0.75)
_DURATION = 1.0
_SUPPLY_VOLTAGE = 9.0


@dataclass(frozen=True, eq=False)
class ScheduleCase:
    """A schedule's name, the first run with it, and the measures over four encoder phases."""

    name: str
    run: EncoderRun
    measures: RunMeasures

    def row(self) -> dict[str, float | str]:
        """The measures by name, for tables."""
        return {
            "schedule": self.name,
            "settling_time": self.measures.settling_time,
            "overshoot": self.measures.overshoot,
            "ripple": self.measures.ripple,
            "control_peak_to_peak": self.measures.control_peak_to_peak,
        }


def schedule_effect(
    designed: DesignedLoop, timing: SampleTiming, set_point: float = 4.0
) -> tuple[ScheduleCase, ...]:
    """A step of `set_point` (V) without delay, with the design's delay, and as recorded."""
    own = designed.specification
    pi = _pi_of(designed.controller, own.sample_time)
    diagram = pi_diagram(pi, _SUPPLY_VOLTAGE, designed.loop.time_constant)
    schedules = {
        "periodic, no delay": SampleTiming.constant(0.0),
        "periodic, the design's delay": SampleTiming.constant(own.delay),
        "as recorded": timing,
    }
    cases = []
    for name, schedule in schedules.items():
        runs = [
            encoder_run(designed.loop, diagram, set_point, _DURATION, own.window,
                        phase=phase, timing=schedule)
            for phase in _PHASES
        ]  # fmt: skip
        cases.append(ScheduleCase(name, runs[0], measure_runs(runs)))
    return tuple(cases)


def _pi_of(system: control.StateSpace, sample_time: float) -> DiscretePi:
    """The gains of a controller that is a PI, from its response to the set-point."""
    times = np.arange(3) * sample_time
    given = np.zeros((system.ninputs, 3))
    given[0, 0] = 1.0
    found = np.ravel(control.forced_response(system, times, given).outputs)[:3]
    proportional, step = float(found[0]), float(found[1])
    return DiscretePi(proportional, step, sample_time, IntegrationMethod.FORWARD_EULER)


def schedule_figure(cases: tuple[ScheduleCase, ...], timing: SampleTiming) -> Figure:
    """Speed and voltage of each case, and below when the recorded run sampled and acted."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 8), layout="constrained")
    speed, voltage, instants = figure.subplots(3, 1)
    for case in cases:
        run = case.run
        speed.plot(run.fine_time, run.speed / run.set_point, label=case.name, linewidth=1)
        voltage.step(run.time, run.control, where="post", linewidth=1)
    speed.axhspan(0.98, 1.02, color="0.9", zorder=0)
    speed.set_ylabel("true speed / set-point")
    speed.legend(fontsize="small", loc="lower right")
    voltage.set_ylabel("motor voltage (V)")
    voltage.set_xlabel("time (s)")
    for axis in (speed, voltage):
        axis.set_xlim(0, _DURATION)
    samples = np.arange(len(timing.release))
    instants.plot(samples, 1e6 * timing.release, ".", markersize=3, label="release")
    instants.plot(samples, 1e6 * (timing.release + timing.delay), ".", markersize=3,
                  label="new voltage")  # fmt: skip
    instants.set_xlabel("sample of the recorded run")
    instants.set_ylabel("after the period's begin (us)")
    instants.set_yscale("log")
    instants.legend(fontsize="small")
    return figure


def timing_row(timing: SampleTiming) -> dict[str, Any]:
    """Least and largest release and delay, us."""
    release, delay = 1e6 * timing.release, 1e6 * timing.delay
    return {
        "samples": len(release),
        "release_us": [float(release.min()), float(release.max())],
        "delay_us": [float(delay.min()), float(delay.max())],
    }
