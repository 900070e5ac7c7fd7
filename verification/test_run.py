# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The run of the suites: what one does not end, what a row keeps, where data come from."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

from tools.docs.tables import suites_table
from verification import jobs, outside
from verification.benchmarks.figures import Figure
from verification.commands import Counts, NotRunError, function_of
from verification.job import answer
from verification.jobs import begin_order, grouped
from verification.outside import Data, Repository
from verification.run import Campaign, run_suites, suite_row
from verification.support.paths import ROOT
from verification.table import Need, Suite, read_suites

LAST = {
    "area": "cpu", "suite": "one", "date": "2026-01-02", "case_count": 9, "passed": 9,
    "excluded": [], "elapsed_s": 60.0, "processor_s": 90.0, "note": "",
}  # fmt: skip


def suite(name: str, function: str = "", **fields: Any) -> Suite:
    """An entry that calls a function of this file."""
    return Suite(
        "cpu", name, "own", "itself", "call", f"verification.test_run:{function}", **fields
    )


def pass_two() -> Counts:
    """A suite that passes."""
    print("a line on standard output is no answer")
    return Counts(2, 2)


def no_case() -> Counts:
    """A suite that finds nothing to judge."""
    return Counts(0, 0)


def die() -> Counts:
    """A suite whose process dies."""
    print("the reason", file=sys.stderr, flush=True)
    os._exit(3)


def refuse() -> Counts:
    """A suite that gives up."""
    raise SystemExit("the crate's program failed: no compiler")


def wrong() -> Counts:
    """A suite with a case that fails."""
    return Counts(2, 1, failures=["second: 1 is not 2"])


def silent() -> Counts:
    """A suite with a case that fails, without a reason."""
    return Counts(2, 1)


def hang() -> Counts:
    """A suite without an end."""
    time.sleep(600)
    return Counts(1, 1)


def ran(folder: Path, suites: list[Suite], monkeypatch: pytest.MonkeyPatch) -> Campaign:
    """The suites, run from a table of their own."""
    monkeypatch.setattr("tools.docs.tables.main", lambda arguments: 0)
    monkeypatch.setattr(jobs, "LOGS", folder / "logs")
    table = folder / "suites.toml"
    entries = [
        f'[[suite]]\narea = "cpu"\nname = "{s.name}"\ntruth = "own"\ncompared_with = "itself"\n'
        f'call = "{s.command}"\n'
        for s in suites
    ]
    table.write_text("\n".join(entries))
    return run_suites(table, suites, 2)


def test_a_suite_that_fails_in_any_way_does_not_end_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each has a row; the cause is shown, and the last lines of a process that died."""
    functions = ("die", "refuse", "no_case", "wrong", "silent", "pass_two")
    suites = [suite(name.replace("_", " "), name) for name in functions]
    found = ran(tmp_path, suites, monkeypatch)
    assert set(found.failed) == {"die", "refuse", "no case", "wrong", "silent"}
    assert found.failed["silent"] == "failed: 1 of 2"
    rows = {row["suite"]: row for row in json.loads((tmp_path / "results.json").read_text())}
    assert rows["pass two"]["passed"] == 2 and not rows["pass two"]["note"]
    assert "ended with 3 the reason" in rows["die"]["note"]
    assert "no case ran" in rows["no case"]["note"]
    shown = capsys.readouterr().err
    assert "the crate's program failed: no compiler" in shown
    assert "second: 1 is not 2" in shown
    assert "FAILED wrong: failed: second: 1 is not 2" in found.summary()


def test_a_suite_without_an_end_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After the limit, by its process group."""
    monkeypatch.setattr(jobs, "LIMIT_S", 1)
    found = ran(tmp_path, [suite("hang", "hang")], monkeypatch)
    assert "given up" in found.failed["hang"]


def test_a_row_is_kept_with_its_date_and_the_reason() -> None:
    """When data are absent, when nothing came out, when most tests are skipped."""
    entry = suite("one")
    absent = suite_row(entry, {"absent": "acats is absent: fetch it"}, LAST)
    assert (absent["date"], absent["passed"]) == ("2026-01-02", 9)
    assert absent["note"].endswith("not run: acats is absent: fetch it")
    assert "failed: no result" in suite_row(entry, {"error": "no result"}, LAST)["note"]
    skipped = {"count": 8, "reason": "no data"}
    counts = {"case_count": 9, "passed": 1, "excluded": [skipped], "failures": []}
    given = {"counts": counts, "judged": 1, "elapsed_s": 1.0, "processor_s": 1.0}
    tests = Suite("cpu", "one", "own", "itself", "pytest", ("verification",))
    row = suite_row(tests, given, LAST)
    assert row["passed"] == 9 and "only 1 cases can run: no data" in row["note"]
    fewer = {"case_count": 1, "passed": 1, "excluded": [], "failures": []}
    row = suite_row(tests, given | {"counts": fewer}, LAST)
    assert row["passed"] == 1 and not row["note"]  # tests went, none was skipped


def held() -> Counts:
    """A suite that does not run today and holds what it found on another day."""
    raise NotRunError("many hours", Counts(60, 58, [{"count": 2, "reason": "alike"}]), "2026-03-04")


