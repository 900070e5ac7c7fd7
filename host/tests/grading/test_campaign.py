# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A campaign goes on after it was killed, and one bad submission takes no marks of the others."""

from __future__ import annotations

import importlib
import importlib.util
import os
import signal
import subprocess
import sys
import threading
import time
import zipfile
from pathlib import Path
from typing import Any

import pytest
from verification.support.submissions import RUBRIC, SOURCES, write_submission

from ravenbrick.errors import UsageError
from ravenbrick.grading import build, campaign, work
from ravenbrick.grading.draws import Pulses, hidden_seeds
from ravenbrick.grading.isolation import TRUST
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.sandbox import Outcome
from ravenbrick.grading.submission import SubmissionError, find_submissions, read_files

BORDER = TRUST if os.environ.get("RAVENBRICK_TRUST_SUBMISSIONS") else None
GRADE = [sys.executable, "-c", "from ravenbrick.cli import main; main()", "grade"]
LONGEST_S = 600


def grade(students: Path, out: Path) -> list[dict[str, Any]]:
    """A campaign in this process, always with the same secret."""
    return campaign.run_campaign(
        read_rubric(RUBRIC), find_submissions([students]), out, 2, border=BORDER, secret="x"
    )


@pytest.mark.long("six submissions twice")
@pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None,
    reason="distributed is not installed: pip install -r tools/requirements/cluster.txt",
)
def test_a_killed_worker_of_a_cluster_costs_no_submission(tmp_path: Path) -> None:
    """Its job is given to another worker: the marks are those of a campaign without a cluster."""
    students, out = tmp_path / "students", tmp_path / "out"
    for number in range(6):
        write_submission(
            students / f"s{number}", SOURCES["tasks.adb"].replace("50", f"{50 - number}")
        )
    found = find_submissions([students])
    killed = []

    def kill_one(workers: list[int]) -> None:
        end = time.monotonic() + LONGEST_S
        while not list((out / "results").rglob("*.json")) and time.monotonic() < end:
            time.sleep(0.02)
        os.kill(workers[0], signal.SIGKILL)
        killed.append(workers[0])

    distributed = importlib.import_module("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        workers = [worker.pid for worker in cluster.workers.values()]
        killer = threading.Thread(target=kill_one, args=(workers,))
        killer.start()
        address = cluster.scheduler_address
        results = campaign.run_campaign(
            read_rubric(RUBRIC), found, out, 2, dask=address, border=BORDER, secret="x"
        )
        killer.join()
    assert killed and results == grade(students, tmp_path / "whole")
    assert not any("defect" in result for result in results)
    assert not list(out.rglob("*.part"))


def test_a_killed_campaign_goes_on_with_nothing_lost_and_nothing_left(tmp_path: Path) -> None:
    """Killed when the first result is there; the second campaign has the marks of a whole one."""
    students, out = tmp_path / "students", tmp_path / "out"
    for number in range(4):
        write_submission(
            students / f"s{number}", SOURCES["tasks.adb"].replace("50", f"{50 - number}")
        )
    command = [*GRADE, str(students), "--rubric", str(RUBRIC), "--output", str(out)]
    results = out / "results" / "lab-01"
    with subprocess.Popen([*command, "--secret", "x", "--workers", "2"]) as process:
        end = time.monotonic() + LONGEST_S
        while not list(results.glob("*.json")) and time.monotonic() < end:
            assert process.poll() is None, "the campaign ended without a result"
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
    kept = {file.name: file.stat().st_mtime_ns for file in results.glob("*.json")}
    assert kept
    unfinished = out / "cache" / "images" / "x.elf.1.part"
    unfinished.write_bytes(b"half")
    again = grade(students, out)
    assert {n: (results / n).stat().st_mtime_ns for n in kept} == kept
    assert again == grade(students, tmp_path / "whole")
    assert not list(out.rglob("*.part"))


def test_a_grader_that_fails_on_one_marks_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The defect is in that result, which is not kept."""
    for name in ("good", "odd"):
        write_submission(tmp_path / "students" / name)
    read = read_files

    def fails(submission: Any, *others: Any) -> dict[str, bytes]:
        if submission.name == "odd":
            raise ZeroDivisionError("no such case")
        return read(submission, *others)

    monkeypatch.setattr(work, "read_files", fails)
    good, odd = grade(tmp_path / "students", tmp_path / "out")
    assert good["points"] == good["of"] and "ZeroDivisionError" in odd["defect"]
    assert not (tmp_path / "out" / "results" / "lab-01" / "odd.json").exists()


def test_a_reference_project_that_does_not_build_is_no_student_s_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The campaign ends before a submission gets a mark."""
    write_submission(tmp_path / "students" / "good")
    failed = Outcome(1, "robot.gpr:3:1: wrong", b"")
    monkeypatch.setattr(build, "run_isolated", lambda *_words, **_options: failed)
    with pytest.raises(UsageError, match=r"examples/blank does not build: robot\.gpr:3:1: wrong"):
        grade(tmp_path / "students", tmp_path / "out")
    assert not list((tmp_path / "out").rglob("*.json"))


def test_run_design_is_another_result_than_without(tmp_path: Path) -> None:
    """A design.py that fails loses the points that were given when it was not run."""
    folder = write_submission(tmp_path / "students" / "anna")
    (folder / "design.py").write_text("raise SystemExit('no design')\n")
    rubric, found = read_rubric(RUBRIC), find_submissions([tmp_path / "students"])
    for design, points in ((False, 10), (True, 0)):
        (result,) = campaign.run_campaign(
            rubric, found, tmp_path / "out", 1, design=design, border=BORDER
        )
        assert result["points"] == points


def test_a_folder_and_an_archive_of_one_name_are_both_graded(tmp_path: Path) -> None:
    """A student handed in twice; names that no terminal shows are readable."""
    write_submission(tmp_path / "anna")
    with zipfile.ZipFile(tmp_path / "anna.zip", "w") as archive:
        archive.writestr("src/main.adb", "x")
    write_submission(tmp_path / os.fsdecode(b"b\xff\n"))
    names = [submission.name for submission in find_submissions([tmp_path])]
    assert names == ["anna", "anna.zip", "b\\xff?"]


def test_a_password_is_a_sentence(tmp_path: Path) -> None:
    """As any archive that cannot be read."""
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr("src/main.adb", "x")
    file = tmp_path / "x.zip"
    content = bytearray(file.read_bytes())
    content[content.index(b"PK\1\2") + 8] |= 1
    file.write_bytes(content)
    (submission,) = find_submissions([file])
    with pytest.raises(SubmissionError, match="has a password"):
        read_files(submission, ("src",))


def test_hidden_seeds_need_the_secret_and_pulses_are_those_of_the_sentence() -> None:
    """Other secrets draw others; the drawn inputs are as many and as long as the sentence says."""
    assert hidden_seeds("a", "x", 3) == hidden_seeds("a", "x", 3)
    assert not set(hidden_seeds("a", "x", 3)) & set(hidden_seeds("b", "x", 3))
    pulses = Pulses("touch.1", 3, 7, 200, 2_400)
    for seed in range(200):
        drawn = pulses.draw(seed)
        edges = [instant for pulse in drawn for instant in pulse]
        assert edges == sorted(edges) and 200 <= edges[0] and edges[-1] <= 2_400
        assert all(end - begin >= 100 and begin % 20 == end % 20 == 0 for begin, end in drawn)
        assert pulses.filled("{count}", seed) == str(len(pulses.inputs((), seed)) // 2)
    with pytest.raises(ValueError, match="do not fit"):
        Pulses("touch.1", 3, 20, 200, 2_400)
