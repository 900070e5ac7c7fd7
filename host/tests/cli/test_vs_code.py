# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""VS Code started from the desktop builds and debugs: tasks and launches, executed as it does."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE
from verification.support.vs_code import VSCode, matcher_problems, problems_in

from ravenbrick.cli.debug import GDB

pytestmark = [
    pytest.mark.skipif(shutil.which(GDB) is None, reason=f"{GDB} is not installed"),
    NEEDS_VIRTUAL_BRICK,
    NEEDS_TOOLCHAIN,
]


def free_port() -> int:
    """A port that nobody used a moment ago."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> VSCode:
    """A new project in a folder with spaces and an umlaut."""
    folder = tmp_path_factory.mktemp("desktop") / "my course für NXT"
    folder.mkdir()
    command = [str(Path(sys.executable).parent / "ravenbrick"), "new", "robot"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return VSCode(folder / "robot", folder, free_port())


def line_of(editor: VSCode, text: str) -> int:
    """Where a text stands in the tasks' source."""
    source = (editor.folder / "src" / "tasks.adb").read_text()
    return source[: source.index(text)].count("\n") + 1


def test_every_matcher_is_one_that_the_editor_takes(editor: VSCode) -> None:
    """In new projects and the example; an invalid one would leave a launch without its server."""
    for code in (editor, VSCode(VEHICLE, editor.folder, 3333)):
        for label, task in code.tasks.items():
            matchers = task["problemMatcher"]
            for matcher in matchers if isinstance(matchers, list) else [matchers]:
                assert matcher_problems(matcher) == [], label


def test_a_launch_stops_in_the_program_and_shows_its_variables(editor: VSCode) -> None:
    """The server builds, is ready before GDB connects, and ends with the session."""
    said = editor.debug(
        "Virtual brick",
        f'-break-insert "tasks.adb:{line_of(editor, "Before := Now;")}"',
        "-exec-continue",
        "-stack-list-variables --all-values",
        "-exec-next",
    )
    assert "^connected" in said
    stop = re.search(r'\*stopped,reason="breakpoint-hit".*?fullname="([^"]+)"', said)
    assert stop is not None
    variables = said[said.index("^done,variables=") :]
    assert 'name="now",value="false"' in variables and 'name="before",value="false"' in variables
    assert "optimized out" not in variables


def test_a_syntax_error_is_marked_in_the_source_and_no_server_starts(editor: VSCode) -> None:
    """By both tasks that build."""
    source = editor.folder / "src" / "tasks.adb"
    text, line = source.read_text(), line_of(editor, "Before := Now;")
    source.write_text(text.replace("Before := Now;", "Before := Now"))
    try:
        for label in ("build", "virtual brick for the debugger"):
            task = editor.start(label)
            said, _ = task.communicate(timeout=300)
            (matcher,) = editor.tasks[label]["problemMatcher"]
            assert task.returncode != 0
            assert problems_in(matcher, said)[0] == ("src/tasks.adb", line), said
    finally:
        source.write_text(text)


def test_the_tasks_that_run_and_test_find_the_command(editor: VSCode) -> None:
    """Without a virtual environment on the PATH."""
    for label in ("run", "test"):
        task = editor.start(label)
        said, _ = task.communicate(timeout=300)
        assert task.returncode == 0 and "deadlines met" in said, said
