# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A project of `ravenbrick new` whose program fails in a chosen way, built once."""

from __future__ import annotations

import io
import shutil
import struct
from pathlib import Path

from elftools.elf.elffile import ELFFile
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project

__all__ = ["FailingProgram", "failing_project", "put_values"]

SOURCES = Path(__file__).resolve().parents[2] / "host" / "tests" / "cli" / "programs" / "failing"


def put_values(content: bytearray, path: Path, values: dict[str, int]) -> None:
    """Initial values of exported integers."""
    symbols = read_image(path).symbols
    segments = list(ELFFile(io.BytesIO(bytes(content))).iter_segments("PT_LOAD"))
    for name, value in values.items():
        address = symbols[name].address
        segment = next(s for s in segments if 0 <= address - s["p_vaddr"] < s["p_filesz"])
        offset = segment["p_offset"] + address - segment["p_vaddr"]
        content[offset : offset + 4] = struct.pack("<i", value)


class FailingProgram:
    """A built project; `image` makes a variant of its image with another failure."""

    def __init__(self, project: Path, elf: Path) -> None:
        self.project, self._elf = project, elf

    def image(self, task: int, way: str, amount: int = 1) -> Path:
        """The image that fails in the task (1 control, 2 display, 3 main, 4 interrupt handler)."""
        ways = (self.project / "src" / "failing.ads").read_text().split("(", 1)[1].split(")", 1)[0]
        names = [name.strip().lower() for name in ways.split(",")]
        content = bytearray(self._elf.read_bytes())
        values = {"failing_task": task, "failing_way": names.index(way), "failing_amount": amount}
        put_values(content, self._elf, values)
        path = self._elf.with_name(f"{way}-{task}-{amount}.elf")
        path.write_bytes(content)
        return path

    def place(self, mark: str, file: str = "failing.adb") -> str:
        """`file:line` of the line with this comment."""
        lines = (self.project / "src" / file).read_text().splitlines()
        return f"{file}:{next(n for n, line in enumerate(lines, 1) if mark in line)}"


def failing_project(folder: Path, *, stack_check: bool) -> FailingProgram:
    """Make and build the project."""
    workspace = create_project(folder / "failing", "blank")
    project = workspace.project
    for source in SOURCES.iterdir():
        shutil.copy(source, project / "src")
    changes = {
        "robot.gpr": ('("Ada")', '("Ada", "C")'),
        "src/main.adb": ("   delay until", "   Failing.Go (3);\n   delay until"),
        "src/tasks.adb": ("         Now := NXT", "         Failing.Go (1);\n         Now := NXT"),
    }
    for name, (old, new) in changes.items():
        text = (project / name).read_text().replace(old, new, 1)
        (project / name).write_text(text)
    tasks = project / "src" / "tasks.adb"
    text = tasks.read_text().replace("with NXT.AVR;", "with Failing;\nwith NXT.AVR;", 1)
    shown = "         Clear_Screen"
    tasks.write_text(text.replace(shown, f"         Failing.Go (2);\n{shown}", 1))
    main = project / "src" / "main.adb"
    main.write_text(main.read_text().replace("with Tasks;", "with Tasks;\nwith Failing;", 1))
    if not stack_check:
        toml = project / "robot.toml"
        first = 'name = "failing"\n'
        toml.write_text(toml.read_text().replace(first, f"{first}stack_check = false\n", 1))
    built = build_image(workspace, read_robot(project), "ram")
    return FailingProgram(project, built.image.path)
