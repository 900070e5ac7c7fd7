# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Grading of good, bad and hostile submissions."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from verification.support.submissions import RUBRIC, SOURCES, write_submission

from ravenbrick.errors import ProjectFileError, UsageError
from ravenbrick.grading import build
from ravenbrick.grading.build import build_image
from ravenbrick.grading.isolation import TRUST, find_isolation, isolation_named
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.sandbox import Outcome, run_isolated
from ravenbrick.grading.submission import (
    Submission,
    SubmissionError,
    find_submissions,
    read_files,
)
from ravenbrick.image.elf import read_image
from ravenbrick.image.raw_binary import flat_image
from ravenbrick.project.templates import create_project
from ravenbrick.project.workspace import tree

RAVENBRICK = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]


@pytest.fixture(scope="module")
def graded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """One campaign over all submissions, on two workers."""
    folder = tmp_path_factory.mktemp("grade")
    all_of = folder / "submissions"
    write_submission(all_of / "good")
    write_submission(all_of / "twin")
    write_submission(all_of / "slow", SOURCES["tasks.adb"].replace("then 50 else", "then 20 else"))
    write_submission(all_of / "broken", SOURCES["tasks.adb"].replace("end Tasks;", "end Task;"))
    linker = 'package body Tasks is\npragma Linker_Options ("-Wl,-plugin,src/evil.h");\n'
    write_submission(
        all_of / "hostile", SOURCES["tasks.adb"].replace("package body Tasks is\n", linker)
    )
    write_submission(all_of / "escapes", **{"extra.c": "#error \x1b]0;owned\x07 \u202e\x9b\n"})
    c = "static void ravenbrick_hide(void) {}\nvoid (*hide)(void) = ravenbrick_hide;\n"
    write_submission(all_of / "local", **{"extra.c": c})
    table = "package body Tasks is\nT : String (1 .. 60_000) := (others => ' ') with Volatile;\n"
    write_submission(
        all_of / "large", SOURCES["tasks.adb"].replace("package body Tasks is\n", table)
    )
    moved = "         Before := Now;\n"
    waits = f"         delay until Next_Release + Milliseconds (5);\n{moved}"
    write_submission(all_of / "waits", SOURCES["tasks.adb"].replace(moved, waits))
    command = [*RAVENBRICK, "grade", str(all_of), "--rubric", str(RUBRIC), "--workers", "2"]
    command += ["--output", str(folder / "out"), "--json"]
    first = subprocess.run(command, capture_output=True, text=True)
    assert first.returncode == 0, first.stdout + first.stderr
    again = subprocess.run(command, capture_output=True, text=True)
    answer = json.loads(first.stdout)
    assert json.loads(again.stdout) == answer
    return {r["submission"]: r for r in answer["results"]}


