# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from verification.commands import NoResultError
from verification.mutation import executed
from verification.mutation.campaign import PythonJudge
from verification.mutation.executed import Executed, statement_lines
from verification.mutation.rooms import Room
from verification.support.paths import ROOT

SOURCE = """LIMIT = 3
NAME = (
    1,
)


def used(x):
    return x + LIMIT


def unused(x):
    return x - 7


def in_child():
    return 5


def in_fixture():
    return 6


def endless(x):
    while x < 8:
        x += 1
"""
TEST_A = """import subprocess, sys
import a
import pytest


@pytest.fixture(scope="module")
def six():
    return a.in_fixture()


def test_long(six):
    sum(range(10 ** 7))


def test_six(six):
    assert six == 6


@pytest.mark.parametrize("text", ["[odd] name", f"{a.NAME}"])
def test_used(text):
    assert a.used(1) == 4


def test_child():
    subprocess.run([sys.executable, "-c", "import a; assert a.in_child() == 5"], check=True)


def test_end():
    a.endless(0)
"""
TEST_B = "def test_nothing():\n    pass\n"


class Copy:
    """In place of a scratch copy: commands run in a folder."""

    def __init__(self, folder: Path) -> None:
        self.tree = self.folder = folder
        self.log = folder / "log"
        self.used_s = 0.0
        self.commands: list[str] = []

    def _environment(self) -> dict[str, str]:
        path = f"{self.tree / 'src'}:{ROOT}:{ROOT / 'host' / 'src'}"
        return {**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}

    def run(self, command: str, _limit_s: float) -> tuple[bool, float]:
        """As in the scratch copy, without its border."""
        self.commands.append(command)
        with self.log.open("w") as log:
            run = subprocess.run(
                ["bash", "-c", command], cwd=self.tree, env=self._environment(),
                stdout=log, stderr=subprocess.STDOUT, check=False,
            )  # fmt: skip
        return run.returncode == 0, 1.0

    def server(self, command: str) -> subprocess.Popen[str]:
        """The same."""
        return subprocess.Popen(
            shlex.split(command), cwd=self.tree, env=self._environment(), text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip


@pytest.fixture
def room(tmp_path: Path) -> tuple[Room, Copy]:
    """A module, a file of tests that uses it, and one that does not."""
    for folder in ("src", "tests"):
        (tmp_path / folder).mkdir()
    (tmp_path / "src" / "a.py").write_text(SOURCE)
    (tmp_path / "tests" / "test_a.py").write_text(TEST_A)
    (tmp_path / "tests" / "test_b.py").write_text(TEST_B)
    (tmp_path / ".venv").symlink_to(sys.prefix)
    return Room("made", "src", "tests", "true", "false", executed=True), Copy(tmp_path)


def test_of_a_mutant_the_tests_run_that_can_notice_it(
    room: tuple[Room, Copy], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its own first; constants have those of the module; a child counts for its file.

    What changes in a child, in a fixture or in an endless loop is noticed; a test's name is not.
    """
    made, copy = room
    given: Any = copy
    monkeypatch.setattr(executed, "SPARE_S", 1)
    mutants = {mutant.key: mutant for mutant in made.mutants(copy.tree)}
    unchanged = Executed(made, given, 60)

    def tests(change: str) -> list[str]:
        named = unchanged.tests(mutants[f"src/a.py: {change}"], SOURCE)
        return [test.removeprefix("tests/test_a.py::test_") for test in named]

    used = {"used[[odd] name]", "used[(1,)]"}
    everyone = used | {"long", "child", "six", "end"}
    calls = "return x + LIMIT => return x - LIMIT"
    assert set(tests(calls)[:2]) == used and set(tests(calls)) == everyone
    assert set(tests("LIMIT = 3 => LIMIT = 4")[:4]) == used | {"long", "end"}
    assert tests("return 6 => return 7")[0] == "long"
    assert tests("x += 1 => x -= 1")[0] == "end"
    assert set(tests("return 5 => return 6")) == everyone
    assert tests("return x - 7 => return x - 8") == []
    judge = PythonJudge(made, given)
    for change, outcome in {
        "LIMIT = 3 => LIMIT = 4": "killed",
        "1, => 2,": "survived",
        "return x - 7 => return x - 8": "survived",
        "return 5 => return 6": "killed",
        "return 6 => return 7": "killed",
        "while x < 8: => while x <= 8:": "survived",
        "x += 1 => x -= 1": "killed",
    }.items():
        assert judge.outcome(mutants[f"src/a.py: {change}"]) == outcome, change
    assert (copy.tree / "src" / "a.py").read_text() == SOURCE
    assert sum("coverage run" in command for command in copy.commands) == 2


START_APART = """import subprocess, sys


def start(module):
    clean = {"PATH": "/usr/bin"}
    program = f"import sys; sys.path.insert(0, 'src'); import {module}; {module}.run()"
    subprocess.run([sys.executable, "-I", "-c", program], check=True, env=clean)
"""
APART = """import apart_too


def run():
    assert apart_too.LIMIT == 7
"""
TEST_APART = """import starts


def test_other():
    pass


def test_start():
    starts.start("apart")
"""


def test_what_runs_apart_is_judged_by_the_tests_that_start_it(room: tuple[Room, Copy]) -> None:
    """The module of the process and what it imports, where no line is recorded."""
    made, copy = room
    given: Any = copy
    files = {"starts": START_APART, "apart": APART, "apart_too": "LIMIT = 7\n"}
    for name, text in files.items():
        (copy.tree / "src" / f"{name}.py").write_text(text)
    (copy.tree / "tests" / "test_apart.py").write_text(TEST_APART)
    sandboxed = replace(made, apart=(("starts.py", "subprocess.run(", "apart"),))
    recorded, unchanged = Executed(made, given, 60), Executed(sandboxed, given, 60)
    judge = PythonJudge(sandboxed, given)
    for mutant in made.mutants(copy.tree):
        source = files.get(Path(mutant.file).stem, "")
        if "7" in source:
            tests = unchanged.tests(mutant, source)
            assert tests == [f"tests/test_apart.py::test_{name}" for name in ("start", "other")]
            assert recorded.tests(mutant, source) == []
            assert judge.outcome(mutant) == "killed"
    unknown = replace(made, apart=(("starts.py", "subprocess.run(", "nowhere"),))
    with pytest.raises(NoResultError, match="'nowhere' is not loaded"):
        Executed(unknown, given, 60)


def test_files_of_tests_must_pass_unchanged(room: tuple[Room, Copy]) -> None:
    """The file and its last lines are named; what skips judges nothing."""
    made, copy = room
    given: Any = copy
    (copy.tree / "tests" / "test_b.py").write_text("def test_no():\n    assert 1 == 2\n")
    with pytest.raises(NoResultError, match=r"nothing changed: tests/test_b.py fails[^~]*1 failed"):
        Executed(made, given, 60)
    skipped = "import pytest\npytest.skip('no brick is built', allow_module_level=True)\n"
    one = "import pytest\n\ndef test_no():\n    pytest.skip('no brick is built')\n"
    for text, said in ((skipped, "fails"), (one, "no test passes")):
        (copy.tree / "tests" / "test_b.py").write_text(text)
        with pytest.raises(NoResultError, match=rf"{said}[^~]*no brick is built"):
            Executed(made, given, 60)


LINES = """a = 1
b = (
    2,
)
@f
def g(
    h=1,
):
    match h:
        case 1:
            return 2
        case _:
            try:
                c()
            except d:
                e()
            else:
                f()
"""


@pytest.mark.parametrize(
    "lines", [[1], [2, 3, 4], [5, 6, 7, 8], [9], [10], [11], [12], [13], [15], [16, 17], [18, 19]]
)
def test_a_line_belongs_to_a_statement(lines: list[int]) -> None:
    """By hand: decorators to a function's head, a case and a handler to themselves."""
    for line in lines:
        assert list(statement_lines(LINES, line)) == lines
