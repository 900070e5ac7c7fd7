# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The faulty program as images, and a run of one: when its motor was off."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import virtual_brick
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import BuildKind

from verification.support.bricks.observe import MOTORS, Brick, MotorCommand, bench
from verification.support.failing_program import put_values

__all__ = [
    "EARLIEST_MS",
    "Fault",
    "FaultyProgram",
    "Outcome",
    "began_ms",
    "edit",
    "faulty_program",
    "outcome",
    "strike",
]

SOURCES = Path(__file__).resolve().parent / "program"
DUTY = 50
# The job of the control task in which a fault of the program begins is released before this.
EARLIEST_MS = 500
STEP_MS = 0.05
WATCHED_MS = 2_500


@dataclass(frozen=True)
class Fault:
    """A fault: one of the program (`kind` in faults.ads), or inputs with their time after it began.

    `limit_ms` is the longest time until the motors are off, None where nothing can stop them.
    """

    name: str
    limit_ms: float | None
    kind: str = "Nothing"
    inputs: tuple[tuple[float, str, float], ...] = ()
    alone: bool = False
    image: BuildKind = "ram"


@dataclass(frozen=True)
class Outcome:
    """When the motor was off for good, in ms after the fault, None for never; what was seen."""

    off_ms: float | None
    display: tuple[str, ...]
    commands: tuple[MotorCommand, ...]


class FaultyProgram:
    """The images of a project, by kind."""

    def __init__(self, elves: Mapping[str, Path]) -> None:
        self._elves = elves
        spec = (SOURCES / "faults.ads").read_text().split("(", 1)[1].split(")", 1)[0]
        self.kinds = [name.strip() for name in spec.split(",")]

    def image(self, fault: Fault, phase_us: int) -> bytes:
        """The image in which the fault begins so long after a release."""
        path = self._elves[fault.image]
        content = bytearray(path.read_bytes())
        values = {"fault_chosen": self.kinds.index(fault.kind), "fault_phase": phase_us}
        symbols = read_image(path).symbols
        put_values(content, path, {name: v for name, v in values.items() if name in symbols})
        return bytes(content)


def edit(file: Path, *changes: tuple[str, str]) -> None:
    """Replace the first of each text, which must be there."""
    text = file.read_text()
    for old, new in changes:
        assert old in text, f"{file}: no {old!r}"
        text = text.replace(old, new, 1)
    file.write_text(text)


def _with_faults(project: Path) -> None:
    """The template's control task drives the motor and has the faults."""
    edit(
        project / "src" / "tasks.adb",
        ("with NXT.AVR;", "with Faults;\nwith NXT.AVR;"),
        ("(if Now then 50 else 0)", str(DUTY)),
        (
            "   begin\n      loop\n         delay until Next_Release;\n         Now",
            "   begin\n"
            f"      NXT.Motor_Controls.Drive (Motor_B, {DUTY});\n"
            "      if Faults.Is_Chosen (Faults.Loop_Before_Delay) then\n"
            "         Faults.Hang;\n"
            "      end if;\n"
            "      loop\n         delay until Next_Release;\n"
            "         Faults.Strike;\n"
            "         exit when Faults.Ended;\n         Now",
        ),
    )


def _alone(project: Path) -> None:
    """Nothing but a main procedure, which drives the motor and ends."""
    for name in ("tasks.adb", "tasks.ads"):
        (project / "src" / name).unlink()
    edit(
        project / "src" / "main.adb",
        ("with NXT.AVR;", "with Faults;\nwith NXT.Motor_Controls;"),
        ("with Tasks;\npragma Unreferenced (NXT.AVR, Tasks);\n", ""),
        (
            "   delay until Ada.Real_Time.Time_Last;",
            f"   NXT.Motor_Controls.Drive (NXT.Motor_B, {DUTY});\n"
            f"   delay until Ada.Real_Time.Clock + Ada.Real_Time.Milliseconds ({EARLIEST_MS});\n"
            "   delay until Ada.Real_Time.Clock"
            " + Ada.Real_Time.Microseconds (Faults.Phase_Us);\n"
            "   Faults.Began := 1;",
        ),
        ("procedure Main with", "use type Ada.Real_Time.Time;\nprocedure Main with"),
    )
    robot = project / "robot.toml"
    text = robot.read_text()
    first, *others = text.split("[[tasks]]")
    robot.write_text(f"{first}[[tasks]]{others[0]}")


def faulty_program(
    folder: Path,
    *,
    alone: bool = False,
    supervised: bool = True,
    motor_timeout_ms: int = 0,
    kinds: tuple[BuildKind, ...] = ("ram",),
) -> FaultyProgram:
    """Make and build the project; not `supervised`: without watchdog and stack checks.

    `motor_timeout_ms` is the field of robot.toml.
    """
    workspace = create_project(folder / "faulty", "blank")
    project = workspace.project
    for source in SOURCES.iterdir():
        shutil.copy(source, project / "src")
    (_alone if alone else _with_faults)(project)
    name = f'name = "{project.name}"'
    settings = f"{name}\nmotor_timeout_ms = {motor_timeout_ms}"
    if not supervised:
        settings += "\nwatchdog = false\nstack_check = false"
    edit(project / "robot.toml", (name, settings))
    robot = read_robot(project)
    return FaultyProgram({k: build_image(workspace, robot, k).image.path for k in kinds})


def began_ms(brick: Brick, after_ms: float) -> float:
    """Run until the fault has begun, which is after this instant."""
    at_ms = after_ms
    brick.run(max(1, at_ms))
    while not brick.integer("fault_began"):
        at_ms += STEP_MS
        if brick.run_to_end(at_ms).reason != "reached":
            break
    return at_ms


def _off_ms(commands: Sequence[MotorCommand], began_ms: float) -> float | None:
    """When a motor was off for good, after the fault."""
    last_on = max((i for i, c in enumerate(commands) if c.duty), default=None)
    if last_on is None:
        return 0.0
    if last_on + 1 == len(commands):
        return None
    return max(0.0, commands[last_on + 1].at_ms - began_ms)


def outcome(brick: Brick, began_ms: float) -> Outcome:
    """Run on after the fault, and see when the last motor was off."""
    brick.run_to_end(began_ms + WATCHED_MS)
    commands = brick.motor_commands()
    off = [_off_ms([c for c in commands if c.motor == motor], began_ms) for motor in MOTORS]
    known = [ms for ms in off if ms is not None]
    display = tuple(row for row in brick.text() if row)
    return Outcome(max(known) if len(known) == len(off) else None, display, tuple(commands))


def strike(program: FaultyProgram, fault: Fault, phase_us: int) -> Outcome:
    """Run the fault in this phase."""
    device: Any = virtual_brick.VirtualBrick(json.dumps(bench()), program.image(fault, phase_us))
    brick = Brick(device)
    for after_ms, name, value in fault.inputs:
        brick.set(EARLIEST_MS + phase_us / 1_000 + after_ms, name, value)
    if fault.inputs:
        return outcome(brick, EARLIEST_MS + phase_us / 1_000)
    return outcome(brick, began_ms(brick, 0 if fault.kind == "Loop_Before_Delay" else EARLIEST_MS))
