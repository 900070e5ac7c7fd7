# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What campaigns count, and when they write it."""

from __future__ import annotations

import itertools
import json
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from verification.fuzz import campaign, files
from verification.fuzz.campaign import added, fuzz_target
from verification.fuzz.files import FileReader

SECONDS, PATIENCE_S = 0.05, 60.0


def row(target: str, seconds: int, cases: int, findings: int) -> dict[str, Any]:
    """What a campaign says of a target."""
    return {"target": target, "seconds": seconds, "case_count": cases, "findings": findings}


def test_runs_of_a_target_are_counted_together() -> None:
    """Those of other targets stay, in the order of their names."""
    held = [row("b", 15, 1000, 0), row("c", 15, 7, 1)]
    assert added(row("b", 10, 100, 2), held) == [row("b", 25, 1100, 2), held[1]]
    assert added(row("a", 10, 100, 0), held) == [row("a", 10, 100, 0), *held]
    assert added(row("c", 10, 100, 0), held) == [held[0], row("c", 10, 100, 0)]


@pytest.mark.parametrize(("earlier_findings", "seconds"), [(0, 25), (1, 10)])
def test_each_target_is_written_as_it_ends_and_a_finding_ends_its_count(
    earlier_findings: int, seconds: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was found was corrected since; earlier cases of other targets still count."""
    results = tmp_path / "results.json"
    others = [row("b", 15, 9, 0), row("gone", 15, 7, 0)]
    results.write_text(json.dumps([row("a", 15, 9, earlier_findings), *others]))
    ran, expected = list[str](), {"a": seconds, "b": 25}

    def run(group: str, each_s: int, _seed: int) -> dict[str, Any]:
        end = time.monotonic() + PATIENCE_S
        while ran and (ran[0], expected[ran[0]]) not in _written(results):
            assert time.monotonic() < end, "the first target is not written"
            time.sleep(0.01)
        ran.append(group)
        return row(group, each_s, 100, 0)

    replaced = {
        "RESULTS": results, "INPUTS": {"a": "", "b": ""}, "_run": run, "build_image": bool,
        "targets": lambda _image: [],
        "ProcessPoolExecutor": lambda *_arguments, **_options: ThreadPoolExecutor(1),
    }  # fmt: skip
    for name, value in replaced.items():
        monkeypatch.setattr(campaign, name, value)
    assert len(campaign.campaign(10)) == 2
    assert _written(results) == sorted(expected.items())


def _written(results: Path) -> list[tuple[str, int]]:
    return [(one["target"], one["seconds"]) for one in json.loads(results.read_text())]


def test_a_target_has_its_time_of_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    """However little of the clock's that may be: here each look at it finds a second used."""
    used = itertools.count()
    monkeypatch.setattr(campaign, "processor_s", lambda: next(used))
    reader = FileReader("reads", "", [b"x"], Path.read_bytes, "x")
    try:
        assert fuzz_target(reader, 8, 1)["case_count"] == 8
    finally:
        reader.close()


def _works(_path: Path) -> None:
    while True:
        pass


def _waits(_path: Path) -> None:
    threading.Event().wait(PATIENCE_S)


@pytest.mark.parametrize(
    ("read", "number", "said"),
    [(_works, signal.SIGPROF, "of a processor"), (_waits, signal.SIGALRM, "by the clock")],
)
def test_a_reader_that_does_not_end_is_a_finding_and_is_ended(
    read: Callable[[Path], None], number: int, said: str,
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """One that waits uses no processor time."""
    limits = {number: SECONDS}
    timers = [(each, what, limits.get(each, PATIENCE_S)) for each, what, _ in files.TIMERS]
    monkeypatch.setattr(files, "TIMERS", timers)
    monkeypatch.setattr(campaign, "BUILD", tmp_path)
    reader = FileReader("endless", "", [b"x"], read, "x")
    try:
        assert fuzz_target(reader, 0, 1)["findings"] == 1
    finally:
        reader.close()
    assert said in capsys.readouterr().err
