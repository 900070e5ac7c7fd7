# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step responses of a running program over its design: `python -m tools.docs.live_steps FILE
[PROJECT]`, of motor-bench or paper.

Builds and designs the example, connects with it over the virtual brick's Bluetooth, changes its
set-point while it runs, cuts the steps out of what the program published, and draws them on the
axes of the design's step responses. Time is the virtual brick's: the picture is the same each time.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ravenbrick.brick.links.peers import BluetoothComputer
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.pipeline import design_project
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.report.plots.style import png_bytes
from ravenbrick.telemetry import Session
from ravenbrick.telemetry.picture import steps_figure
from ravenbrick.telemetry.steps import LiveStep, live_steps
from ravenbrick.trace.design import Design, read_design

ROOT = Path(__file__).resolve().parents[2]
STARTED_MS, CONNECT_MS, TURN_MS, FIRST_MS = 1_500, 1_000, 10, 500


@dataclass(frozen=True)
class Monitored:
    """An example with a scenario `step`: the parameter that sets the speed, and the signals.

    The speed is drawn as the mean of `mean` samples; `setpoints` are in volts.
    """

    project: Path
    parameter: str
    setpoint: str
    speed: str
    mean: int = 1
    setpoints: tuple[float, ...] = (4.0, 2.0, 5.0, 3.0)


BENCH = Monitored(ROOT / "examples" / "motor-bench", "setpoint", "setpoint", "speed")
PAPER = Monitored(
    ROOT / "examples" / "paper",
    "top_speed",
    "set_left",
    "real_left",
    mean=8,
    setpoints=(4.0, 2.0, 4.5, 3.0),
)


class Conversation:
    """A computer that talks with the program of a virtual brick over Bluetooth."""

    def __init__(self, brick: Any) -> None:
        self._brick, self.session = brick, Session()
        self._computer = BluetoothComputer(brick, pin="1234")
        self._computer.connect(timeout_ms=CONNECT_MS)
        self._computer.write(self.session.connected(self._now_s()))

    def _now_s(self) -> float:
        return MASTER_CLOCK.seconds(self._brick.cycles)

    def talk(self, milliseconds: int) -> None:
        """Let virtual time pass; both sides say what is due."""
        for _ in range(milliseconds // TURN_MS):
            self._computer.write(self.session.pending(self._now_s()))
            self._brick.run_until(self._brick.cycles + MASTER_CLOCK.cycles_of_ms(TURN_MS))
            self.session.receive(self._computer.take())


def monitored_steps(
    image: ElfImage,
    setpoints: Sequence[float],
    each_ms: int,
    example: Monitored = BENCH,
    changes: Mapping[str, float] | None = None,
) -> Session:
    """The robot at rest, a computer that listens, a start, and set-points (V) in turn.

    `changes` are other parameters that change together with the last set-point.
    """
    robot = read_robot(example.project)
    scenario = replace(read_scenario(scenario_path(example.project, "step"), robot), inputs=())
    brick = VirtualTarget().prepare(robot, scenario, image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(STARTED_MS))
    conversation = Conversation(brick)
    session, talk = conversation.session, conversation.talk
    session.set_parameter(example.parameter, setpoints[0])
    talk(FIRST_MS)
    brick.schedule_input(brick.cycles, "touch.1", 1)
    for volts in setpoints[1:]:
        talk(each_ms)
        session.set_parameter(example.parameter, volts)
    for name, value in (changes or {}).items():
        session.set_parameter(name, value)
    talk(each_ms)
    return session


def steps_and_design(
    each_ms: int = 1_000, example: Monitored = BENCH
) -> tuple[list[LiveStep], Design]:
    """The example's live steps and what its design says of them."""
    workspace = Workspace.of(example.project)
    design_project(workspace)
    image = build_image(workspace, read_robot(example.project), "ram").image
    run = monitored_steps(image, example.setpoints, each_ms, example).run
    assert run is not None
    steps = live_steps(run.recording(), example.setpoint, example.speed, example.mean)
    return steps, read_design(workspace.design_file)


def main(file: str, project: str = "motor-bench") -> int:
    """Write the picture."""
    example = {one.project.name: one for one in (BENCH, PAPER)}[project]
    steps, design = steps_and_design(example=example)
    figure = steps_figure(steps, design, example.setpoint, example.speed)
    Path(file).write_bytes(png_bytes(figure))
    print(f"{len(steps)} steps: {file}")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
