# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Step responses of a running program over its design: `python -m tools.docs.live_steps FILE`.

Builds and designs the motor bench, connects with it over the virtual brick's Bluetooth, changes its
set-point while it runs, cuts the steps out of what the program published, and draws them on the
axes of the design's step responses. Time is the virtual brick's: the picture is the same each time.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

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
BENCH = ROOT / "examples" / "motor-bench"
STARTED_MS, CONNECT_MS, TURN_MS, FIRST_MS = 1_500, 1_000, 10, 500
NAMES = "setpoint", "speed"
SETPOINTS_V = (4.0, 2.0, 5.0, 3.0)


def monitored_steps(image: ElfImage, setpoints: Sequence[float], each_ms: int) -> Session:
    """The bench at rest, a computer that listens, a start, and set-points (V) in turn."""
    robot = read_robot(BENCH)
    scenario = replace(read_scenario(scenario_path(BENCH, "step"), robot), inputs=())
    brick = VirtualTarget().prepare(robot, scenario, image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(STARTED_MS))
    computer, session = BluetoothComputer(brick, pin="1234"), Session()
    computer.connect(timeout_ms=CONNECT_MS)

    def now_s() -> float:
        return MASTER_CLOCK.seconds(brick.cycles)

    def talk(milliseconds: int) -> None:
        for _ in range(milliseconds // TURN_MS):
            computer.write(session.pending(now_s()))
            brick.run_until(brick.cycles + MASTER_CLOCK.cycles_of_ms(TURN_MS))
            session.receive(computer.take())

    computer.write(session.connected(now_s()))
    session.set_parameter("setpoint", setpoints[0])
    talk(FIRST_MS)
    brick.schedule_input(brick.cycles, "touch.1", 1)
    for volts in setpoints[1:]:
        talk(each_ms)
        session.set_parameter("setpoint", volts)
    talk(each_ms)
    return session


def steps_and_design(each_ms: int = 1_000) -> tuple[list[LiveStep], Design]:
    """The bench's live steps and what its design says of them."""
    workspace = Workspace.of(BENCH)
    design_project(workspace)
    image = build_image(workspace, read_robot(BENCH), "ram").image
    run = monitored_steps(image, SETPOINTS_V, each_ms).run
    assert run is not None
    return live_steps(run.recording(), *NAMES), read_design(workspace.design_file)


def main(file: str) -> int:
    """Write the picture."""
    steps, design = steps_and_design()
    Path(file).write_bytes(png_bytes(steps_figure(steps, design, *NAMES)))
    print(f"{len(steps)} steps: {file}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