def test_what_a_suite_holds_of_an_earlier_day_is_its_row_unless_a_later_run_was_whole() -> None:
    """With that day's date; the harness calls it kept."""
    entry = suite("one", "held")
    found = answer(entry)
    for last in (None, LAST):
        row = suite_row(entry, found, last)
        assert (row["date"], row["case_count"], row["passed"]) == ("2026-03-04", 60, 58)
        assert row["excluded"] == [{"count": 2, "reason": "alike"}]
        assert row["note"].endswith("not run: many hours") and row["elapsed_s"] == 0
        assert "| 60 | 58 | 2: alike | 2026-03-04, kept; " in suites_table([row], [entry])
    later = suite_row(entry, found, LAST | {"date": "2026-03-05"})
    assert (later["date"], later["passed"]) == ("2026-03-05", 9)


def test_a_part_of_the_benchmarks_that_cannot_run_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no figure, and is not one that passed."""
    monkeypatch.setattr("verification.run.BENCHMARKS", tmp_path / "suites.toml")
    found = ran(
        tmp_path, [suite("tab", needs=(Need(file="no/page", install="make it"),))], monkeypatch
    )
    assert found.kept == {"tab": "not run: no/page is absent: make it"}
    assert "0 passed, 0 failed, 1 not run" in found.summary()


def test_a_row_has_what_its_suite_measured() -> None:
    """As a field of its own, which rows of other suites lack."""
    for measured in ([], ["a robot moves after 2 s"]):
        counts = asdict(Counts(2, 2, measured=measured))
        given = {"counts": counts, "judged": 2, "elapsed_s": 1.0, "processor_s": 1.0}
        assert suite_row(suite("one"), given, None).get("measured", []) == measured


def test_suites_of_a_job_stay_together_and_long_ones_begin_first() -> None:
    """Those that use several processors before all others."""
    suites = [
        suite("short", minutes=1), suite("first", job="both"), suite("long", minutes=9),
        suite("second", job="both"), suite("wide", minutes=2, workers=2),
    ]  # fmt: skip
    ordered = begin_order(grouped(suites), lambda one: one.minutes)
    names = [[one.name for one in job] for job in ordered]
    assert names == [["wide"], ["long"], ["first", "second"], ["short"]]


@pytest.fixture
def published(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    """A repository at a commit behind which there is another one."""
    folder = tmp_path / "host" / "someone" / "data"
    (folder / "bench").mkdir(parents=True)
    (folder / "bench" / "numbers").write_text("1 2 3\n")
    (folder / "other").write_text("not needed\n")

    def git(*words: str) -> str:
        author = ("-c", "user.name=a", "-c", "user.email=a@example.org")
        command = ["git", "-C", str(folder), *author, *words]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()

    git("init", "--quiet")
    git("config", "uploadpack.allowFilter", "true")
    git("add", ".")
    git("commit", "--quiet", "-m", "first")
    commit = git("rev-parse", "HEAD")
    (folder / "bench" / "numbers").write_text("4 5 6\n")
    git("commit", "--quiet", "-am", "second")
    monkeypatch.setattr(outside, "HOST", f"file://{tmp_path / 'host'}")
    monkeypatch.setattr(outside, "FOLDER", tmp_path / "fetched")
    return Repository("someone/data", commit, "MIT", 1, ("bench",))


def test_data_are_fetched_at_their_commit_and_only_the_paths_named(published: Repository) -> None:
    """Until then the advice says where they are; then the variable's folder is found."""
    data = Data("numbers", "RAVENBRICK_NO_SUCH", (published,), "someone/data/bench")
    assert data.place() is None
    assert f"someone/data at {published.commit[:8]} (licence: MIT; 1 MB)" in data.advice()
    folder = outside.fetch(data)
    assert (folder / "numbers").read_text() == "1 2 3\n"
    assert not (folder.parent / "other").exists()
    assert data.place() == folder


def test_data_that_cannot_be_fetched_are_told_with_the_cause(published: Repository) -> None:
    """The repository is not there."""
    gone = Repository("someone/gone", published.commit, "MIT", 1)
    with pytest.raises(outside.FetchError, match="someone/gone: git fetch: "):
        outside.fetch(Data("numbers", "RAVENBRICK_NO_SUCH", (gone,)))


def test_programs_that_a_suite_compiles_are_not_fetched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even a complete checkout in the folder of fetched data does not count: a person names one."""
    monkeypatch.setattr(outside, "FOLDER", tmp_path)
    programs = Repository("someone/programs", "0" * 40, "MIT", 1)
    folder = tmp_path / "programs" / programs.name
    folder.mkdir(parents=True)
    (folder / ".fetched").write_text(programs.content)
    data = Data("programs", "RAVENBRICK_NO_SUCH", (programs,))
    assert data.place() == tmp_path / "programs"
    compiled = Data("programs", "RAVENBRICK_NO_SUCH", (programs,), compiled=True)
    assert compiled.place() is None
    assert "get someone/programs at 00000000" in compiled.advice()
    assert "verification.outside" not in compiled.advice()
    monkeypatch.setenv("RAVENBRICK_NO_SUCH", str(folder))
    assert compiled.place() == folder


def test_each_part_of_the_benchmarks_gives_figures() -> None:
    """As declared, which mypy checks."""
    for part in read_suites(ROOT / "verification" / "benchmarks" / "suites.toml"):
        given = get_type_hints(function_of(str(part.command)))["return"]
        assert Figure in get_args(given), part.name
