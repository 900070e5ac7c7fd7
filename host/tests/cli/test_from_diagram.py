# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Projects whose program is made from a diagram: built, driven, and changed without any Ada."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result
from verification.support.codegen.driven_controllers import CONTROLLERS, DrivenController
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.codegen import control_task, generate_c
from ravenbrick.errors import DesignError, ExitCode
from ravenbrick.image.build import build_image
from ravenbrick.model import diagram_text, read_diagram
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Recording

# The duty cycle is proportional to the angle that is missing.
DIAGRAM = """name = "functional"
sample_time = 0.005

[blocks.wanted]
kind = "Inport"

[blocks.angle]
kind = "Inport"

[blocks.Error]
kind = "Sum"
signs = "+-"
inputs = ["wanted", "angle"]

[blocks.Kp]
kind = "Gain"
gain = 0.5
inputs = ["Error"]

[blocks.duty]
kind = "Outport"
inputs = ["Kp"]
"""
MORE = """
[blocks.touched]
kind = "Inport"

[blocks.Fast]
kind = "Gain"
gain = 40.0
inputs = ["touched"]

[blocks.spin]
kind = "Outport"
inputs = ["Fast"]
"""
SCENARIO = """schema_version = 1
name = "start"
seed = 1
duration_ms = 2_000
[[inputs]]
at_ms = 1_000
input = "variable.controller_wanted:f32"
value = -90
"""
PORTS = """[ports.2]
device = "touch"
role = "spins"

[ports.C]
device = "motor"
motor = "nxt"
role = "spins"

"""
PRESS = """[[inputs]]
at_ms = 1_000
input = "touch.2"
value = 1
"""


def replace(file: Path, old: str, new: str) -> None:
    """Edit a file as a person would."""
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def new(folder: Path, *words: str) -> Result:
    """`ravenbrick new` of the diagram."""
    (folder / "diagram.toml").write_text(DIAGRAM)
    given = ["new", str(folder / "robot"), "--from-diagram", str(folder / "diagram.toml"), *words]
    return CliRunner().invoke(app, given)


def run(project: Path) -> Recording:
    """The run of its scenario, on the image of its files as they are."""
    workspace, robot = Workspace.of(project), read_robot(project)
    image = build_image(workspace, robot, "ram").image
    scenario = read_scenario(project / "scenarios" / "start.toml", robot)
    return VirtualTarget().run(robot, scenario, image)


@NEEDS_TOOLCHAIN
@NEEDS_VIRTUAL_BRICK
def test_a_diagram_drives_a_robot_and_gets_a_port_without_any_ada(tmp_path: Path) -> None:
    """The motor holds two angles; then a touch sensor is added in design.py and robot.toml."""
    ports = ["--input", "angle=motor.B.angle", "--input", "wanted=200"]
    done = new(tmp_path, *ports, "--output", "duty=motor.B.duty")
    assert done.exit_code == 0, done.output
    project = tmp_path / "robot"
    (project / "scenarios" / "start.toml").write_text(SCENARIO)
    times, angles = run(project).signal("motor.B.angle")
    first, second = np.degrees(np.interp([0.99, 1.99], times, angles))
    assert first == pytest.approx(200, abs=8) and second == pytest.approx(-90, abs=8)
    assert [file.name for file in (project / "src").iterdir()] == ["main.adb"]
    controller = project / "diagrams" / "controller.toml"
    controller.write_text(controller.read_text() + MORE)
    replace(project / "design.py", '"wanted": 200.0,', '"wanted": 200.0, "touched": "touch.2",')
    replace(project / "design.py", "OUTPUTS = {", 'OUTPUTS = {"spin": "motor.C.duty",')
    replace(project / "robot.toml", "[body]", PORTS + "[body]")
    (project / "scenarios" / "start.toml").write_text(SCENARIO + PRESS)
    times, angles = run(project).signal("motor.C.angle")
    before, after = np.degrees(np.interp([0.99, 1.99], times, angles))
    assert abs(before) < 1 and after > 90


