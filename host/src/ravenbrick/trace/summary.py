# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a demonstration with stable keys, for programs that read them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ravenbrick.errors import RavenbrickError
from ravenbrick.image.memory import MemoryReport
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.trace.design import Design
from ravenbrick.trace.dynamics import (
    HandlerDynamics,
    TaskDynamics,
    dynamics_summary,
    handler_dynamics,
    task_dynamics,
)
from ravenbrick.trace.measures import RunMeasures, StepRecord
from ravenbrick.trace.motion import speed_filter
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.verdict import CriterionResult, Verdict

__all__ = ["ROLES", "Evidence", "Run", "run_summary", "summary"]


ROLES = ("drive", "open_loop", "step")


@dataclass(frozen=True)
class Run:
    """A scenario with its recording and measures; `criteria` lists what was checked.

    `problem`: why the run could not be judged, if so. `image_is_newer`: the recording is of an
    older image than the project's. `title`: its name in the report, the scenario's unless given.
    """

    robot: Robot
    scenario: Scenario
    recording: Recording
    measures: RunMeasures
    criteria: Sequence[CriterionResult | Verdict]
    problem: RavenbrickError | None = None
    image_is_newer: bool = False
    title: str = ""

    @property
    def met(self) -> bool:
        """Whether the program survived and all that was checked holds."""
        return self.problem is None and all(result.met for result in self.criteria)

    @cached_property
    def task_dynamics(self) -> tuple[TaskDynamics, ...]:
        """Distributions of each task's jobs."""
        return task_dynamics(self.robot, self.recording)

    @cached_property
    def handler_dynamics(self) -> tuple[HandlerDynamics, ...]:
        """Distributions of each interrupt source's handlers."""
        return handler_dynamics(self.recording)


@dataclass(frozen=True)
class Evidence:
    """All that a report is made of; None or empty for what was not done.

    `runs`: at least one, in the order of the report. `bounds`: response times in cycles, by task.
    """

    robot: Robot
    design: Design | None
    memory: MemoryReport | None
    runs: tuple[Run, ...]
    same_digest_twice: bool | None
    bounds: Mapping[str, int] = field(default_factory=dict)

    def with_role(self, role: str) -> Run | None:
        """The run whose scenario has this role."""
        return next((run for run in self.runs if run.scenario.role == role), None)

    @property
    def main(self) -> Run:
        """The run that stands for the project: the drive, or the first."""
        return self.with_role("drive") or self.runs[0]

    @property
    def step_record(self) -> StepRecord | None:
        """The first motor's step in the run of that role, or else in the first that has one."""
        runs = [run for run in (self.with_role("step"), *self.runs) if run is not None]
        records = (record for run in runs for record in run.measures.steps.values())
        return next(records, None)


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
        "problem": None if run.problem is None else run.problem.sentence,
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
        "warnings": list(recording.warnings),
    }


def _deviation(run: Run | None) -> float | None:
    return run.measures.path.lateral_deviation if run and run.measures.path else None


def _simulation_difference(evidence: Evidence) -> float | None:
    """Largest difference of the true speed from the sampled simulation, per set-point."""
    step, design = evidence.step_record, evidence.design
    simulated = design.responses.get("sampled") if design else None
    if step is None or simulated is None or not step.measures.setpoint:
        return None
    within = step.times <= simulated.times[-1]
    expected = np.interp(step.times[within], simulated.times, simulated.values)
    measured = step.true[within] / step.measures.setpoint
    return float(np.max(np.abs(measured - expected)))


def _ratio(evidence: Evidence) -> float | None:
    with_controller = _deviation(evidence.with_role("drive"))
    without = _deviation(evidence.with_role("open_loop"))
    return with_controller / without if with_controller is not None and without else None


def summary(evidence: Evidence) -> dict[str, Any]:
    """All figures; the keys are stable, a figure that was not measured is null."""
    step, main = evidence.step_record, evidence.main
    hertz = main.recording.clock.hertz
    return {
        "robot": evidence.robot.name,
        "settling_time": step.measures.settling_time if step else None,
        "overshoot": step.measures.overshoot if step else None,
        "lateral_deviation_with": _deviation(evidence.with_role("drive")),
        "lateral_deviation_without": _deviation(evidence.with_role("open_loop")),
        "lateral_deviation_ratio": _ratio(evidence),
        "simulation_difference": _simulation_difference(evidence),
        "trace_digest": main.recording.digest,
        "same_digest_twice": evidence.same_digest_twice,
        "cpu_utilization": main.measures.utilization.busy,
        "tasks": _tasks(main),
        "dynamics": dynamics_summary(main.task_dynamics, main.handler_dynamics),
        "speed_filter": speed_filter(),
        "clock_hz": [hertz.numerator, hertz.denominator],
        "design": dict(evidence.design.figures) if evidence.design else None,
        "memory": evidence.memory.as_json() if evidence.memory else None,
        "runs": {run.scenario.name: run_summary(run) for run in evidence.runs},
    }
