# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Everything a run shows, measured once: tasks, processor, step, path; and its criteria."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import CriteriaError, RunFaultError, ScenarioError
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Criterion, Scenario
from ravenbrick.trace.motion import (
    PathMeasures,
    StepMeasures,
    count_difference_speed,
    fitted_speed,
    path_measures,
    step_measures,
)
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import (
    TaskMeasures,
    Utilization,
    by_priority,
    measure_task,
    utilization,
)
from ravenbrick.trace.verdict import ALIVE, Verdict, expects_fault, judge

__all__ = [
    "CriterionResult",
    "RunMeasures",
    "StepRecord",
    "check_survival",
    "evaluate_criteria",
    "measure_run",
    "require_criteria",
    "setpoint_speed",
]

Floats = NDArray[np.float64]
# The encoder's signal is in counts of 1 degree at the output shaft.
RADIANS_PER_COUNT = math.pi / 180
DRIVEN_DUTY = 0xFF


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
    """All measures of one run; `tasks` from high to low priority, `shares` of the processor."""

    tasks: tuple[TaskMeasures, ...]
    shares: tuple[float, ...]
    utilization: Utilization
    steps: Mapping[str, StepRecord]
    path: PathMeasures | None
    powered_off: bool
    end_cycles: int

    def value(self, measure: str) -> float | None:
        """A measure by its name in a scenario's criteria; None when the run did not reach it."""
        if measure == "cpu_utilization":
            return self.utilization.busy
        if measure == "deadline_misses":
            return float(sum(task.deadline_misses for task in self.tasks))
        if measure == "powered_off":
            return float(self.powered_off)
        if measure == "lateral_deviation":
            return self.path.lateral_deviation if self.path else None
        if measure == "distance":
            return self.path.distance if self.path else None
        found = [getattr(step.measures, measure) for step in self.steps.values()]
        if not found or any(value is None for value in found):
            return None
        return float(max(found, key=abs))


@dataclass(frozen=True)
class CriterionResult:
    """A criterion with the value that the run gave."""

    criterion: Criterion
    value: float
    met: bool
    place: str

    @property
    def label(self) -> str:
        """What was measured, and what was expected."""
        return f"{self.criterion.measure} {_expected(self.criterion)}"

    @property
    def shown(self) -> str:
        """The value for people."""
        return f"{self.value:.4g}"

    @property
    def sentence(self) -> str:
        """What is wrong, with file and line."""
        return f"{self.place}: {_sentence(self.criterion, self.value)}"

    def as_json(self) -> dict[str, object]:
        """With plain types."""
        bounds = {"minimum": self.criterion.minimum, "maximum": self.criterion.maximum}
        return {"measure": self.criterion.measure, "value": self.value, **bounds, "met": self.met}


def setpoint_speed(robot: Robot, recording: Recording, motor: str) -> tuple[Floats, Floats] | None:
    """Set-point of a motor's speed over time: s and rad/s; None when the robot names none."""
    for setpoint in robot.setpoints:
        if setpoint.port == motor:
            times, values = recording.signal(f"probe.{setpoint.symbol}")
            return times, values * setpoint.factor
    return None


def _step_begin(
    recording: Recording, setpoint: tuple[Floats, Floats] | None, scenario: Scenario, motor: str
) -> tuple[float, float] | None:
    """Instant (s) and height (rad/s) of the step: the set-point's change, or the first command."""
    assert scenario.step is not None
    begin, end = scenario.step.from_ms / 1000, scenario.step.until_ms / 1000
    if setpoint is not None:
        times, values = setpoint
        changed = np.flatnonzero((times >= begin) & (times < end) & (np.abs(values) > 1e-9))
        return (float(times[changed[0]]), float(values[changed[0]])) if changed.size else None
    commands = recording.of_kind(EventKind.MOTOR_COMMAND)
    for at, _kind, subject, value in commands.tolist():
        instant = recording.clock.seconds(at)
        if "ABC"[subject] == motor and value & DRIVEN_DUTY and begin <= instant < end:
            return instant, 0.0
    return None