@pytest.mark.isolated
def test_only_what_a_submission_changed_is_compiled(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The objects of the reference project serve for the rest."""
    said: list[str] = []

    def told(*words: Any, **options: Any) -> Outcome:
        outcome = run_isolated(*words, **options)
        said.append(outcome.output)
        return outcome

    monkeypatch.setattr(build, "BUILD", build.BUILD.replace("gprbuild -q", "gprbuild"))
    monkeypatch.setattr(build, "run_isolated", told)
    sources = {f"src/{name}": text.encode() for name, text in SOURCES.items()}
    sources["src/tasks.adb"] += b"--  own\n"
    build_image(find_isolation(), read_rubric(RUBRIC), sources, tmp_path)
    base, own = (set(re.findall(r"\[Ada\]\s+(\S+\.ad[bs])", text)) for text in said)
    assert "main.adb" in base
    assert own == {"tasks.adb"}


def test_a_right_submission_gets_all_points(graded: dict[str, Any]) -> None:
    """The example itself, also when it was handed in twice."""
    assert graded["good"]["points"] == graded["good"]["of"] == 10
    assert graded["twin"]["checks"] == graded["good"]["checks"]


def test_a_wrong_behaviour_loses_the_points_of_its_check_only(graded: dict[str, Any]) -> None:
    """Too slow a motor; what was found is told."""
    assert graded["slow"]["points"] == 8
    lost = [row for row in graded["slow"]["checks"] if row["points"] < row["of"]]
    assert [row["name"] for row in lost] == ["the motor turns while the sensor is pressed"]
    assert "rad/s" in lost[0]["found"]


def test_a_wait_inside_a_job_does_not_make_two_short_jobs_of_it(graded: dict[str, Any]) -> None:
    """The deadlines are judged for the releases of the assignment only."""
    assert graded["waits"]["points"] == 9
    lost = next(row for row in graded["waits"]["checks"] if row["points"] < row["of"])
    assert lost["name"] == "no deadline is missed"
    assert "the task 'control_task' is not released as the assignment says" in lost["found"]


def test_what_does_not_compile_gets_nothing_and_the_compiler_s_line(graded: dict[str, Any]) -> None:
    """File and line as the compiler names them, no folder of the grader."""
    assert graded["broken"]["points"] == 0
    found = graded["broken"]["checks"][0]["found"]
    assert "tasks.adb:" in found and "/tmp" not in found


def test_an_image_that_does_not_fit_is_told_with_its_bytes(graded: dict[str, Any]) -> None:
    """The linker says so before it repeats its long command."""
    assert graded["large"]["points"] == 0
    found = graded["large"]["checks"][0]["found"]
    assert re.fullmatch(r"the ram image is \d+ bytes too large for the RAM; shorten.*", found)


def test_options_for_the_host_s_linker_are_refused(graded: dict[str, Any]) -> None:
    """They could load code into the linker; the compiler's record of them decides."""
    assert graded["hostile"]["points"] == 0
    assert "the linker option" in graded["hostile"]["checks"][0]["found"]


def test_what_is_found_commands_no_terminal(graded: dict[str, Any]) -> None:
    """Nor does it turn round the text behind it."""
    found = graded["escapes"]["checks"][0]["found"]
    assert "#error ?]0;owned? " in found and found.replace("\n", "").isprintable()


def test_a_function_that_only_its_file_knows_has_no_name_of_the_run_time(
    graded: dict[str, Any],
) -> None:
    """By the name, the run knows who may write what only the run-time writes."""
    found = graded["local"]["checks"][0]["found"]
    assert found == "defines ravenbrick_hide, a name of the run-time; choose another name"


def test_the_report_names_the_isolation(graded: dict[str, Any]) -> None:
    """Bubblewrap with its version, or that there was none."""
    assert re.match(r"bubblewrap \d|none \(--trust", graded["good"]["isolation"])


def test_an_archive_cannot_write_outside(tmp_path: Path) -> None:
    """Only the last folder and the file name of a member count; none has a blank in it."""
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr("../../src/tasks.adb", "package body Tasks is end Tasks;")
        archive.writestr("work/src/main.adb", "procedure Main is begin null; end Main;")
        archive.writestr("work/src/my tasks.adb", "package body Tasks is end Tasks;")
        archive.writestr("work/Makefile", "all:; rm -rf /")
    sources = read_files(Submission("x", tmp_path / "x.zip"), ("src",))
    assert sorted(sources) == ["src/main.adb", "src/tasks.adb"]


def test_a_link_to_a_folder_is_not_followed(tmp_path: Path) -> None:
    """It may lead to what is another student's."""
    write_submission(tmp_path / "other")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "src").symlink_to(tmp_path / "other" / "src")
    with pytest.raises(SubmissionError, match="no Ada or C sources"):
        read_files(Submission("own", tmp_path / "own"), ("src",))


def test_no_source_has_a_name_that_a_tool_may_take_for_something_else(tmp_path: Path) -> None:
    """Options, quotes, hidden files of other systems, what the binder makes, homoglyphs."""
    odd = ["-x.c", "it's.c", "._tasks.adb", "b__evil.c", "t\u0430sks.adb", "x;y.c", "tasks.ADB"]
    write_submission(tmp_path / "odd", **dict.fromkeys(odd, "int ravenbrick__threads__x;"))
    with zipfile.ZipFile(tmp_path / "odd.zip", "w") as archive:
        for name in [*odd, "a~b.adb", "tasks-more.ads", "2nd.c"]:
            archive.writestr(f"__MACOSX/src/{name}", "")
    folder = read_files(Submission("odd", tmp_path / "odd"), ("src",))
    assert sorted(folder) == sorted(f"src/{name}" for name in SOURCES)
    packed = read_files(Submission("odd", tmp_path / "odd.zip"), ("src",))
    assert sorted(packed) == ["src/2nd.c", "src/a~b.adb", "src/tasks-more.ads"]


def test_names_as_long_as_a_file_system_takes_are_cut(tmp_path: Path) -> None:
    """A result's file has the name and more; two that begin alike are told apart."""
    for last in "ab":
        write_submission(tmp_path / f"{'€' * 84}{last}")
    names = [submission.name for submission in find_submissions([tmp_path])]
    assert names == ["€" * 66, f"{'€' * 66}-2"]


