# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Everything a run shows, measured once: tasks, processor, step, path; and its criteria."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import CriteriaError, RunFaultError, ScenarioError, UsageError
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.trace.motion import PathMeasures, StepMeasures
from ravenbrick.trace.recording import Recording
from ravenbrick.trace.schedule import TaskMeasures, Utilization, task_plan
from ravenbrick.trace.verdict import ALIVE, CriterionResult, Verdict, expects_fault, judge

__all__ = [
    "RunMeasures",
    "StepRecord",
    "check_survival",
    "evaluate_criteria",
    "measure_run",
    "require_criteria",
    "setpoint_speed",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class StepRecord:
    """A measured step of one motor; times in s after the step, speeds in rad/s, shape (n,)."""

    motor: str
    times: Floats
    fitted: Floats
    true: Floats
    difference_times: Floats
    difference: Floats
    measures: StepMeasures


@dataclass(frozen=True)
class RunMeasures:
    """All measures of one run; `tasks` from high to low priority, `shares` of the processor.

    `native` is the `Measured` of the compiled module, which judges criteria.
    """

    tasks: tuple[TaskMeasures, ...]
    shares: tuple[float, ...]
    utilization: Utilization
    steps: Mapping[str, StepRecord]
    path: PathMeasures | None
    powered_off: bool
    end_cycles: int
    native: Any

    def value(self, measure: str) -> float | None:
        """A measure by its name in a scenario's criteria; None when the run did not reach it."""
        found: float | None = self.native.value(measure)
        return found


def setpoint_speed(robot: Robot, recording: Recording, motor: str) -> tuple[Floats, Floats] | None:
    """Set-point of a motor's speed over time: s and rad/s; None when the robot names none."""
    for setpoint in robot.setpoints:
        if setpoint.port == motor:
            times, values = recording.signal(f"probe.{setpoint.symbol}")
            return times, values * setpoint.factor
    return None


def _plan(robot: Robot, scenario: Scenario) -> dict[str, Any]:
    """What the compiled module must know of the project to measure a run."""
    return {
        "tasks": task_plan(robot.tasks),
        "setpoints": [
            {"port": setpoint.port, "symbol": setpoint.symbol, "factor": setpoint.factor}
            for setpoint in robot.setpoints
        ],
        "step": scenario.step and asdict(scenario.step),
        "straight": scenario.straight and asdict(scenario.straight),
    }


def _step_record(motor: str, columns: Sequence[bytes], measures: StepMeasures) -> StepRecord:
    times, fitted, true, instants, difference = (np.frombuffer(c, "<f8") for c in columns)
    return StepRecord(motor, times, fitted, true, instants, difference, measures)


def measure_run(robot: Robot, scenario: Scenario, recording: Recording) -> RunMeasures:
    """Measure a run; raises `UsageError` when a signal that it needs was not recorded."""
    try:
        native = recording.native.measure(json.dumps(_plan(robot, scenario)))
    except ValueError as error:
        raise UsageError(str(error)) from None
    found = json.loads(native.answer("{}"))["measures"]
    shares = found["utilization"]
    return RunMeasures(
        tasks=tuple(TaskMeasures(**task) for task in found["tasks"]),
        shares=tuple(found["shares"]),
        utilization=Utilization(**{**shares, "threads": tuple(shares["threads"])}),
        steps={
            motor: _step_record(motor, native.step(motor), StepMeasures(**step))
            for motor, step in found["steps"].items()
        },
        path=found["path"] and PathMeasures(**found["path"]),
        powered_off=found["powered_off"],
        end_cycles=found["end_cycles"],
        native=native,
    )


def _run_fault(scenario: Scenario, recording: Recording) -> RunFaultError:
    """The cause first; scenario, instant, source line and LCD behind it."""
    stop = recording.stop
    seconds = recording.clock.seconds(stop.at_cycles)
    picture = [line for line in recording.pictures[-1].text if line.strip()]
    return RunFaultError(
        recording.overflows[0] if stop.reason in ALIVE else stop.message or stop.reason,
        detail="\n".join(
            [
                *([stop.source] if stop.source else []),
                f"scenario '{scenario.name}' ended after {seconds:.6f} s (cycle {stop.at_cycles})",
                *(["On the LCD:", *picture] if picture else []),
                *(f"warning: {warning}" for warning in recording.warnings),
            ]
        ),
    )


def check_survival(scenario: Scenario, recording: Recording) -> None:
    """Raise when the program failed (`RunFaultError`) or an input never came (`ScenarioError`)."""
    stop, clock = recording.stop, recording.clock
    failed = stop.reason not in ALIVE
    if failed and expects_fault(scenario.expectations):
        return
    if failed or recording.overflows:
        raise _run_fault(scenario, recording)
    late = [event for event in scenario.inputs if clock.cycles_of_ms(event.at_ms) > stop.at_cycles]
    if late:
        raise scenario.unreachable(
            ("inputs", late[0].index, "at_ms"),
            f"'{late[0].name}' at {late[0].at_ms} ms never happens: the brick was powered off at "
            f"{1000 * clock.seconds(stop.at_cycles):.1f} ms; move it forward or remove it",
        )
    for timed in scenario.stimuli:
        if timed.at_cycles > stop.at_cycles:
            raise ScenarioError(
                f"{timed.place}: '{timed.name}' at {clock.seconds(timed.at_cycles):.6f} s never "
                f"happens: the brick was powered off at {clock.seconds(stop.at_cycles):.6f} s; "
                "shorten the stimulus"
            )


def _number(bound: float | None) -> str | None:
    """As text, because TOML has numbers that JSON lacks."""
    return None if bound is None else repr(float(bound))


def evaluate_criteria(scenario: Scenario, measures: RunMeasures) -> list[CriterionResult | Verdict]:
    """Each criterion with its value, then each expectation with its verdict.

    Raises `ScenarioError` for one the run never reached.
    """
    bounds = [
        {"measure": c.measure, "minimum": _number(c.minimum), "maximum": _number(c.maximum)}
        for c in scenario.criteria
    ]
    rows = json.loads(measures.native.answer(json.dumps({"criteria": bounds})))["criteria"]
    results: list[CriterionResult | Verdict] = []
    for criterion, row in zip(scenario.criteria, rows, strict=True):
        if "problem" in row:
            raise scenario.unreachable(("criteria", criterion.index, "measure"), row["problem"])
        line = scenario.document.line_of(("criteria", criterion.index))
        results.append(
            CriterionResult(
                criterion=criterion,
                value=row["value"],
                met=row["met"],
                place=f"{scenario.document.path}:{line}",
                label=row["label"],
                shown=row["shown"],
                problem=row["sentence"],
            )
        )
    return [*results, *(judge(e, measures) for e in scenario.expectations)]


def require_criteria(results: Sequence[CriterionResult | Verdict]) -> None:
    """Raise `CriteriaError` naming the first criterion that is not met; its data lists all."""
    failed = [result.sentence for result in results if not result.met]
    if failed:
        error = CriteriaError(failed[0], detail="\n".join(failed[1:]))
        error.data = {"criteria": [result.as_json() for result in results]}
        raise error
