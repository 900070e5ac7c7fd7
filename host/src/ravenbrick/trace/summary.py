# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a demonstration with stable keys, for programs that read them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ravenbrick.target.memory import MemoryReport
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario
from ravenbrick.trace.design import Design
from ravenbrick.trace.dynamics import dynamics_summary
from ravenbrick.trace.measures import CriterionResult, RunMeasures, StepRecord
from ravenbrick.trace.motion import SPEED_FILTER
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.verdict import Verdict

__all__ = ["Evidence", "Run", "run_summary", "summary"]


@dataclass(frozen=True)
class Run:
    """A scenario with its recording and measures; `criteria` lists what was checked."""

    scenario: Scenario
    recording: Recording
    measures: RunMeasures
    criteria: Sequence[CriterionResult | Verdict]


@dataclass(frozen=True)
class Evidence:
    """All that a report is made of; None or empty for what was not done."""

    robot: Robot
    design: Design | None
    memory: MemoryReport | None
    drive: Run | None
    open_loop: Run | None
    step: Run | None
    others: tuple[Run, ...]
    same_digest_twice: bool | None

    @property
    def runs(self) -> tuple[Run, ...]:
        """The runs that there are."""
        main = (self.drive, self.open_loop, self.step)
        return (*(run for run in main if run is not None), *self.others)

    @property
    def step_record(self) -> StepRecord | None:
        """The step of the first motor that the scenario asks for."""
        steps = self.step.measures.steps if self.step else {}
        return next(iter(steps.values()), None)


def _tasks(run: Run) -> dict[str, Any]:
    return {
        task.name: {
            "releases": task.releases,
            "response_time_cycles_min": task.response_time_cycles_min,
            "response_time_cycles_mean": task.response_time_cycles_mean,
            "response_time_cycles_max": task.response_time_cycles_max,
            "release_jitter_cycles": task.release_jitter_cycles,
            "release_latency_cycles_max": task.release_latency_cycles_max,
            "deadline_cycles": task.deadline_cycles,
            "deadline_misses": task.deadline_misses,
            "cpu_utilization": share,
        }
        for task, share in zip(run.measures.tasks, run.measures.shares, strict=True)
    }


def _steps(run: Run) -> dict[str, Any]:
    return {
        motor: {
            "setpoint": record.measures.setpoint,
            "final_value": record.measures.final_value,
            "settling_time": record.measures.settling_time,
            "overshoot": record.measures.overshoot,
            "rise_time": record.measures.rise_time,
            "steady_state_error": record.measures.steady_state_error,
        }
        for motor, record in run.measures.steps.items()
    }


def run_summary(run: Run) -> dict[str, Any]:
    """The figures of one run; times in s or cycles, lengths in m, shares 0 to 1."""
    recording, measures = run.recording, run.measures
    return {
        "scenario": run.scenario.name,
        "seed": run.scenario.seed,
        "trace_digest": recording.digest,
        "stop": recording.stop.reason,
        "end_cycles": recording.stop.at_cycles,
        "duration": recording.clock.seconds(recording.stop.at_cycles),
        "cpu_utilization": measures.utilization.busy,
        "interrupt_utilization": measures.utilization.interrupts,
        "kernel_utilization": measures.utilization.kernel,
        "lateral_deviation": measures.path.lateral_deviation if measures.path else None,
        "distance": measures.path.distance if measures.path else None,
        "steps": _steps(run),
        "tasks": _tasks(run),
        "criteria": [result.as_json() for result in run.criteria],
    }


def _deviation(run: Run | None) -> float | None:
    return run.measures.path.lateral_deviation if run and run.measures.path else None


def _simulation_difference(evidence: Evidence) -> float | None:
    """Largest difference of the true speed from the sampled simulation, per set-point."""
    step, design = evidence.step_record, evidence.design
    if step is None or design is None or not step.measures.setpoint:
        return None
    simulated = design.sampled
    within = step.times <= simulated.times[-1]
    expected = np.interp(step.times[within], simulated.times, simulated.values)
    measured = step.true[within] / step.measures.setpoint
    return float(np.max(np.abs(measured - expected)))


def _ratio(evidence: Evidence) -> float | None:
    with_controller, without = _deviation(evidence.drive), _deviation(evidence.open_loop)
    return with_controller / without if with_controller is not None and without else None


def summary(evidence: Evidence) -> dict[str, Any]:
    """All figures; the keys are stable, a figure that was not measured is null."""
    step, drive = evidence.step_record, evidence.drive
    hertz = evidence.runs[0].recording.clock.hertz if evidence.runs else None
    return {
        "robot": evidence.robot.name,
        "settling_time": step.measures.settling_time if step else None,
        "overshoot": step.measures.overshoot if step else None,
        "lateral_deviation_with": _deviation(drive),
        "lateral_deviation_without": _deviation(evidence.open_loop),
        "lateral_deviation_ratio": _ratio(evidence),
        "simulation_difference": _simulation_difference(evidence),
        "trace_digest": drive.recording.digest if drive else None,
        "same_digest_twice": evidence.same_digest_twice,
        "cpu_utilization": drive.measures.utilization.busy if drive else None,
        "tasks": _tasks(drive) if drive else {},
        "dynamics": dynamics_summary(evidence.robot, drive.recording) if drive else None,
        "speed_filter": SPEED_FILTER,
        "clock_hz": [hertz.numerator, hertz.denominator] if hertz else None,
        "design": dict(evidence.design.figures) if evidence.design else None,
        "memory": evidence.memory.as_json() if evidence.memory else None,
        "runs": {run.scenario.name: run_summary(run) for run in evidence.runs},
    }