def test_a_file_that_becomes_a_link_while_it_is_graded_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A student who may still write there could make the grader read for them."""
    secret = tmp_path / "secret.adb"
    secret.write_text("of another")
    source = write_submission(tmp_path / "own") / "src" / "tasks.adb"
    as_it_is = os.stat

    def then_changed(path: Any, **options: Any) -> os.stat_result:
        found = as_it_is(path, **options)
        if path == "tasks.adb":
            source.unlink()
            source.symlink_to(secret)
        return found

    monkeypatch.setattr(os, "stat", then_changed)
    with pytest.raises(SubmissionError, match="cannot be read"):
        read_files(Submission("own", tmp_path / "own"), ("src",))


def test_an_archive_of_too_many_entries_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        for number in range(10_001):
            archive.writestr(f"{number}", "")
    with pytest.raises(SubmissionError, match="more than 10000 files"):
        read_files(Submission("x", tmp_path / "x.zip"), ("src",))


def test_files_of_one_name_count_with_all_that_is_read_of_them(tmp_path: Path) -> None:
    """10,000 of them in 10 MB would take the grader 10 GB of reading."""
    with zipfile.ZipFile(tmp_path / "x.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for number in range(9):
            archive.writestr(f"{number}/src/a.c", bytes(900_000))
    with pytest.raises(SubmissionError, match="more than 8 MB of sources"):
        read_files(Submission("x", tmp_path / "x.zip"), ("src",))


def test_no_submission_and_doubled_names_are_said(tmp_path: Path) -> None:
    """Before anything is built."""
    with pytest.raises(UsageError, match="no submission"):
        find_submissions([tmp_path])
    for folder in ("a", "b"):
        write_submission(tmp_path / folder / "same")
    with pytest.raises(UsageError, match="'same'"):
        find_submissions([tmp_path / "a" / "same", tmp_path / "b" / "same"])


WRONG = [
    ("builds = true", "builds = true\nmemory_at_most = 5", "expected exactly one of"),
    ('expect = "deadlines met"', 'expect = "all is well"', "is not an expectation"),
    ('scenario = "press"\nexpect = "dead', 'expect = "dead', "needs a 'scenario'"),
    ('scenario = "press"', 'scenario = "pres"', "correct the name"),
    ('name = "lab-01"', 'nome = "lab-01"', "did you mean 'name'"),
]


@pytest.mark.parametrize(("old", "new", "problem"), WRONG)
def test_a_wrong_rubric_is_told_with_its_line(
    old: str, new: str, problem: str, tmp_path: Path
) -> None:
    """File, line and field, as for the other files."""
    text = RUBRIC.read_text().replace("../../../examples", str(RUBRIC.parents[3] / "examples"))
    assert old in text
    wrong = tmp_path / "rubric.toml"
    wrong.write_text(text.replace(old, new, 1))
    with pytest.raises(ProjectFileError, match=r"rubric.toml:\d+: ") as caught:
        read_rubric(wrong)
    assert problem in caught.value.sentence


def test_a_rubric_of_the_lessons_is_found_by_its_name() -> None:
    """Wherever the command is called; a name of none is told."""
    assert read_rubric(Path("lab-01")).path.resolve() == RUBRIC.resolve()
    with pytest.raises(ProjectFileError, match="name a rubric"):
        read_rubric(Path("lab-00"))


def test_objects_of_the_reference_give_the_image_of_a_whole_build(tmp_path: Path) -> None:
    """A changed specification and a changed body; all that depends on them is compiled again."""
    swapped = re.sub(
        r"'First \+ ([12])", lambda m: f"'First + {3 - int(m[1])}", SOURCES["tasks.ads"]
    )
    slow = SOURCES["tasks.adb"].replace("then 50 else", "then 20 else")
    folder = write_submission(tmp_path / "s", slow, **{"tasks.ads": swapped})
    rubric, isolation = read_rubric(RUBRIC), isolation_named(TRUST)
    sources = read_files(Submission("s", folder), rubric.folders)
    image = build_image(isolation, rubric, sources, tmp_path / "cache")
    project = create_project(tmp_path / "whole", "blank").project
    for file in (folder / "src").iterdir():
        shutil.copy(file, project / "src")
    robot = project / "robot.toml"
    robot.write_text(robot.read_text().replace("stack_check = true\n", ""))  # as the reference
    subprocess.run(["make", "-C", project, f"RAVENBRICK_HOME={tree()}"], check=True)
    whole = read_image(project / "build" / "whole" / "ram" / "whole.elf")
    assert flat_image(read_image(image)) == flat_image(whole)
