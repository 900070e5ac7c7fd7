# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C at any moment: one line, exit code 130, no process left, no file half written.

Each program says by a named pipe that it has come to the moment, and waits there; then its whole
process group is interrupted, as a terminal does it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from select import select

import pytest
from verification.support.fake_tools import install_fake_tools, write_recipe
from verification.support.recordings import preempted

from ravenbrick.project.workspace import Workspace

# In a module's place: whoever imports it stands still there. Short sleeps, since Python misses a
# signal that comes between its last look and the system call until the call ends.
STANDS_STILL = """
import os, time
os.write(os.open({moment!r}, os.O_WRONLY), b"here")
for _ in range(12_000):
    time.sleep(0.05)
"""
MAIN = "from ravenbrick.cli import main; main()"
# As a signal that comes while this module is being looked for.
WHILE_IMPORTING = """
import os, signal, sys
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder())
"""

# The first line with this word is the moment.
SAYS_WHERE_IT_IS = """
import os
from ravenbrick.cli.console import Reporter
tell = Reporter.print
def told(self, text=""):
    tell(self, text)
    if "Ctrl-C" in text:
        os.write(os.open({moment!r}, os.O_WRONLY), b"here")
Reporter.print = told
"""
# As if the format's library took long for its last piece.
WRITES_LAST = """
import ravenbrick.trace.export as export
chosen = export.Format({format!r})
write = export._WRITERS[chosen]
def slowly(timeline, path):
    write(timeline, path)
    exec({stands_still!r})
export._WRITERS[chosen] = slowly
"""


@dataclass(frozen=True)
class Ended:
    """What an interrupted program left."""

    code: int
    output: str
    errors: str
    alone: bool


class Stage:
    """A pipe that a program writes to when it has come to the moment, and the program's end."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.moment = folder / "moment"
        os.mkfifo(self.moment)
        self.stands_still = STANDS_STILL.format(moment=str(self.moment))
        self.told = os.open(self.moment, os.O_RDONLY | os.O_NONBLOCK)

    def module(self, name: str) -> None:
        """Who imports this module stands still."""
        (self.folder / f"{name}.py").write_text(self.stands_still)

    def program(self, name: str) -> None:
        """Who runs this program waits for it."""
        file = self.folder / name
        file.write_text(f"#!{sys.executable}\n{self.stands_still}")
        file.chmod(0o755)

    def interrupted(self, *words: object, before: str = "") -> Ended:
        """Run the command line up to the moment, and interrupt its group."""
        with self._started(words, before) as program:
            while not select([self.told], [], [], 0.05)[0] or not os.read(self.told, 4):
                assert program.poll() is None, program.communicate()
            os.killpg(program.pid, signal.SIGINT)
            output, errors = program.communicate(timeout=60)
            return Ended(program.returncode, output, errors, _is_alone(program.pid))

    @contextmanager
    def _started(self, words: tuple[object, ...], before: str) -> Iterator[subprocess.Popen[str]]:
        environment = os.environ | {
            "PATH": f"{self.folder}:{os.environ['PATH']}",
            "PYTHONPATH": str(self.folder),
        }
        command = [sys.executable, "-c", before + MAIN, *map(str, words)]
        with subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=environment,
            cwd=self.folder,
        ) as program:
            try:
                yield program
            finally:
                if program.poll() is None:
                    os.killpg(program.pid, signal.SIGKILL)


def _members(group: int) -> list[str]:
    """States and names of the group's processes that have not ended."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            name, _, rest = file.read_text().rpartition(")")
            state, _parent, its_group = rest.split()[:3]
            if int(its_group) == group and state not in "ZX":
                found.append(f"{state} {name}")
    return found


def _is_alone(group: int) -> bool:
    """Whether the group's last process ends; all have closed their output by now."""
    latest = time.monotonic() + 10
    while _members(group) and time.monotonic() < latest:
        time.sleep(0.01)
    return not _members(group)


def one_line(ended: Ended) -> None:
    """The sentence and nothing else, and nobody is left."""
    assert ended.errors.splitlines() == ["ravenbrick: interrupted"]
    assert ended.code == 130
    assert ended.alone


@pytest.fixture
def stage(tmp_path_factory: pytest.TempPathFactory) -> Stage:
    """Where the moment comes."""
    return Stage(tmp_path_factory.mktemp("stage"))


