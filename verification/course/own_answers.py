# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What an honest student answers in each sheet with own numbers.

The answers of sheet 3 are estimated from the recordings that a student gets, with
`ravenbrick identify`'s method; those of the other sheets are what the steps of the sheet give,
where there is one by another way than the rubric's expression.
"""

from __future__ import annotations

import math
import runpy
import struct
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.codegen import prove
from ravenbrick.control import pi_diagram, pi_direct
from ravenbrick.control.estimation.identification import fit_motor
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.student_folder import own_recording, recorded_scenarios
from ravenbrick.grading.variants import Variant
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.model import (
    NXT_MOTOR,
    FixedPointOptions,
    IntegrationMethod,
    Rounding,
    SpeedLoop,
    to_fixed_point,
)
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.schedule import CriticalSection, Task, TaskSet, simulate
from ravenbrick.schedule.report import analysis
from ravenbrick.schedule.task_file import read_task_file
from ravenbrick.trace.motor_data import signal_data
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

from tools.docs.lessons import edited, files_of, steps
from verification.support.paths import ROOT

LESSONS = ROOT / "docs" / "lessons"
RUBRICS = LESSONS / "rubrics"
OVERLOAD = LESSONS / "20-overload.md"
HELD_MS = 1_900
SIGNALS = ("motor.B.voltage", "motor.B.encoder")


@cache
def rubric_of(sheet: str) -> Rubric:
    """The rubric of this name."""
    return read_rubric(RUBRICS / f"{sheet}.toml")


@cache
def _image(project: Path) -> ElfImage:
    return build_image(Workspace.of(project), read_robot(project), "ram").image


def _identified(variant: Variant) -> dict[str, float]:
    scenario, project = next(iter(recorded_scenarios(rubric_of("lab-03")).items()))
    recording = own_recording(variant, scenario, _image(project))
    found = {p.name: p.value for p in fit_motor(signal_data(recording, *SIGNALS)).parameters}
    return {
        "gain_rad_s_v": round(found["gain"], 3),
        "time_constant_ms": round(1000 * found["time_constant"], 2),
        "friction_v": round(found["friction_voltage"], 4),
    }


def _designed(variant: Variant) -> dict[str, float]:
    return {"proportional_gain": float(f"{variant.facts['proportional_gain']:.4g}")}


def _estimated(variant: Variant) -> dict[str, float]:
    """Sheet 2: per cent of the battery's 8 V for one count, and half of the window."""
    facts = variant.facts
    step = 100 * facts["proportional_gain"] * facts["speed_quantum"] / 8
    return {
        "duty_step_window_percent": float(f"{step:.3g}"),
        "window_delay_ms": 4 * variant.numbers["window_samples"] / 2,
    }


def _sampled(variant: Variant) -> dict[str, float]:
    """Sheet 5: the design with the long period, half of it at 9.78 rad/s, and the alias."""
    period_s = variant.numbers["long_period_ms"] / 1000
    return {
        "margin_long_period_deg": round(variant.facts["phase_margin_deg"], 1),
        "hold_long_period_deg": round(math.degrees(9.78 * period_s / 2), 1),
        "alias_hz": round(1 / period_s - variant.numbers["ripple_hz"], 2),
    }


def _timed(variant: Variant) -> dict[str, float]:
    """Whole milliseconds, as the program of sheet 6 shows them."""
    n = variant.numbers
    return {
        "own_ms": n["high_ms"],
        "low_ms": n["low_ms"] - 10,
        "middle_ms": int(0.99 * n["middle_ms"]),
    }


def _calibrated(variant: Variant) -> dict[str, float]:
    """The count that the balancer's display shows while a hand holds it, and what it is off by."""
    robot = rubric_of("lab-10").robot
    scenario = read_scenario(scenario_path(robot.directory, "let-go"), robot)
    held = replace(scenario, duration_ms=HELD_MS, inputs=(), criteria=(), expectations=())
    shown = VirtualTarget().run(variant.robot, held, _image(robot.directory)).screens[-1].text
    (count,) = (int(line.split()[1]) for line in shown if line.startswith("rest"))
    (gyro,) = (plugged.rest for plugged in variant.robot.sensor_ports.values() if plugged.rest)
    return {"rest_counts": count, "offset_deg_s": round(gyro.value - count, 1)}


def _counted(variant: Variant) -> dict[str, float]:
    """Sheet 14: a change is half a degree, and at most one may come between two looks."""
    n = variant.numbers
    return {
        "fastest_polled_deg_s": float(f"{500 / n['polling_period_ms']:.3g}"),
        "drill_interval_us": float(f"{500_000 / n['drill_deg_s']:.3g}"),
    }


def _analysed(variant: Variant) -> dict[str, float]:
    """The example of sheet 7 with the own execution times."""
    text = files_of(LESSONS / "07-response.md")["example.toml"]
    own = [variant.numbers[f"{name}_wcet_us"] / 1000 for name in ("fast", "middle", "slow")]
    changes = [(f"wcet = {old}", f"wcet = {new:g}") for old, new in enumerate(own, 1)]
    (slow,) = (task for task in _analysis(text, *changes)["tasks"] if task["name"] == "slow")
    return {
        "slow_response_ms": round(float(slow["response_time_bound"]), 2),
        "slow_longest_ms": round(float(slow["wcet_max"]), 2),
    }


