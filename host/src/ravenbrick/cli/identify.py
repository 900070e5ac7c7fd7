# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick identify`: experiment, fit, validation, plant parameters."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.build import ImageChoice, ImageOption
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image, run_scenario
from ravenbrick.control.estimation.identification import (
    IdentifiedMotor,
    MotorData,
    Validation,
    fit_motor,
    predict_counts,
    validate_motor,
)
from ravenbrick.errors import DesignError, UsageError, shown_path
from ravenbrick.open_data.data_record import read_data_record
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.motor_data import motor_data, signal_data
from ravenbrick.trace.recording import Recording

__all__ = ["identify_command"]

_LARGEST_ERROR = 5.0
_KNOWN = ("resistance", "torque_constant", "electric_constant")


def _names(text: str) -> tuple[str, str]:
    voltage, colon, angle = text.partition(":")
    if not (voltage and colon and angle):
        raise UsageError(f"--signals {text}: expected VOLTAGE:ANGLE, the names of two signals")
    return voltage, angle


@command("ravenbrick identify . experiments/identify.toml experiments/identify-check.toml")
def identify_command(
    directory: ProjectArgument,
    scenario: Annotated[
        str,
        typer.Argument(
            help="Open-loop experiment (scenario), live recording (.npz) or record (.json)."
        ),
    ],
    validation: Annotated[
        str, typer.Argument(help="Second experiment, recording or record, for validation.")
    ],
    motor: Annotated[str, typer.Option(help="Motor: A, B or C.")] = "B",
    signals: Annotated[
        str,
        typer.Option(help="Signals VOLTAGE:ANGLE of a live recording, in V and encoder counts."),
    ] = "control:angle",
    output: Annotated[
        Path | None, typer.Option(help="File for the parameters (default: motor-<MOTOR>.toml).")
    ] = None,
    image: ImageOption = ImageChoice.RAM,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace = Workspace.of(directory)
    robot = read_robot(directory)
    reporter = Reporter(json_output, total=4)
    runs: list[MotorData] = []
    for name in (scenario, validation):
        if name.endswith(".json"):
            runs.append(read_data_record(Path(name)).motor_data())
            continue
        if name.endswith(".npz"):
            recorded = Recording.load(workspace.named_recording(name))
            runs.append(signal_data(recorded, *_names(signals)))
            continue
        loaded = project_image(workspace, robot, image.kind, reporter)
        chosen = read_scenario(scenario_path(directory, name), robot)
        with reporter.step(f"run '{chosen.name}'") as step:
            recording = run_scenario(
                workspace, robot, chosen, loaded, VirtualTarget(), step.progress
            )
            runs.append(motor_data(recording, motor))
            step.note = f"{len(runs[-1].time)} samples, {len(runs[-1].voltage)} voltages"
    with reporter.step("fit") as step:
        found = fit_motor(runs[0])
        step.note = f"error {found.error:.2f} counts"
    with reporter.step("validate") as step:
        checked = validate_motor(found, runs[1])
        band = predict_counts(found, runs[1])
        covered = band.covers(runs[1].count)
        step.note = (
            f"error {checked.error:.2f} counts, {checked.share:.4%} explained; band of +-"
            f"{band.half_width:.1f} counts {'covers' if covered else 'does not cover'} it"
        )
    reporter.table(
        ("parameter", "unit", "value", "low", "high"),
        [[p.name, p.unit, *(f"{v:.6g}" for v in (p.value, p.low, p.high))]
         for p in found.parameters],
        left=("unit",),
    )  # fmt: skip
    if checked.error > _LARGEST_ERROR:
        raise DesignError(
            f"the fitted motor is off by {checked.error:.1f} counts on '{validation}'; the motor "
            "is loaded, changes, or is not of this model: nothing was written"
        )
    path = output or workspace.design_file.parent / f"motor-{motor}.toml"
    constants, reason = _constants(found, robot, motor)
    source = f"identified from '{scenario}'"
    text = _parameter_file(found, checked, f"Motor {motor} of '{robot.name}'", source)
    atomic_write(path, text + _constants_table(constants, reason, source))
    reporter.print(f"parameters: {shown_path(path)}")
    if reason:
        reporter.print(f"without the constants for robot.toml: {reason}")
    return {
        "motor": motor,
        "parameters": {p.name: {"value": p.value, "low": p.low, "high": p.high, "unit": p.unit}
                       for p in found.parameters},
        "fit_error_counts": found.error,
        "validation_error_counts": checked.error,
        "prediction_half_width_counts": band.half_width,
        "prediction_covers": covered,
        "constants": dict(constants) or None,
        "file": str(path),
    }  # fmt: skip


def _constants(found: IdentifiedMotor, robot: Robot, motor: str) -> tuple[Mapping[str, float], str]:
    """The constants that robot.toml takes; none, and a sentence why, where they do not follow."""
    parameters = robot.motors[robot.motor_ports[motor].motor]
    try:
        return found.constants({name: parameters[name].value for name in _KNOWN}), ""
    except DesignError as error:
        return {}, error.sentence


def _parameter_file(found: IdentifiedMotor, checked: Validation, of: str, source: str) -> str:
    """TOML with the model's parameters."""
    lines = [
        f"# {of}, written by ravenbrick identify.",
        f"# Error {found.error:.2f} counts, on other data {checked.error:.2f} counts.",
        "",
        "[model]",
    ]
    for one in found.parameters:
        half = (one.high - one.low) / 2
        entry = f'value = {one.value:.8g}, unit = "{one.unit}", tolerance = {half:.3g}'
        lines.append(f'{one.name} = {{ {entry}, source = "{source}" }}')
    return "\n".join([*lines, ""])


def _constants_table(constants: Mapping[str, float], reason: str, source: str) -> str:
    """TOML with the plant's parameters as robot.toml writes them, or why there are none."""
    if reason:
        return f"\n# Without [motor] for robot.toml: {reason}.\n"
    lines = ["", "# For [motors.<name>] of robot.toml; resistance and constants as given there."]
    lines.append("[motor]")
    units = {"viscous_friction": "N m s/rad", "inertia": "kg m^2", "coulomb_friction": "N m"}
    for name, value in constants.items():
        entry = f'value = {value:.8g}, unit = "{units[name]}"'
        lines.append(f'{name} = {{ {entry}, source = "{source}" }}')
    return "\n".join([*lines, ""])