@pytest.mark.parametrize("module", ["ravenbrick.cli.app", "typer", "ravenbrick.cli.design"])
@pytest.mark.parametrize("as_json", [False, True])
def test_an_interruption_while_modules_are_loaded(
    tmp_path: Path, module: str, as_json: bool
) -> None:
    words = ["design", str(tmp_path), *(["--json"] if as_json else [])]
    code = WHILE_IMPORTING.format(module=module) + MAIN
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 130
    if as_json:
        answer = json.loads(done.stdout)
        assert (answer["ok"], answer["error"], done.stderr.strip()) == (False, "interrupted", "")
    else:
        assert [line for line in done.stderr.splitlines() if line] == ["ravenbrick: interrupted"]


@pytest.mark.parametrize("deaf", [False, True])
def test_an_interruption_while_design_py_runs(project: Path, stage: Stage, deaf: bool) -> None:
    """Also of a script that does not listen."""
    ignore = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n" if deaf else ""
    (project / "design.py").write_text(ignore + stage.stands_still)
    one_line(stage.interrupted("design", project))
    assert not Workspace.of(project).design_file.exists()


def test_an_interruption_while_gprbuild_builds(
    project: Path, stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it had started ends with it."""
    install_fake_tools(stage.folder / "tools", monkeypatch)
    write_recipe(project)
    stage.program("gprbuild")
    one_line(stage.interrupted("build", project))


@pytest.mark.parametrize(
    "words",
    [
        ("run", "drive"),
        ("live", "drive", "--bluetooth", "tcp:0"),
        ("debug", "drive", "--port", "0", "--image", "ram"),
        ("identify", "drive", "step"),
        ("sweep", "drive", "--count", "3", "--workers", "2"),
        ("analyse",),
    ],
)
def test_an_interruption_while_the_virtual_brick_is_at_work(
    project: Path, stage: Stage, words: tuple[str, ...]
) -> None:
    """In the command itself, or in the worker processes of a sweep."""
    stage.module("virtual_brick")
    one_line(stage.interrupted(words[0], project, *words[1:]))


def test_an_interrupted_command_answers_in_json(project: Path, stage: Stage) -> None:
    stage.module("virtual_brick")
    ended = stage.interrupted("run", project, "drive", "--json")
    assert json.loads(ended.output)["exit_code"] == ended.code == 130
    assert ended.errors == ""


@pytest.mark.parametrize(
    ("command", "rest"),
    [
        ("monitor", ("tcp:1",)),
        ("debug", ("drive", "--port", "0", "--image", "ram")),
    ],
)
def test_an_interruption_of_what_waits_for_others(
    project: Path, stage: Stage, command: str, rest: tuple[str, ...]
) -> None:
    """Servers and the monitor, when they have said that Ctrl-C ends them."""
    pytest.importorskip("virtual_brick")
    words = rest if command == "monitor" else (project, *rest)
    before = SAYS_WHERE_IT_IS.format(moment=str(stage.moment))
    one_line(stage.interrupted(command, *words, before=before))


@pytest.mark.parametrize("file_format", ["perfetto", "vcd", "mcap", "csv", "parquet"])
def test_an_interrupted_or_refused_export_leaves_nothing(
    tmp_path: Path, stage: Stage, file_format: str
) -> None:
    """The libraries of the formats write piece by piece; the files come when all is written."""
    recording, out = tmp_path / "run.npz", tmp_path / "out"
    preempted().save(recording)
    out.mkdir()
    before = WRITES_LAST.format(format=file_format, stands_still=stage.stands_still)
    words = ("export", recording, "--format", file_format, "--out", out / "run.x")
    one_line(stage.interrupted(*words, before=before))
    assert list(out.iterdir()) == []


def test_an_interruption_while_submissions_are_built(stage: Stage, tmp_path: Path) -> None:
    """What runs in sandboxes has its own session, and ends too."""
    stage.program("gprbuild")
    submission = tmp_path / "anna"
    (submission / "src").mkdir(parents=True)
    rubric = Path(__file__).resolve().parents[3] / "docs/lessons/rubrics/lab-01.toml"
    (submission / "src" / "tasks.adb").write_text("-- empty")
    ended = stage.interrupted(
        "grade", submission, "--rubric", rubric, "--output", tmp_path / "grades",
        "--trust-submissions",
    )  # fmt: skip
    one_line(ended)
