# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each example from its design to a run that meets its criteria."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ravenbrick.brick.session import tunables_of
from ravenbrick.cli.diagram import diagram_of
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import TEMPLATES

EXAMPLES = Path(__file__).resolve().parent
DESIGNED = ("paper", "motor-bench", "line-follower", "balancer")
LONG = pytest.mark.long("a whole lap on the floor")
RUNS = [
    ("blank", "press"),
    ("self-test", "all"),
    ("paper", "drive"),
    ("paper", "step"),
    ("paper", "monitored"),
    ("motor-bench", "step"),
    ("motor-bench", "load"),
    ("motor-bench", "position"),
    pytest.param("line-follower", "lap", marks=LONG),
    ("balancer", "let-go"),
]
_built: set[str] = set()


def ravenbrick(*arguments: str, code: int = 0) -> dict[str, Any]:
    """The JSON answer of a command that must succeed, or end with this exit code."""
    command = [
        sys.executable,
        "-c",
        "from ravenbrick.cli import main; main()",
        *arguments,
        "--json",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def run_scenario(example: str, scenario: str) -> dict[str, Any]:
    """Build once per session, and run."""
    if example not in _built:
        ravenbrick("build", str(EXAMPLES / example))
        _built.add(example)
    return ravenbrick("run", str(EXAMPLES / example), scenario)


@pytest.mark.parametrize("example", DESIGNED)
def test_the_generated_files_are_those_of_the_design(example: str, tmp_path: Path) -> None:
    """Generating again gives no difference."""
    script = EXAMPLES / example / "design.py"
    command = [sys.executable, str(script), "--generated", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    names = sorted(path.name for path in (EXAMPLES / example / "generated").iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    for name in names:
        kept = (EXAMPLES / example / "generated" / name).read_text()
        assert (tmp_path / name).read_text() == kept, name


@pytest.mark.parametrize("example", DESIGNED)
def test_the_controller_of_a_design_is_drawn(example: str) -> None:
    """By the name that the studio's tab Diagram asks for."""
    assert diagram_of(f"{EXAMPLES / example / 'design.py'}:design").flat().blocks


@pytest.mark.parametrize(("example", "scenario"), RUNS)
def test_a_scenario_meets_its_criteria(example: str, scenario: str) -> None:
    """Every criterion is met, and there is one."""
    answer = run_scenario(example, scenario)
    assert answer["criteria"]
    assert all(criterion["met"] for criterion in answer["criteria"])


def test_the_motor_follows_the_set_point_that_the_page_offers(tmp_path: Path) -> None:
    """Written into the variable while it runs; it is at first what robot.toml says."""
    project = EXAMPLES / "motor-bench"
    built = ravenbrick("build", str(project))
    (offered, *_gains) = tunables_of(read_robot(project), read_image(Path(built["image"])))
    step = (project / "scenarios" / "step.toml").read_text().partition("[[criteria]]")[0]
    wanted = -0.5 * offered["value"]
    written = f'at_ms = 2_000\ninput = "variable.{offered["path"]}"\nvalue = {wanted}\n'
    expected = [
        f"probe.{offered['seen']} between {at} and {at} at {instant} s"
        for at, instant in ((offered["value"], 1.9), (wanted, 2.1))
    ]
    expected.append("motor.B.angular_velocity between -4.2 and -3.9 rad/s at the end")
    scenario = tmp_path / "drag.toml"
    scenario.write_text(f"{step}\n[[inputs]]\n{written}")
    options = [part for text in expected for part in ("--expect", text)]
    ravenbrick("run", str(project), str(scenario), *options)


@pytest.mark.long("two bricks for 30 s")
def test_a_joystick_steers_a_vehicle_through_the_air() -> None:
    """Two bricks find each other and drive, and each meets its criteria, whichever is named."""
    ravenbrick("build", str(EXAMPLES / "remote-joystick"))
    vehicle = run_scenario("remote-vehicle", "drive")
    joystick = run_scenario("remote-joystick", "steer")
    assert len(vehicle["criteria"]) == 9 and len(joystick["criteria"]) == 4
    assert vehicle["trace_digest"] == joystick["peer"]["trace_digest"]
    assert joystick["trace_digest"] == vehicle["peer"]["trace_digest"]
    assert vehicle["trace_digest"] != joystick["trace_digest"]


@pytest.mark.long("bounds every path of a job")
@pytest.mark.parametrize(("example", "scenario"), [("motor-bench", "step"), ("paper", "monitored")])
def test_the_telemetry_is_part_of_the_schedulability_report(example: str, scenario: str) -> None:
    """The server's job and response have bounds, not below what was seen, and all is in time."""
    ravenbrick("build", str(EXAMPLES / example))
    options = ("--scenario", scenario, "--no-margins")
    answer = ravenbrick("analyse", str(EXAMPLES / example), *options)
    assert answer["schedulable"]
    server_task = next(task for task in answer["tasks"] if task["name"] == "server_task")
    seen = server_task["observed"]
    assert 0 < seen["execution_cycles"] <= server_task["execution_bound_cycles"]
    assert 0 < seen["response_cycles"] <= server_task["response_bound_cycles"]


@pytest.mark.long("bounds every path of a job")
@pytest.mark.parametrize("example", sorted({known.example for known in TEMPLATES.values()}))
def test_flash_images_of_templates_are_schedulable(example: str) -> None:
    """All stacks suffice, too."""
    answer = ravenbrick("analyse", str(EXAMPLES / example), "--image", "flash", "--no-margins")
    assert answer["misses"] == []
    assert answer["schedulable"]
    assert answer["stacks_suffice"] is not False


@pytest.mark.long("a minute on the brick")
def test_the_balancer_stands_for_a_minute_under_pushes() -> None:
    """Four pushes forwards and backwards; it does not fall and does not run away."""
    answer = run_scenario("balancer", "stand")
    assert all(criterion["met"] for criterion in answer["criteria"])
