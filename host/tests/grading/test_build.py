# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the sandbox gives back of a build or a design decides; no compiler runs here."""

from __future__ import annotations

import io
import tarfile
from pathlib import Path
from typing import Any

import pytest
from verification.support.submissions import RUBRIC, SOURCES

from ravenbrick.grading import build
from ravenbrick.grading.isolation import TRUST, isolation_named
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.sandbox import Outcome
from ravenbrick.grading.submission import DESIGN, SubmissionError
from ravenbrick.project.workspace import tree

FILES = {f"src/{name}": text.encode() for name, text in SOURCES.items()}


class Sandbox:
    """Gives these outcomes, one after the other."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *outcomes: Outcome) -> None:
        self.outcomes = list(outcomes)
        monkeypatch.setattr(build, "run_isolated", lambda *_a, **_k: self.outcomes.pop(0))

    def image(self, cache: Path) -> Path:
        """Of the first lab's solution."""
        return build.build_image(isolation_named(TRUST), read_rubric(RUBRIC), FILES, cache)

    def design(self) -> dict[str, bytes]:
        """The sources with what design.py made."""
        files = {**FILES, DESIGN: b"print()"}
        return build.design_files(isolation_named(TRUST), read_rubric(RUBRIC), files)


def archive(**files: bytes) -> bytes:
    """Of files below generated/, and a link to one that the host has."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as made:
        for name, content in files.items():
            member = tarfile.TarInfo(f"generated/{name}.c")
            member.size = len(content)
            made.addfile(member, io.BytesIO(content))
        link = tarfile.TarInfo("generated/link.c")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        made.addfile(link)
    return stream.getvalue()


def test_a_build_that_failed_is_not_done_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The same sources get the same sentence; other sources of a class are still built."""
    said = "/tmp/x/project/src/tasks.adb:3:4: error: missing semicolon"
    base, failed = Outcome(0, "", b"objects"), Outcome(4, said, b"")
    sandbox = Sandbox(monkeypatch, base, failed)
    for _time in range(2):
        with pytest.raises(SubmissionError, match=r"^src/tasks\.adb:3:4: .*missing semicolon"):
            sandbox.image(tmp_path)
    assert not sandbox.outcomes


def test_a_message_is_cut_and_names_no_folder_of_the_grader(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of one endless line, in which names of folders would be looked for again and again."""
    said = f"{tree()}/drivers/src/nxt.ads:1:1: error: {'x' * 20_000}"
    sandbox = Sandbox(monkeypatch, Outcome(0, "", b"objects"), Outcome(4, said, b""))
    with pytest.raises(SubmissionError, match=r"^drivers/src/nxt\.ads:1:1: x{900,1000}$"):
        sandbox.image(tmp_path)


@pytest.mark.parametrize(
    ("ended_by", "sentence"),
    [
        ({"timed_out": True}, r"took more than \d+ s of processor time"),
        ({"flooded": True}, "messages never end"),
        ({"full": True}, "No space"),
    ],
)
def test_the_limit_that_ended_it_is_told(
    ended_by: dict[str, Any], sentence: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of the build and of the design; an exit code would tell a student nothing."""
    ended = Outcome(137, "Killed", b"", **ended_by)
    with pytest.raises(SubmissionError, match=sentence):
        Sandbox(monkeypatch, Outcome(0, "", b"objects"), ended).image(tmp_path)
    with pytest.raises(SubmissionError, match=sentence):
        Sandbox(monkeypatch, ended).design()


def test_of_what_a_design_leaves_regular_files_of_bounded_size_are_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As large as the bound, none larger, no link."""
    monkeypatch.setattr(build, "FILE_MAX", 8)
    left = archive(small=b"int x;", whole=b"int abc;", large=b"int abcd;")
    made = Sandbox(monkeypatch, Outcome(0, "", left)).design()
    assert set(made) - set(FILES) - {DESIGN} == {"generated/small.c", "generated/whole.c"}
    with pytest.raises(SubmissionError, match="left no readable result"):
        Sandbox(monkeypatch, Outcome(0, "", b"no archive" * 60)).design()
