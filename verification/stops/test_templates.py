# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A control task of each template that calls itself without end: the motors are off in time."""

from __future__ import annotations

from pathlib import Path

import pytest
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.image.build import build_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.templates import TEMPLATES, create_project

from verification.stops.campaign import FAULTS
from verification.stops.faults import began_ms, edit, outcome
from verification.support.bricks.observe import Brick

# Instants of the templates' scenarios at which motors are on.
RUNNING_MS = {
    "balance": 6_050,
    "blank": 700,
    "line": 3_000,
    "motor": 2_000,
    "paper": 3_000,
    "vehicle": 3_000,
}
(LIMIT_MS,) = (fault.limit_ms for fault in FAULTS if fault.name == "stack overflow")

DESCENT = """\
package body Tasks is

   Began : Integer := 0 with Volatile, Export, Convention => C, External_Name => "fault_began";
   Depth : Integer := 0 with Volatile;

   procedure Descend with No_Inline;

   procedure Descend is
   begin
      if Depth >= 0 then
         Descend;
         Depth := Depth + 1;
      end if;
   end Descend;

   Fault_At : constant Time := NXT.AVR.First_Release + Milliseconds ({ms});
"""
STRIKE = """\
         if Clock >= Fault_At then
            Began := 1;
            Descend;
         end if;
"""


def test_each_template_is_tried() -> None:
    """All have stack checks."""
    assert RUNNING_MS.keys() == TEMPLATES.keys()


@pytest.mark.parametrize("name", sorted(RUNNING_MS))
def test_an_endless_recursion_stops_the_motors_of_the_template(name: str, tmp_path: Path) -> None:
    """Within the limit of the table of faults, which is measured with the template blank only."""
    workspace = create_project(tmp_path / "robot", name)
    edit(
        workspace.project / "src" / "tasks.adb",
        ("package body Tasks is\n", DESCENT.format(ms=RUNNING_MS[name])),
        ("         delay until Next_Release;\n", f"         delay until Next_Release;\n{STRIKE}"),
    )
    robot = read_robot(workspace.project)
    scenario = read_scenario(scenario_path(workspace.project, TEMPLATES[name].scenario), robot)
    image = build_image(workspace, robot, "ram").image
    brick = Brick(VirtualTarget().prepare(robot, scenario, image))
    found = outcome(brick, began_ms(brick, RUNNING_MS[name]))
    assert found.off_ms is not None
    assert 0 < found.off_ms <= LIMIT_MS
    assert "Storage_Error: stack overflow" in "".join(found.display)
