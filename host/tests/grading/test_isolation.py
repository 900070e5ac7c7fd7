# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The border around a submission: what code inside sees, takes and leaves."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.grading.isolation import (
    TRUST,
    Bounds,
    Isolation,
    IsolationError,
    confinement,
    find_isolation,
    isolation_named,
    landlock,
)
from ravenbrick.grading.isolation.landlock import Landlock
from ravenbrick.grading.sandbox import Outcome, run_isolated

LIMITS = [
    ("while True: pass", "time"),
    ("x = bytearray(2_000_000_000)", "MemoryError"),
    ("open('x', 'wb').write(bytes(20_000_000))", "File too large"),
    ("while True: print('x' * 10_000)", "flood"),
    ("import sys\nwhile True: print('x' * 10_000, file=sys.stderr)", "flood"),
    ("import time; time.sleep(1000)", "time"),
]
BORDERS = ("bubblewrap", Landlock.name)
ESCAPES = {
    "a secret file": ("print(open({secret!r}).read())", "No such file|Permission denied"),
    "the accounts": ("print(open('/etc/passwd').read())", "No such file|Permission denied"),
    "its own tools": ("open('/usr/x', 'w')", "Read-only|Permission"),
    "the network": ("import socket; socket.create_connection(('192.0.2.1', 9), 5)", "not permit"),
    "another user": ("import os; os.setuid(0); os.mkdir('/proc/x')", "Error"),
    "processes": ("import os\nwhile True: os.fork()", "unavailable"),
    "the modes of files": (
        "import os; os.chmod({secret!r}, 0o777); print(open({secret!r}).read())",
        "No such file|Permission denied",
    ),
    "memory that no limit counts": ("import os; os.memfd_create('m')", "not permitted"),
    "signals": ("import os; os.kill(os.getppid(), 9)", "not permitted"),
    "attributes": ("import os; os.setxattr({secret!r}, 'user.x', b'x')", "not permitted|No such"),
}


def landlock_version() -> int:
    """As landlock_create_ruleset(2) says: an answer of ours would hide faults of ours."""
    return int(ctypes.CDLL(None).syscall(444, None, 0, 1))


def border(name: str) -> Isolation:
    """The border of that name, where this machine has it."""
    if name == "bubblewrap":
        return find_isolation()
    if name == Landlock.name and landlock_version() < 1:
        pytest.skip("the kernel has no Landlock")
    return isolation_named(name)


def run(name: str, program: str, seconds: int = 2, readable: tuple[Path, ...] = ()) -> Outcome:
    """A program of Python in the isolation, with small bounds."""
    bounds = Bounds(seconds, 600, 10, scratch_mb=64)
    return run_isolated(border(name), ["python3", "-c", program], bounds, readable=readable)


@pytest.mark.parametrize(("program", "what"), LIMITS)
@pytest.mark.parametrize(
    "name", [TRUST, *(pytest.param(name, marks=pytest.mark.isolated) for name in BORDERS)]
)
def test_what_takes_too_much_is_ended(name: str, program: str, what: str) -> None:
    """Processor time, memory, files, output, waiting; with and without a border."""
    outcome = run(name, program)
    assert outcome.code != 0
    assert outcome.timed_out == (what == "time") and outcome.flooded == (what == "flood")
    assert what in ("time", "flood") or what in outcome.output


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
@pytest.mark.parametrize("what", ESCAPES)
def test_nothing_of_the_host_is_inside(name: str, what: str, tmp_path: Path) -> None:
    """Not even a file that anybody may read."""
    secret = tmp_path / "secret"
    secret.write_text("canary")
    program, words = ESCAPES[what]
    outcome = run(name, program.format(secret=str(secret)), 5)
    assert secret.stat().st_mode & 0o777 != 0o777
    assert outcome.code != 0 and "canary" not in outcome.output
    assert any(word in outcome.output for word in words.split("|")), outcome.output