def _step_record(
    robot: Robot, scenario: Scenario, recording: Recording, motor: str
) -> StepRecord | None:
    assert scenario.step is not None
    begin = _step_begin(recording, setpoint_speed(robot, recording, motor), scenario, motor)
    if begin is None:
        return None
    times, counts = recording.signal(f"motor.{motor}.encoder")
    _, true = recording.signal(f"motor.{motor}.angular_velocity")
    window = (times >= begin[0]) & (times <= scenario.step.until_ms / 1000)
    if np.count_nonzero(window) < 100:
        return None
    after = times[window] - begin[0]
    fitted = fitted_speed(times, counts, RADIANS_PER_COUNT)[window]
    instants, difference = count_difference_speed(after, counts[window], RADIANS_PER_COUNT, 0.004)
    return StepRecord(
        motor=motor,
        times=after,
        fitted=fitted,
        true=true[window],
        difference_times=instants,
        difference=difference,
        measures=step_measures(after, fitted, begin[1]),
    )


def _steps(robot: Robot, scenario: Scenario, recording: Recording) -> dict[str, StepRecord]:
    if scenario.step is None:
        return {}
    records = (_step_record(robot, scenario, recording, m) for m in scenario.step.motors)
    return {record.motor: record for record in records if record is not None}


def _path(scenario: Scenario, recording: Recording) -> PathMeasures | None:
    if scenario.straight is None or "body.x" not in recording.signals:
        return None
    times, x = recording.signal("body.x")
    _, y = recording.signal("body.y")
    _, heading = recording.signal("body.heading")
    begin, end = scenario.straight.from_ms / 1000, _first_steering(recording)
    window = (times >= begin) & (times <= end)
    if not np.any(window):
        return PathMeasures(None, 0.0)
    straight = path_measures(
        x[window], y[window], float(heading[window][0]), scenario.straight.distance
    )
    whole = float(np.sum(np.hypot(np.diff(x), np.diff(y))))
    return PathMeasures(straight.lateral_deviation, whole)


def _first_steering(recording: Recording) -> float:
    """When a hand first turns a motor, or the end of the run; s."""
    steered = (i.at_cycles for i in recording.inputs if i.name.endswith(".hand_angle") and i.value)
    return recording.clock.seconds(min(steered, default=recording.stop.at_cycles))


def measure_run(robot: Robot, scenario: Scenario, recording: Recording) -> RunMeasures:
    """Measure a run."""
    timed = {task.name for task in robot.tasks if task.release != "background"}
    shares = utilization(recording, {thread.name for thread in recording.threads} - timed)
    return RunMeasures(
        tasks=tuple(
            measure_task(recording, index, robot.task(recording.threads[index].name))
            for index in by_priority(recording)
        ),
        shares=tuple(shares.threads[index] for index in by_priority(recording)),
        utilization=shares,
        steps=_steps(robot, scenario, recording),
        path=_path(scenario, recording),
        powered_off=recording.stop.reason == "power_off",
        end_cycles=recording.stop.at_cycles,
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


def evaluate_criteria(
    scenario: Scenario, recording: Recording, measures: RunMeasures
) -> list[CriterionResult | Verdict]:
    """Each criterion with its value, then each expectation with its verdict.

    Raises `ScenarioError` for one the run never reached.
    """
    results: list[CriterionResult | Verdict] = []
    for criterion in scenario.criteria:
        value = measures.value(criterion.measure)
        if value is None:
            raise scenario.unreachable(
                ("criteria", criterion.index, "measure"),
                f"'{criterion.measure}' was never reached in the run; check the inputs, "
                "or lengthen the run",
            )
        line = scenario.document.line_of(("criteria", criterion.index))
        place = f"{scenario.document.path}:{line}"
        results.append(CriterionResult(criterion, value, _met(criterion, value), place))
    results += [judge(e, recording, measures) for e in scenario.expectations]
    return results


def require_criteria(results: Sequence[CriterionResult | Verdict]) -> None:
    """Raise `CriteriaError` naming the first criterion that is not met; its data lists all."""
    failed = [result.sentence for result in results if not result.met]
    if failed:
        error = CriteriaError(failed[0], detail="\n".join(failed[1:]))
        error.data = {"criteria": [result.as_json() for result in results]}
        raise error


def _met(criterion: Criterion, value: float) -> bool:
    above = criterion.minimum is None or value >= criterion.minimum
    return above and (criterion.maximum is None or value <= criterion.maximum)


def _sentence(criterion: Criterion, value: float) -> str:
    return (
        f"{criterion.measure} is {value:.4g}, expected {_expected(criterion)}; look at the report, "
        "then change the controller or the criterion"
    )


def _expected(criterion: Criterion) -> str:
    bounds = []
    if criterion.minimum is not None:
        bounds.append(f"at least {criterion.minimum:g}")
    if criterion.maximum is not None:
        bounds.append(f"at most {criterion.maximum:g}")
    return " and ".join(bounds)
