# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sources that are edited again at once: every edit is in the image, by the real toolchain."""

from __future__ import annotations

from pathlib import Path

from verification.support.needed_tools import NEEDS_TOOLCHAIN

from ravenbrick.image.build import build_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import Workspace

MAIN = """with Ada.Real_Time;
with Words;
procedure Main is
   procedure Say (Text : String) with Import, Convention => C, External_Name => "say";
begin
   Say (Words.Text);
   delay until Ada.Real_Time.Time_Last;
end Main;
"""
ADA = 'package Words is\n   function Text return String is ("%s");\nend Words;\n'
C = 'static const char *volatile said;\nvoid say(void) { said = "%s"; }\n'
OLD = ("an Ada text of old", "a C text of old")
NEW = ("an Ada text of now", "a C text of now")


def write(folder: Path, ada: str, c: str) -> None:
    """Both sources with their texts."""
    (folder / "words.ads").write_text(ADA % ada)
    (folder / "say.c").write_text(C % c)


@NEEDS_TOOLCHAIN
def test_an_edit_right_after_a_build_is_compiled(tmp_path: Path) -> None:
    """Ten times, in whichever part of a second it happens."""
    workspace = create_project(tmp_path / "robot", "blank")
    robot, sources = read_robot(workspace.project), workspace.project / "src"
    (sources / "main.adb").write_text(MAIN)
    for ada, c in [OLD, NEW] * 5:
        write(sources, ada, c)
        content = build_image(workspace, robot, "ram").image.content
        assert ada.encode() in content and c.encode() in content


def objects(workspace: Workspace) -> dict[str, list[int]]:
    """When the objects of each unit were written; that of the binder is written by each build."""
    found: dict[str, list[int]] = {}
    for file in sorted(workspace.products.rglob("*.o")):
        if not file.name.startswith("b__"):
            found.setdefault(file.stem, []).append(file.stat().st_mtime_ns)
    return found


@NEEDS_TOOLCHAIN
def test_a_change_of_the_design_compiles_what_depends_on_it(tmp_path: Path) -> None:
    """Not the units of files that the design wrote again with the same content."""
    workspace = create_project(tmp_path / "robot", "motor")
    robot, script = read_robot(workspace.project), workspace.project / "design.py"
    build_image(workspace, robot, "ram")
    text = script.read_text()
    script.write_text(text.replace("SETTLING_TIME = 0.4", "SETTLING_TIME = 0.3"))
    before = objects(workspace)
    build_image(workspace, robot, "ram")
    after = objects(workspace)
    compiled = {name for name, times in after.items() if times != before[name]}
    assert compiled == {"functional", "controller_design", "bench", "tasks"}
