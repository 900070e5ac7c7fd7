# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from verification.commands import Counts, NoResultError, NotRunError
from verification.mutation import campaign
from verification.mutation.campaign import Judge, Outcomes, judged, score
from verification.mutation.mutants import mutants_of, ranked
from verification.mutation.rooms import ROOMS, Room
from verification.mutation.scratch import Scratch
from verification.support.paths import ROOT

TEXTS = {
    "a.rs": '/// a < b\nfn f() -> u32 {\n    if a < b { "a < b" } else { 1_000 }\n}\n',
    "a.adb": '--  a < b\n   if A < B then\n      Put ("a < b");\n   end if;\n',
    "a.py": '# a < b\ndef f():\n    """a < b"""\n    if a < b:\n        call(a)\n',
    "a.ts": "// a < b\nif (a < b) {\n  call(`a < b`);\n}\n",
}


@pytest.mark.parametrize("file", TEXTS)
def test_code_is_changed_and_comments_and_texts_are_not(file: str) -> None:
    """A comparison becomes another, its condition is negated; the other places stay."""
    source = TEXTS[file]
    made = [mutant.applied(source) for mutant in mutants_of(file, source)]
    assert len(set(made)) == len(made) >= 2
    assert any("<= " in text for text in made)
    assert any("!(" in text or "not (" in text for text in made)
    for text in made:
        assert text.count("a < b") >= source.count("a < b") - 1
        assert text.splitlines()[0] == source.splitlines()[0]


def test_unit_tests_beside_the_code_are_not_changed() -> None:
    """Those of the same file; the name of a file with tests ends nothing."""
    attribute = "#[cfg(test)]\n"
    tests = f"{attribute}#[allow(missing_docs)]\nmod c {{\n    let d = 2;\n}}\n"
    source = f"{attribute}mod a;\nlet b = 1;\n{tests}"
    assert [mutant.line for mutant in mutants_of("a.rs", source)] == [3]


def test_a_change_elsewhere_keeps_order_and_names_of_the_mutants() -> None:
    """Lines may move; another seed draws others."""
    one, two = (
        [m.key for m in ranked(mutants_of("a.py", f"{head}x = a + b - c * 3\n"), 1)]
        for head in ("", "import os\n\n\n")
    )
    assert one == two
    assert sorted(one) == sorted(m.key for m in mutants_of("a.py", "x = a + b - c * 3\n"))
    assert one != [m.key for m in ranked(mutants_of("a.py", "x = a + b - c * 3\n"), 2)]


def test_every_room_has_sources_and_tests() -> None:
    """Each has more mutants than a sample, and a folder of tests."""
    for room in ROOMS.values():
        assert len(room.mutants(ROOT)) > 2 * campaign.SAMPLE, room.name
        assert room.files(ROOT, room.tests), room.name


class Copy:
    """In place of a scratch copy: `build` refuses 'bad', `test` notices the first constant."""

    def __init__(self, tree: Path) -> None:
        self.tree, self.folder, self.log, self.runs = tree, tree / "made", tree / "log", 0
        self.log.write_text("1 passed, 2 skipped\n")
        self.commands: list[str] = []

    def said(self) -> str:
        """Of the last run."""
        return ""

    def __enter__(self) -> Copy:
        return self

    def __exit__(self, *_error: object) -> None:
        pass

    def run(self, command: str, limit_s: float) -> tuple[bool, float]:
        """As the text of the source says."""
        self.runs += 1
        self.commands.append(command)
        text = (self.tree / "src" / "a.py").read_text()
        if command == "build":
            return "9 + 8" in text, 1.0
        return "noticed = 1\n" in text, 1.0


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Room:
    """A tree with one source and one test."""
    for name in ("src/a.py", "tests/test_a.py"):
        (tmp_path / name).parent.mkdir()
    (tmp_path / "src" / "a.py").write_text("noticed = 1\nunnoticed = 2\nrefused = 9 + 8\n")
    (tmp_path / "tests" / "test_a.py").write_text("")
    monkeypatch.setattr(campaign, "ROOT", tmp_path)
    monkeypatch.setattr(campaign, "OUTCOMES", tmp_path / "outcomes")
    return Room("made", "src", "tests", "build", "test")