def _proved(variant: Variant) -> dict[str, float]:
    """What `fixed.py` of sheet 8 prints with the own range of the inputs."""
    loop = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
    pi = pi_direct(loop, 0.4, 0.004, IntegrationMethod.FORWARD_EULER)
    diagram = pi_diagram(pi, 8.0, loop.time_constant)
    inputs = dict.fromkeys(("Input_Voltage", "Real_Voltage"), variant.numbers["input_range_v"])
    found = {}
    for rounding in Rounding:
        options = FixedPointOptions({**inputs, "Integral": 16.0}, rounding=rounding)
        (error,) = prove(to_fixed_point(diagram, options)).one_step.values()
        found[f"error_{rounding.value.replace(' ', '_')}_mv"] = round(1000 * error, 4)
    return found


def _steered(variant: Variant) -> dict[str, float]:
    """What design.py of sheet 11 prints with the own numbers, and with half of the damping."""
    design = runpy.run_path(str(rubric_of("lab-11").project / "design.py"))
    constants = design["proportional_gain"].__globals__
    constants["CRUISE_VOLTAGE"] = variant.numbers["cruise_v"]
    speed = constants["WHEEL_RADIUS"] * NXT_MOTOR.gain * constants["CRUISE_VOLTAGE"]
    found = {}
    for answer, share in (("curve_error_half_damping", 0.5), ("curve_error", 1.0)):
        constants["DAMPING"] = share * variant.numbers["damping"]
        gain = design["proportional_gain"](speed)
        found[answer] = float(f"{design['curve_error'](speed, gain, 0.3):.3g}")
    return found | {"proportional_gain": float(f"{gain:.3g}")}


def _locked(variant: Variant) -> dict[str, float]:
    """The first two schedules of sheet 13 with the own computing times, simulated."""
    low, middle = (int(variant.numbers[name]) for name in ("low_ms", "middle_ms"))
    tasks = TaskSet(
        (
            Task("high", 40, 1, priority=3, phase=3, sections=(CriticalSection("store", 1),)),
            Task("middle", 40, middle, priority=2, phase=4),
            Task("low", 40, low, priority=1, sections=(CriticalSection("store", low),)),
        )
    )
    flag, ceiling = (
        next(job for job in simulate(tasks, 40, protocol=protocol).jobs if job.task.name == "high")
        for protocol in ("none", "immediate_ceiling")
    )
    return {
        "response_with_flag_ms": float(flag.completion - flag.release),
        "blocking_ms": float(ceiling.completion - ceiling.release - 1),
    }


def _scheduled(variant: Variant) -> dict[str, float]:
    """The task sets of sheet 20 with the own numbers, analysed as its steps do."""
    numbers, written = variant.numbers, files_of(OVERLOAD)
    (change,) = (
        step.content
        for step in steps(OVERLOAD.read_text("utf-8"))
        if (step.kind, step.argument) == ("edit", "polling.toml")
    )
    control, period = (
        numbers[name] / 1000 for name in ("first_set_control_us", "polling_server_period_us")
    )
    first = _analysis(written["taskset.toml"], ("wcet = 1.6", f"wcet = {control:g}"))
    polling = edited(written["background.toml"], change)
    set_ = _analysis(polling, ("period = 8", f"period = {period:g}"))
    (served,) = set_["servers"][0]["tasks"]
    (line,) = (task for task in first["tasks"] if task["name"] == "line")
    return {
        "line_longest_ms": round(float(line["wcet_max"]), 2),
        "polling_bound_ms": round(float(served["response_time_bound"]), 1),
    }


def _analysis(taskset: str, *changes: tuple[str, str]) -> dict[str, Any]:
    """Of a task set with changed lines, as `ravenbrick schedule` makes it."""
    for old, new in changes:
        taskset = edited(taskset, f"-{old}\n+{new}\n")
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "taskset.toml"
        file.write_text(taskset, encoding="utf-8")
        return analysis(read_task_file(file, None))


def _driven(variant: Variant) -> dict[str, float]:
    """Sheet 9: a drive without control with the own right motor, and the braking of the motor."""
    folder = ROOT / "examples" / "vehicle"
    robot, numbers = read_robot(folder), variant.numbers
    scenario = read_scenario(scenario_path(folder, "drive-open-loop"), robot)
    nominal, own = robot.motor_values("C"), dict(scenario.deviations["C"])
    for name in ("torque_constant", "electric_constant"):
        own[name] = numbers["right_factor"] * nominal[name]
    drive = replace(scenario, deviations={"C": own}, duration_ms=9_100, pictures_ms=(), criteria=())
    run = VirtualTarget().run(robot, drive, _image(folder))
    left, right = (
        float(np.diff(np.interp((3.0, 9.0), *run.signal(f"motor.{port}.encoder")))[0])
        for port in "BC"
    )
    share = 2 * abs(right - left) / (right + left)
    assert robot.body is not None
    track = robot.body.quantities["track"].value
    # tau e'' + e' + k e = 0 from the limit v on, with the outer loop as fast as the inner one.
    tau, gain, speed = 0.1, 10.0, 116 * numbers["limit_v"]
    step = expm(np.array([[0.0, 1.0], [-gain / tau, -1 / tau]]) * 1e-4)
    state, peak = np.array([speed / gain, -speed]), 0.0
    for _ in range(10_000):
        state = step @ state
        peak = max(peak, -float(state[0]))
    return {
        "speed_difference_percent": round(100 * share, 1),
        "radius_m": round(track / share, 2),
        "overshoot_deg": round(peak, 1),
    }