@pytest.mark.parametrize(
    "name", [TRUST, *(pytest.param(name, marks=pytest.mark.isolated) for name in BORDERS)]
)
def test_variables_and_home_are_its_own(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No variable of the grader is handed on; the home folder is the one that it may write."""
    monkeypatch.setenv("RAVENBRICK_CANARY", "canary")
    program = (
        "import os\nopen(os.path.expanduser('~/x'), 'w').close()\n"
        "print(os.path.samefile(os.environ['HOME'], '.'), os.path.exists('x'))\n"
        "print(dict(os.environ))"
    )
    outcome = run(name, program, 5)
    assert outcome.code == 0, outcome.output
    assert outcome.result.startswith(b"True True\n")
    assert b"canary" not in outcome.result


@pytest.mark.skipif(os.cpu_count() == 1, reason="one processor has one thread anyway")
def test_linear_algebra_takes_one_thread() -> None:
    """More would count as processes, of which a sandbox has few, and take others' processors."""
    program = (
        "import numpy, os\nnumpy.eye(500) @ numpy.eye(500)\nprint(os.listdir('/proc/self/task'))"
    )
    bounds = Bounds(20, 2_000, 10)
    outcome = run_isolated(isolation_named(TRUST), [sys.executable, "-c", program], bounds)
    assert outcome.code == 0, outcome.output
    assert len(outcome.result.split()) == 1


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
@pytest.mark.parametrize("delete", ["", "os.remove(f'f{n}'); "])
def test_the_disk_is_not_filled(name: str, delete: str) -> None:
    """Neither with files nor with files that were deleted and are still open."""
    program = (
        "import os, time\nkept = []\nfor n in range(99):\n    kept.append(open(f'f{n}', 'wb')); "
    )
    program += delete + "kept[-1].write(bytes(9_000_000))\ntime.sleep(5)"
    outcome = run(name, program, 20)
    assert outcome.full or "No space" in outcome.output
    assert outcome.code != 0


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
def test_a_readable_path_cannot_be_written_and_its_neighbour_is_not_there(
    name: str, tmp_path: Path
) -> None:
    """Both are files of one folder."""
    for file in ("given", "other"):
        (tmp_path / file).write_text(file)
    told = run(name, f"print(open('{tmp_path}/given').read())", 5, (tmp_path / "given",))
    assert told.result == b"given\n"
    for program in (f"open('{tmp_path}/given', 'w')", f"open('{tmp_path}/other')"):
        assert run(name, program, 5, (tmp_path / "given",)).code != 0
    assert (tmp_path / "given").read_text() == "given"


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
def test_instants_of_files_are_set_only_where_those_of_others_cannot_be(
    name: str, tmp_path: Path
) -> None:
    """gprbuild compiles again what has another instant; Landlock does not guard instants."""
    (tmp_path / "given").touch()
    program = "import os; open('own', 'w'); os.utime('own', (1, 1)); print(os.stat('own').st_mtime)"
    own = float(run(name, program, 5).result)
    assert (own == 1) is (name == "bubblewrap")
    run(name, f"import os; os.utime('{tmp_path}/given', (1, 1))", 5, (tmp_path / "given",))
    assert (tmp_path / "given").stat().st_mtime != 1


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
def test_a_child_ends_with_the_sandbox_and_gets_no_session_of_its_own(name: str) -> None:
    """It holds the pipes open and would be waited for."""
    program = "import os, time\nif os.fork() == 0:\n    os.setsid()\n    time.sleep(1000)"
    for kept in (program, program.replace("    os.setsid()\n", "")):
        outcome = run(name, kept, 20)
        assert outcome.code == 0 and not outcome.timed_out
    assert "not permitted" in run(name, program + "\nos.wait()", 20).output


@pytest.mark.isolated
@pytest.mark.parametrize("name", BORDERS)
def test_a_tree_inside_what_is_readable_stays_hidden(name: str, tmp_path: Path) -> None:
    """An installed package holds its tree, with the rubrics, but parts of it are needed."""
    tree = tmp_path / "package" / "tree"
    (tree / "tools").mkdir(parents=True)
    (tree / "rubric.toml").write_text("x")
    (tree / "tools" / "file").write_text("tool")
    (tmp_path / "package" / "part").write_text("part")
    for file, code in (("tools/file", 0), ("../part", 0), ("rubric.toml", 1)):
        outcome = run_isolated(
            border(name),
            ["python3", "-c", f"print(open('{tree}/{file}').read())"],
            Bounds(5, 600, 10),
            readable=[tmp_path / "package", tree / "tools"],
            hidden=[tree],
        )
        assert outcome.code == code, outcome.output


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
    monkeypatch.setattr(landlock, "CONFINEMENT", tmp_path / "absent")
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
    monkeypatch.setattr(landlock, "CONFINEMENT", tmp_path / "absent")
    find_isolation.cache_clear()
    try:
        with pytest.raises(IsolationError, match=r"bwrap is not installed.*bubblewrap"):
            find_isolation()
    finally:
        find_isolation.cache_clear()


HEADER = Path("/usr/include/linux/landlock.h")


@pytest.mark.skipif(not HEADER.is_file(), reason="the Debian package linux-libc-dev has the header")
def test_the_rights_are_those_of_the_kernel_s_header() -> None:
    """As many bits as it has rights that this kernel's first version knew; the rest is newer."""
    found = re.findall(r"LANDLOCK_ACCESS_FS_(\w+)\s+\(1ULL << (\d+)\)", HEADER.read_text())
    rights = {name: 1 << int(bit) for name, bit in found}
    named = {n: getattr(confinement, n) for n in rights if hasattr(confinement, n)}
    assert named == {name: rights[name] for name in named}
    assert {"EXECUTE", "READ_FILE", "MAKE_CHAR", "MAKE_SOCK", "MAKE_BLOCK"} <= named.keys()
    first = [
        right for name, right in rights.items() if name not in ("REFER", "TRUNCATE", "IOCTL_DEV")
    ]
    assert sum(first) == confinement.FIRST_RIGHTS


def test_bubblewrap_is_taken_where_it_works() -> None:
    """Tried here without our options: what is wrong with those must not be passed over."""
    plain = ["bwrap", "--unshare-pid", "--ro-bind", "/", "/", "true"]
    if shutil.which("bwrap") is None or subprocess.run(plain, capture_output=True).returncode:
        pytest.skip("bubblewrap does not work on this machine")
    assert find_isolation().name.startswith("bubblewrap ")


@pytest.mark.isolated
def test_landlock_takes_over_where_namespaces_are_forbidden(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a container with its default settings."""
    border(Landlock.name)
    monkeypatch.setenv("PATH", str(tmp_path))
    find_isolation.cache_clear()
    try:
        assert find_isolation().name == Landlock.name
    finally:
        find_isolation.cache_clear()