def test_a_campaign_goes_on_and_judges_survivors_again_when_tests_changed(
    room: Room, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Refused mutants do not count; what is known is not run again."""
    copy = Copy(tmp_path)
    monkeypatch.setattr(campaign, "Scratch", lambda _name: copy)
    first = dict(judged(room, 60, 1, end=float("inf")))
    assert sorted(first.values()) == ["killed", "survived"]
    assert "refused = 9 + 8" in (tmp_path / "src" / "a.py").read_text()
    runs = copy.runs
    assert dict(judged(room, 60, 1, end=0.0)) == first and copy.runs == runs
    (tmp_path / "tests" / "__pycache__").mkdir()
    (tmp_path / "tests" / "__pycache__" / "test_a.pyc").write_text("compiled")
    again = Outcomes(room)
    assert {mutant: again.of(mutant) for mutant in first} == first
    (tmp_path / "tests" / "test_a.py").write_text("assert True\n")
    outcomes = Outcomes(room)
    assert [outcomes.of(mutant) for mutant in first] == [
        None if outcome == "survived" else outcome for outcome in first.values()
    ]


def test_a_room_of_python_is_copied_with_the_vehicle_built(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An image older than its sources fails tests that nothing is wrong with."""
    steps = []

    def copied(_name: str) -> Scratch:
        steps.append("copied")
        raise NotRunError("no more is needed")

    monkeypatch.setattr(campaign, "build_example", steps.append)
    monkeypatch.setattr(campaign, "Scratch", copied)
    with pytest.raises(NotRunError):
        list(judged(replace(room, executed=True), 60, 1, end=float("inf")))
    assert steps == ["vehicle", "copied"]


def test_near_tests_kill_and_other_tests_judge_again_what_survives_them(
    room: Room, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file that shares words with the source comes first; 0 means all tests of the room."""
    source = "noticed = 1\nunnoticed = 2\nrefused = 9 + 8\n\n\ndef rare(): ...\n"
    (tmp_path / "src" / "a.py").write_text(source)
    for name, text in (("x", "common"), ("y", "rare()"), ("z", "common")):
        (tmp_path / "tests" / f"test_{name}.py").write_text(f"{text}\n")
    near = replace(room, test_files="test --files")
    nearest = near.tests_near(tmp_path, "src/a.py", 1)
    assert nearest == [tmp_path / "tests" / "test_y.py"]
    assert near.tests_near(tmp_path, "src/a.py", 0) == []
    copy = Copy(tmp_path)
    monkeypatch.setattr(campaign, "Scratch", lambda _name: copy)
    first = dict(judged(near, 60, 1, float("inf"), near=1))
    assert set(copy.commands) == {"build", f"test --files {nearest[0]}"}
    assert sorted(first.values()) == ["killed", "survived"]
    other_tests = {mutant: None if o == "survived" else o for mutant, o in first.items()}
    assert {mutant: Outcomes(near, 1).of(mutant) for mutant in first} == first
    assert {mutant: Outcomes(near).of(mutant) for mutant in first} == other_tests
    (tmp_path / "tests" / "test_x.py").write_text("common, otherwise\n")
    assert {mutant: Outcomes(near, 1).of(mutant) for mutant in first} == first
    nearest[0].write_text("rare() == 1\n")
    assert {mutant: Outcomes(near, 1).of(mutant) for mutant in first} == other_tests


def test_what_all_tests_let_survive_is_not_run_with_the_nearest(
    room: Room, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are among them."""
    copy = Copy(tmp_path)
    monkeypatch.setattr(campaign, "Scratch", lambda _name: copy)
    first = dict(judged(room, 60, 1, float("inf")))
    near = Outcomes(replace(room, test_files="test --files"), 1)
    assert {mutant: near.of(mutant) for mutant in first} == first


def test_a_file_of_tests_is_near_to_what_its_programs_are_about(tmp_path: Path) -> None:
    """A room in Ada: its tests are programs; the specification has words of its own."""
    files = {
        "kernel/threads.ads": "--  The queue of those that are ready\n",
        "kernel/threads.adb": "procedure Yield is null;\n",
        "tests/test_a.py": 'run("other")\n',
        "tests/test_b.py": 'run("turns")\n',
        "tests/test_c.py": 'run("other", "turns")\n',
        "tests/programs/other/other.adb": "Clock;\n",
        "tests/programs/turns/turns.adb": "Queues; Yield_Now;\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    room = Room("made", "kernel", "tests", "build", "test", "test --files")
    (near,) = room.tests_near(tmp_path, "kernel/threads.adb", 1)
    assert near.name == "test_b.py"
    assert [path.name for path in room.read_by(near)] == ["test_b.py", "turns.adb"]


def test_files_of_tests_pass_unchanged_once_before_they_judge(room: Room, tmp_path: Path) -> None:
    """Two mutants that share the nearest file: build, file, then build and file for each."""
    copy = Copy(tmp_path)
    near = replace(room, test_files="test --files")
    judge = Judge(near, copy, 1)  # type: ignore[arg-type]
    for mutant in near.mutants(tmp_path)[:2]:
        judge.outcome(mutant)
    file = f"test --files {tmp_path / 'tests' / 'test_a.py'}"
    assert copy.commands == ["build", file, "build", file, "build", file]


def test_a_room_whose_tests_fail_unchanged_is_not_judged(room: Room, tmp_path: Path) -> None:
    """The command and its last lines are named."""
    (tmp_path / "src" / "a.py").write_text("noticed = 7\nrefused = 9 + 8\n")
    copy = Copy(tmp_path)
    copy.log.write_text("1 failed\n")
    with pytest.raises(Exception, match="made, nothing changed: test fails\n1 failed"):
        Judge(room, copy).outcome(room.mutants(tmp_path)[0])  # type: ignore[arg-type]


SKIPPED = "SKIPPED [3] test_a.py:1: the cross toolchain is not installed"
LONG = "SKIPPED [3] test_b.py:1: an hour: make conformance, or RAVENBRICK_LONG=1"


@pytest.mark.parametrize(
    "said",
    [
        f"{SKIPPED}\n3 skipped",
        f"{LONG}\n{SKIPPED}\n6 skipped",
        "test result: ok. 0 passed; 2 ignored",
    ],
)
def test_tests_that_are_all_skipped_judge_no_mutant(room: Room, tmp_path: Path, said: str) -> None:
    """The reason is among the last lines."""
    copy = Copy(tmp_path)
    copy.log.write_text(f"{said}\n")
    with pytest.raises(
        NoResultError, match="test: no test passes, so it judges nothing\n"
    ) as error:
        Judge(room, copy).outcome(room.mutants(tmp_path)[0])  # type: ignore[arg-type]
    assert str(error.value).endswith(said)


@pytest.mark.parametrize(
    "said", [LONG, f"{SKIPPED}\n2 passed, 3 skipped", "ok. 10 passed; 0 failed"]
)
def test_some_tests_may_be_skipped_and_long_ones_all(room: Room, tmp_path: Path, said: str) -> None:
    """A file of long tests is no fault; nor is one test that lacks a program."""
    copy = Copy(tmp_path)
    copy.log.write_text(f"{said}\n")
    judge = Judge(room, copy)  # type: ignore[arg-type]
    outcomes = {judge.outcome(mutant) for mutant in room.mutants(tmp_path)}
    assert outcomes == {"killed", "survived", "refused"}


def test_the_score_leaves_equivalent_mutants_out() -> None:
    """By hand: 8 of 10 without the two that change nothing, then 17 of 20."""
    rows: list[dict[str, Any]] = [
        {"sampled": 12, "killed": 8, "equivalent": 2},
        {"sampled": 10, "killed": 9, "equivalent": 0},
    ]
    assert score(rows[:1]) == pytest.approx(0.8)
    assert score(rows) == pytest.approx(0.85)


@pytest.mark.parametrize("reason", ["a matter of taste", ""])
def test_a_room_that_is_not_measured_now_holds_what_was_with_its_date(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reason: str
) -> None:
    """Killed ones have passed, equivalent ones are left out; a survivor needs a reason."""
    monkeypatch.delenv("RAVENBRICK_MUTATION_MINUTES", raising=False)
    monkeypatch.setattr(campaign, "RESULTS", tmp_path / "results.json")
    with pytest.raises(NotRunError, match="many hours") as nothing:
        campaign.suite("plant")
    assert nothing.value.held is None
    survivors = [
        {"mutant": "a => b", "verdict": "equivalent", "reason": "alike"},
        {"mutant": "c => d", "verdict": "open", "reason": reason},
    ]
    row = {"room": "plant", "date": "2026-03-04", "seed": 7, "sampled": 20, "killed": 18}
    campaign.RESULTS.write_text(json.dumps([row | {"equivalent": 1, "survivors": survivors}]))
    with pytest.raises(NotRunError) as error:
        campaign.suite("plant")
    assert error.value.date == "2026-03-04"
    open_ones = [{"count": 1, "reason": "survive, with a verdict in verdicts.toml"}]
    assert error.value.held == Counts(
        20, 18, [{"count": 1, "reason": "equivalent"}, *(open_ones if reason else [])],
        [] if reason else ["c => d"],
        ["drawn by seed 7, 95% of those not equivalent are killed"],
    )  # fmt: skip


@pytest.mark.isolated
def test_a_command_in_the_scratch_copy_writes_nowhere_else_and_ends_in_time() -> None:
    """Not into the tree, and no child survives the time limit."""
    mark = ROOT / "build" / "written-by-a-mutant"
    with Scratch("test") as scratch:
        # The grader's sandbox hands on no PYTHONPATH, and sees no other tree.
        found = f"import ravenbrick; assert ravenbrick.__file__.startswith('{scratch.tree}')"
        assert scratch.run(f'env -u PYTHONPATH .venv/bin/python -c "{found}"', 60)[0]
        assert not scratch.run("touch .venv/bin/python", 60)[0]
        assert scratch.run("touch README.md", 60)[0]
        passed, needed_s = scratch.run("! for n in {1..200000}; do :; done", 60)
        assert not passed and 0.01 < needed_s < 60
        assert not scratch.run(f"touch {mark}", 60)[0]
        passed, needed_s = scratch.run("setsid sleep 1000 & sleep 1000", 0.1)
        assert not passed and needed_s < 60 and "not ended in time" in scratch.said()
        assert not scratch.run("while :; do :; done", 1)[0]
    assert not mark.exists() and not scratch.tree.exists()
