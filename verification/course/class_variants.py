# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A class of 300: each student's own answers pass, and a neighbour's do not.

`python -m verification.course.class_variants [COUNT]` writes docs/reference/class-variants.md. The
answers of sheet 3 are estimated from the recordings that a student gets, with
`ravenbrick identify`'s method; those of the other sheets are what the steps of the sheet give.
Every hand-in is judged by the truth of every other student: COUNT * (COUNT - 1) pairs.
"""

from __future__ import annotations

import json
import math
import runpy
import sys
import tempfile
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.codegen import prove
from ravenbrick.control import pi_diagram, pi_direct
from ravenbrick.control.estimation.identification import fit_motor
from ravenbrick.grading.answers import Answers, parse_wanted
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.student_folder import own_recording, recorded_scenarios
from ravenbrick.grading.variants import Variant, filled
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

from tools.docs.lessons import edited, files_of, steps
from verification.commands import Counts
from verification.support.paths import ROOT

PAGE = ROOT / "docs" / "reference" / "class-variants.md"
LESSONS = ROOT / "docs" / "lessons"
RUBRICS = LESSONS / "rubrics"
OVERLOAD = LESSONS / "20-overload.md"
COUNT, WORKERS = 300, 2
KEY = sha256(b"the class of the measurement").digest()
MOST = 0.01
HELD_MS = 1_900
SIGNALS = ("motor.B.voltage", "motor.B.encoder")


@dataclass(frozen=True)
class Measured:
    """Of a sheet: how many students pass with their own answers, and pairs with another's."""

    sheet: str
    students: int
    own: int
    copied: int
    points: float
    """Mean share of the points for own numbers that a copied hand-in gets."""

    @property
    def pairs(self) -> int:
        """Of a student and another's hand-in."""
        return self.students * (self.students - 1)

    @property
    def share(self) -> float:
        """Of copied hand-ins that pass."""
        return self.copied / self.pairs


@cache
def _rubric(sheet: str) -> Rubric:
    return read_rubric(RUBRICS / f"{sheet}.toml")


@cache
def _image(project: Path) -> ElfImage:
    return build_image(Workspace.of(project), read_robot(project), "ram").image


def _identified(variant: Variant) -> dict[str, float]:
    scenario, project = next(iter(recorded_scenarios(_rubric("lab-03")).items()))
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
    robot = _rubric("lab-10").robot
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
    design = runpy.run_path(str(_rubric("lab-11").project / "design.py"))
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


SHEETS: Mapping[str, Callable[[Variant], dict[str, float]]] = {
    "lab-02": _estimated,
    "lab-03": _identified,
    "lab-04": _designed,
    "lab-05": _sampled,
    "lab-06": _timed,
    "lab-07": _analysed,
    "lab-08": _proved,
    "lab-10": _calibrated,
    "lab-11": _steered,
    "lab-13": _locked,
    "lab-14": _counted,
    "lab-20": _scheduled,
}


def _student(job: tuple[str, int]) -> tuple[list[Any], dict[str, float]]:
    """Wanted answers with their points, and the answers of an honest student."""
    sheet, number = job
    rubric = _rubric(sheet)
    variant = rubric.variant(KEY, f"student-{number:03}")
    checks = [check for check in rubric.checks if check.own and check.kind == "answer"]
    wanted = [(parse_wanted(filled(c.own, variant.facts)), c.points) for c in checks]
    return wanted, SHEETS[sheet](variant)


def measure(sheet: str, count: int) -> Measured:
    """Judge each hand-in by the truth of each student."""
    jobs = [(sheet, number) for number in range(count)]
    with ProcessPoolExecutor(WORKERS) as pool:
        class_ = list(pool.map(_student, jobs, chunksize=5))
    own = copied = 0
    points = 0.0
    for place, (wanted, _) in enumerate(class_):
        whole = sum(weight for _, weight in wanted)
        for other, (_, answers) in enumerate(class_):
            got = sum(w for bound, w in wanted if bound.judge(Answers(dict(answers)))[0])
            if place == other:
                own += got == whole
            else:
                copied += got == whole
                points += got / whole
    return Measured(sheet, count, own, copied, points / (count * (count - 1)))


def page(rows: list[Measured]) -> str:
    """The reference page."""
    lines = [
        "# Copied hand-ins in a class with own numbers",
        "",
        "Generated by `python -m verification.course.class_variants`; do not edit. Each student of",
        f"a class of {rows[0].students} has a [variant](../guides/class.md) of each sheet. Each",
        "hand-in is judged by the numbers of its author and by those of every other student.",
        "*Passes* means that all answers with own numbers hold; otherwise a submission gets",
        "at most the share of all points that the rubric states (0.4), which is no pass. *Points*",
        "is the mean share of the points for own numbers that a copied hand-in still gets.",
        "",
        "| Sheet | Own hand-ins pass | Copied hand-ins pass | Share | Points of a copy |",
        "|---|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {m.sheet} | {m.own} of {m.students} | {m.copied} of {m.pairs} | {m.share:.3%} "
        f"| {m.points:.1%} |"
        for m in rows
    ]
    return "\n".join([*lines, ""])


def main(count: int = COUNT) -> list[Measured]:
    """Measure all sheets; write the page for the whole class."""
    rows = [measure(sheet, count) for sheet in SHEETS]
    if count == COUNT:
        PAGE.write_text(page(rows), encoding="utf-8")
    return rows


def suite() -> Counts:
    """Sheets where every own hand-in passes, and under 1 % of the copied ones."""
    rows = main()
    good = [m for m in rows if m.own == m.students and m.share < MOST]
    return Counts(len(rows), len(good), [], [m.sheet for m in rows if m not in good])


if __name__ == "__main__":
    found = main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
    print(json.dumps([vars(m) | {"share": m.share} for m in found], indent=1))
