# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The border around a submission: what code inside sees, takes and leaves."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.grading.isolation import (
    TRUST,
    Bounds,
    IsolationError,
    find_isolation,
    isolation_named,
)
from ravenbrick.grading.sandbox import Outcome, run_isolated

LIMITS = [
    ("while True: pass", "time"),
    ("x = bytearray(2_000_000_000)", "MemoryError"),
    ("open('x', 'wb').write(bytes(20_000_000))", "File too large"),
    ("while True: print('x' * 10_000)", "flood"),
    ("import sys\nwhile True: print('x' * 10_000, file=sys.stderr)", "flood"),
    ("import time; time.sleep(1000)", "time"),
]
ESCAPES = {
    "a secret file": ("print(open({secret!r}).read())", "No such file"),
    "the accounts": ("print(open('/etc/passwd').read())", "No such file"),
    "its own tools": ("open('/usr/x', 'w')", "Read-only|Permission"),
    "the network": ("import socket; socket.create_connection(('192.0.2.1', 9), 5)", "unreach"),
    "another user": ("import os; os.setuid(0); os.mkdir('/proc/x')", "Error"),
    "processes": ("import os\nwhile True: os.fork()", "unavailable"),
    "the disk": (
        "for n in range(99): open(f'f{{n}}', 'wb').write(bytes(9_000_000))",
        "No space",
    ),
}


def run(name: str, program: str, seconds: int = 2, readable: tuple[Path, ...] = ()) -> Outcome:
    """A program of Python in the isolation, with small bounds."""
    bounds = Bounds(seconds, 600, 10, scratch_mb=64)
    chosen = find_isolation() if name != TRUST else isolation_named(TRUST)
    return run_isolated(chosen, ["python3", "-c", program], bounds, readable=readable)


@pytest.mark.parametrize(("program", "what"), LIMITS)
@pytest.mark.parametrize("name", [TRUST, pytest.param("bubblewrap", marks=pytest.mark.isolated)])
def test_what_takes_too_much_is_ended(name: str, program: str, what: str) -> None:
    """Processor time, memory, files, output, waiting; with and without a border."""
    outcome = run(name, program)
    assert outcome.code != 0
    assert outcome.timed_out == (what == "time") and outcome.flooded == (what == "flood")
    assert what in ("time", "flood") or what in outcome.output


@pytest.mark.isolated
@pytest.mark.parametrize("what", ESCAPES)
def test_nothing_of_the_host_is_inside(what: str, tmp_path: Path) -> None:
    """Not even a file that anybody may read."""
    secret = tmp_path / "secret"
    secret.write_text("canary")
    program, words = ESCAPES[what]
    outcome = run("bubblewrap", program.format(secret=str(secret)), 5)
    assert outcome.code != 0 and "canary" not in outcome.output
    assert any(word in outcome.output for word in words.split("|")), outcome.output


@pytest.mark.isolated
def test_a_readable_path_cannot_be_written_and_its_neighbour_is_not_there(tmp_path: Path) -> None:
    """Both are files of one folder."""
    for name in ("given", "other"):
        (tmp_path / name).write_text(name)
    told = run("bubblewrap", f"print(open('{tmp_path}/given').read())", 5, (tmp_path / "given",))
    assert told.result == b"given\n"
    for program in (f"open('{tmp_path}/given', 'w')", f"open('{tmp_path}/other')"):
        assert run("bubblewrap", program, 5, (tmp_path / "given",)).code != 0
    assert (tmp_path / "given").read_text() == "given"


@pytest.mark.isolated
def test_a_child_with_its_own_session_ends_with_the_sandbox() -> None:
    """It holds the pipes open and would be waited for."""
    program = "import os, time\nif os.fork() == 0:\n    os.setsid()\n    time.sleep(1000)"
    outcome = run("bubblewrap", program, 20)
    assert outcome.code == 0 and not outcome.timed_out


@pytest.mark.isolated
def test_a_tree_inside_what_is_readable_stays_hidden(tmp_path: Path) -> None:
    """An installed package holds its tree, with the rubrics, but parts of it are needed."""
    tree = tmp_path / "package" / "tree"
    (tree / "tools").mkdir(parents=True)
    (tree / "rubric.toml").write_text("x")
    (tree / "tools" / "file").write_text("tool")
    program = (
        f"import os; print(os.listdir({str(tree)!r}), open({str(tree)!r} + '/tools/file').read())"
    )
    outcome = run_isolated(
        find_isolation(),
        ["python3", "-c", program],
        Bounds(5, 600, 10),
        readable=[tmp_path / "package", tree / "tools"],
        hidden=[tree],
    )
    assert outcome.result == b"['tools'] tool\n"


CAUSES = [
    ("bwrap: No permissions to create new namespace, likely because", "--privileged"),
    ("bwrap: setting up uid map: Permission denied", "apparmor_restrict_unprivileged_userns"),
    ("bwrap: Creating new namespace failed: Operation not permitted", "container"),
]


@pytest.mark.parametrize(("message", "cure"), CAUSES)
def test_a_host_that_forbids_it_is_told_with_cause_and_cure(
    message: str, cure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Messages of bubblewrap in containers, and where AppArmor restricts user namespaces."""
    program = tmp_path / "bwrap"
    program.write_text(f'#!/bin/sh\n[ "$1" = --version ] || {{ echo "{message}" >&2; exit 1; }}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    find_isolation.cache_clear()
    try:
        with pytest.raises(IsolationError) as caught:
            find_isolation()
        table = CliRunner().invoke(app, ["doctor"], env={"COLUMNS": "300"}).stdout
    finally:
        find_isolation.cache_clear()
    assert message in caught.value.sentence and cure in caught.value.sentence
    assert message in table and cure in table


def test_without_a_border_grading_needs_to_be_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing of a submission is touched before."""
    monkeypatch.setenv("PATH", str(tmp_path))
    find_isolation.cache_clear()
    try:
        with pytest.raises(IsolationError, match=r"bwrap is not installed.*bubblewrap"):
            find_isolation()
    finally:
        find_isolation.cache_clear()