def test_a_diagram_may_have_any_name(tmp_path: Path) -> None:
    """It keeps it, and the C has the name that the Ada calls."""
    servo = DIAGRAM.replace("functional", "servo")
    (tmp_path / "servo.toml").write_text(servo)
    words = ["new", str(tmp_path / "robot"), "--from-diagram", str(tmp_path / "servo.toml")]
    done = CliRunner().invoke(app, [*words, "--output", "duty=motor.B.duty"])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "robot" / "diagrams" / "controller.toml").read_text()
    assert text == diagram_text(read_diagram(servo))
    done = CliRunner().invoke(app, ["design", str(tmp_path / "robot")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "robot" / "generated" / "functional.c").exists()


def project_of(one: DrivenController, form: str, folder: Path) -> Path:
    """A project made of a controller as a person makes it: `new`, then a few edits."""
    (folder / "diagram.toml").write_text(diagram_text(one.diagram()))
    project = folder / "robot"
    words = ["new", str(project), "--from-diagram", str(folder / "diagram.toml")]
    for option, devices in (("--input", one.inputs), ("--output", one.outputs)):
        words += [word for port, name in devices.items() for word in (option, f"{port}={name}")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    (project / "scenarios" / "start.toml").write_text(one.scenario)
    for old, new_text in one.robot.items():
        replace(project / "robot.toml", old, new_text)
    design = project / "design.py"
    replace(design, "SPEED_WINDOW = 8", f"SPEED_WINDOW = {one.speed_window}")
    if form == "fixed":
        replace(design, "control_task, generate_c", "control_task, generate_fixed_c")
        replace(design, "import Diagram, load_diagram",
                "import Diagram, FixedPointOptions, load_diagram, to_fixed_point")  # fmt: skip
        options = f"FixedPointOptions({dict(one.ranges)!r}, accumulator_bits=64)"
        replace(design, "generate_c(diagram)",
                f"generate_fixed_c(to_fixed_point(diagram, {options}))")  # fmt: skip
    return project


@NEEDS_TOOLCHAIN
@NEEDS_VIRTUAL_BRICK
@pytest.mark.parametrize("form", ["floating", "fixed"])
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_controller_drives_its_robot_in_floating_and_in_fixed_point(
    name: str, form: str, tmp_path: Path
) -> None:
    """What each must achieve stands in its scenario, deadlines among it."""
    project = project_of(CONTROLLERS[name], form, tmp_path)
    done = CliRunner().invoke(app, ["run", str(project), "start"])
    assert done.exit_code == 0, done.output
    header = (project / "generated" / "functional.h").read_text()
    assert ("sfix16_En" in header) == (form == "fixed")


@NEEDS_TOOLCHAIN
@NEEDS_VIRTUAL_BRICK
def test_design_and_demo_show_a_controller_without_a_plant(tmp_path: Path) -> None:
    """Its linear block as held beside the design, and its picture in the report."""
    project = project_of(CONTROLLERS["mixed-rate"], "floating", tmp_path)
    done = CliRunner().invoke(app, ["design", str(project), "--json"])
    assert done.exit_code == 0, done.output
    answer = json.loads(done.output)
    (row,) = answer["fidelity"]["blocks"]
    assert row["run_s"] > 0 and "rounding that gathers after" in answer["fidelity"]["not_seen"]
    assert answer["figures"] == {} and row["block"] == "Speed"
    assert 0 < row["response_error"] < 1e-3 and 0 < row["step_error"] < 1e-3
    done = CliRunner().invoke(app, ["demo", str(project), "--json"])
    assert done.exit_code == 0, done.output
    report = next(project.rglob("report.html")).read_text(encoding="utf-8")
    assert "Block diagram of the controller" in report
    done = CliRunner().invoke(app, ["design", str(project), "--plots"])
    assert done.exit_code == ExitCode.DESIGN_FAILED
    assert "no loop" in done.output
    next(project.rglob("design.json")).unlink()
    replace(project / "design.py", "if arguments.results:", "if False:")
    done = CliRunner().invoke(app, ["design", str(project)])
    assert done.exit_code == ExitCode.DESIGN_FAILED
    assert "design.py: wrote no figures" in done.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--input", "speed=motor.B.speed"], "no port 'speed' among its inputs; it has"),
        (["--input", "angle=motor.B.torque"], "port 'angle': 'motor.B.torque' is not known"),
        (["--output", "duty=lamp"], "port 'duty': 'lamp' is not known; write one of 'motor.A"),
        (["--output", "duty"], "--output duty: expected PORT=DEVICE"),
    ],
)
def test_a_port_or_device_that_does_not_exist_is_named(
    words: list[str], said: str, tmp_path: Path
) -> None:
    """What exists is listed, and no folder is left."""
    done = new(tmp_path, *words)
    assert done.exit_code in (ExitCode.USAGE, ExitCode.DESIGN_FAILED)
    assert said in done.output.replace("\n", " ")
    assert not (tmp_path / "robot").exists()


def test_ports_of_a_diagram_need_a_diagram(tmp_path: Path) -> None:
    """The option that is missing is named."""
    done = CliRunner().invoke(app, ["new", str(tmp_path / "robot"), "--input", "a=battery"])
    assert done.exit_code == ExitCode.USAGE and "give --from-diagram, too" in done.output


def test_the_sample_time_is_whole_microseconds() -> None:
    """The clock of the run-time library counts no less."""
    header = generate_c(read_diagram(DIAGRAM)).files["functional.h"]
    with pytest.raises(DesignError, match="no whole number of microseconds"):
        control_task(header, 1 / 3, {}, {})