def _waited(variant: Variant) -> dict[str, float]:
    """Sheet 12: 144 relative waits, and the latest stop over the phases of a press."""
    read_ms, timeout_ms, period_ms = (
        variant.numbers["read_us"] / 1000, variant.numbers["timeout_ms"], 20
    )  # fmt: skip
    release = 0.0
    for _ in range(144):
        release += read_ms + period_ms
    stops = []
    for pressed_us in range(1, 20_001):
        seen_ms = period_ms * math.ceil(pressed_us / 20_000)
        stop_ms = period_ms * math.ceil((seen_ms + timeout_ms) / period_ms)
        stops.append(stop_ms - pressed_us / 1000)
    return {
        "lateness_ms": round(release - 144 * period_ms, 2),
        "latest_stop_ms": round(max(stops), 1),
    }


def _shared(variant: Variant) -> dict[str, float]:
    """Sheet 15: the filter in single precision, called for both motors with one state."""
    factor = np.float32(0.5) * np.float32(variant.numbers["gain_percent"] / 100)
    state, inputs = np.float32(0), (np.float32(variant.numbers["left_input"]), np.float32(0))
    shown = [0.0, 0.0]
    for _ in range(126):
        for side, wanted in enumerate(inputs):
            state += factor * (wanted - state)
            shown[side] = round(float(state), 1)
    return {"shared_left": shown[0], "shared_right": shown[1]}


def _required(variant: Variant) -> dict[str, float]:
    """Sheet 16: design.py for the own R5 with four digits, and the budget of the own R6."""
    design = runpy.run_path(str(rubric_of("lab-16-3").project / "design.py"))["design"]
    design.__globals__["SETTLING_TIME"] = variant.numbers["settling_time_ms"] / 1000
    figures = design().figures()
    heading = variant.numbers["deviation_mm"] / 2_000
    return {
        "proportional_gain": float(f"{figures['proportional_gain']:.4g}"),
        "integral_gain": float(f"{figures['integral_gain']:.4g}"),
        "phase_margin_deg": round(figures["phase_margin_deg"], 1),
        "wheel_difference_deg": round(math.degrees(heading * 115 / 28), 1),
    }


def _fused(variant: Variant) -> dict[str, float]:
    """Sheet 17: the least error of formula (4), found by trying time constants."""
    offset, noise = variant.numbers["offset_deg_s"], variant.numbers["noise_deg_s"]
    found = minimize_scalar(
        lambda tau: math.hypot(offset * tau, noise / tau), bounds=(0.1, 10), method="bounded"
    )
    return {
        "formula_time_constant_s": round(float(found.x), 3),
        "formula_error_deg": round(float(found.fun), 3),
    }


def _supervised(variant: Variant) -> dict[str, float]:
    """Sheet 18: the supervision's looks at a task that never ends, as its Background says."""
    now_ms, counter = 0.0, 0
    while counter <= 1000:
        now_ms += 2
        late = now_ms >= variant.numbers["deadline_ms"]
        counter = counter + 20 if late else max(counter - 2, 0)
    return {"stop_ms": now_ms, "way_mm": round(variant.numbers["speed_mm_s"] * now_ms / 1000, 1)}


def _published(variant: Variant) -> dict[str, float]:
    """Sheet 19: bytes of the frames of a second, and of how many periods a queue holds samples."""
    values = int(variant.numbers["published_values"])
    period_ms = int(variant.numbers["published_period_ms"])
    frame = struct.calcsize(f"<BBHI{values}f") + 4
    return {
        "link_bytes_per_s": round(frame * 1000 / period_ms),
        "link_pause_ms": 24 * period_ms,
    }


SHEETS: Mapping[str, Callable[[Variant], dict[str, float]]] = {
    "lab-02": _estimated,
    "lab-03": _identified,
    "lab-04": _designed,
    "lab-05": _sampled,
    "lab-06": _timed,
    "lab-07": _analysed,
    "lab-08": _proved,
    "lab-09": _driven,
    "lab-10": _calibrated,
    "lab-11": _steered,
    "lab-12": _waited,
    "lab-13": _locked,
    "lab-14": _counted,
    "lab-15": _shared,
    "lab-16-3": _required,
    "lab-17": _fused,
    "lab-18": _supervised,
    "lab-19": _published,
    "lab-20": _scheduled,
}
