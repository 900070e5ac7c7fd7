# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The first line that a person sees of a failed build: of outputs of the tools, and for real."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ravenbrick.errors import BuildError
from ravenbrick.image.build import build_image
from ravenbrick.image.build_errors import build_failure, errors_in
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import Workspace

CIRCULAR = """\
error: Elaboration circularity detected
info:
info:    Reason:
info:      unit "a (spec)" depends on its own elaboration
gprbind: invocation of gnatbind failed
"""
SAID = {
    'Compile\n/d/nxt-avr.adb:4:06: warning: redundant with clause in body [-gnatwr]\n'
    'main.adb:15:23: error: missing ";"\n   compilation of main.adb failed\n':
        ['main.adb:15:23: missing ";"'],
    'main.adb:3:08: error: expected type "A"\nmain.adb:3:08: error: found type "B"\n'
    'b.adb:1:01: (style) bad layout\nb.adb:2:01: error: "C" is undefined\n':
        ['main.adb:3:08: expected type "A"; found type "B"', 'b.adb:2:01: "C" is undefined'],
    "f.c: In function 'step':\nf.c:11:7: error: expected ';' before '}' token\n":
        ["f.c:11:7: expected ';' before '}' token"],
    "f.c:1:10: fatal error: nowhere.h: No such file or directory\ncompilation terminated.\n":
        ["f.c:1:10: nowhere.h: No such file or directory"],
    "/tmp/submission/ccOPBicX.s: Assembler messages:\n"
    "/tmp/submission/ccOPBicX.s:80: Error: bad instruction `nope'\n":
        ["(assembler):80: bad instruction `nope'"],
    "cannot generate code for file bench.ads (package spec)\n":
        ["bench.ads: this package needs a body, and there is no bench.adb"],
    "/usr/bin/arm-none-eabi/bin/ld: tasks.o: in function `tasks__t':\n"
    "a b/bench.adb:111: undefined reference to `functional_step'\n"
    "collect2: error: ld returned 1 exit status\ngprbuild: link of main.adb failed\n"
    "gprbuild: failed command was: /usr/bin/arm-none-eabi-gcc main.o b__main.o\n":
        ["a b/bench.adb:111: undefined reference to 'functional_step'; "
         "no source and no library defines it"],
    "/usr/bin/ld: main.o:(.text+0x8): undefined reference to `nowhere'\n":
        ["main.o: undefined reference to 'nowhere'; no source and no library defines it"],
    "/usr/bin/ld: memory.o: in function `memcpy':\n"
    "memory.S:9: multiple definition of `memcpy'; extra.o:extra.c:1: first defined here\n":
        ["'memcpy' is defined twice; choose another name"],
    "s-memory.adb:36: undefined reference to `ravenbrick_heap_size'\n":
        ["the program needs a heap, for 'new' or for a function that returns a limited object, and "
         "has none: use variables, name NXT.Malloc for a heap of no bytes, or give a size in "
         "bytes, such as HEAP=4096 before the command"],
    'robot.gpr:9:25: "src" is not a valid directory\ngprbuild: "robot.gpr" processing failed\n':
        ['robot.gpr:9:25: "src" is not a valid directory'],
    CIRCULAR: ["Elaboration circularity detected",
               'unit "a (spec)" depends on its own elaboration'],
}  # fmt: skip


@pytest.mark.parametrize("output", SAID, ids=[wanted[0][:30] for wanted in SAID.values()])
def test_errors_are_found_among_what_else_is_said(output: str, tmp_path: Path) -> None:
    """Never a warning, a remark or a command."""
    assert errors_in(output, tmp_path) == SAID[output]


def test_many_errors_are_counted(tmp_path: Path) -> None:
    """The first is the sentence, five more are the detail, with where the whole output is."""
    output = "".join(f"main.adb:{line}:1: error: bad\n" for line in range(1, 11))
    error = build_failure(tmp_path, "ram", output, tmp_path / "build.log")
    detail = error.detail.splitlines()
    assert error.sentence == "main.adb:1:1: bad"
    assert detail[:5] == [f"main.adb:{line}:1: bad" for line in range(2, 7)]
    assert detail[5:] == ["and 4 further errors", f"whole output: {tmp_path / 'build.log'}"]


def test_a_failure_without_an_error_shows_the_end_of_the_output(tmp_path: Path) -> None:
    """There is nothing better."""
    error = build_failure(tmp_path / "rover", "ram", "one\n\ntwo\n", tmp_path / "build.log")
    assert "rover could not be built" in error.sentence
    assert error.detail.splitlines()[:2] == ["one", "two"]


@pytest.fixture(scope="module")
def blank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new project, built."""
    project = create_project(tmp_path_factory.mktemp("a folder") / "blank", "blank").project
    build_image(Workspace.of(project), read_robot(project), "ram")
    return project


def replaced(old: str, new: str) -> Callable[[str], str]:
    """Replace a text once."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


BROKEN = {
    "syntax": ("tasks.adb", replaced("end loop;", "end lop;"), r"tasks\.adb:\d+:\d+: .*loop"),
    "type": ("tasks.adb", replaced("Milliseconds (20)", "20"), r"tasks\.adb:\d+:\d+: expected"),
    "unit": ("main.adb", replaced("with System", "with Sistem"), r'main\.adb:8:06: file "sistem'),
    "link": (
        "main.adb",
        replaced("\nbegin", "\n   procedure No with Import, Convention => C;\nbegin\n   No;"),
        r"main\.adb:\d+: undefined reference to 'no'",
    ),
    "rule": (
        "main.adb",
        replaced("\nbegin", "\n   task T;\n   task body T is begin null; end T;\nbegin"),
        r'main\.adb:\d+:\d+: violation of restriction "No_Task_Hierarchy"; from profile',
    ),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_program_is_told_by_its_own_error(
    blank: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From where the user stands, and without an image left; a comment of any style is none."""
    name, change, sentence = BROKEN[kind]
    file = blank / "src" / name
    whole = file.read_text()
    monkeypatch.chdir(blank)
    robot, workspace = read_robot(Path()), Workspace.of(Path())
    try:
        file.write_text(change(whole))
        with pytest.raises(BuildError, match=rf"^src/{sentence}") as caught:
            build_image(workspace, robot, "ram")
        assert "warning" not in str(caught.value) and len(caught.value.sentence) < 200
        assert not workspace.image("ram", robot.name).exists()
    finally:
        file.write_text(whole + "--no space and\t a tabulator behind   \n")
    assert build_image(workspace, robot, "ram").image.path.is_file()
