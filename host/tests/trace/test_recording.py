# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files of recordings hold what was recorded, and files of earlier versions are read."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ravenbrick.clock import Clock
from ravenbrick.errors import UsageError
from ravenbrick.trace.recording import EVENT_TYPE, Picture, Recording, Screen, Signal, Stop, Thread

INSTANTS = np.arange(0, 5_000_000, 50_000, dtype=np.uint64)


def made() -> Recording:
    """Events with the largest fields there are; signals of which two share their instants."""
    rows = [
        (7, 1, 0xFFFF_FFFF, 0),
        (2**40, 3, 0, -1),
        (2**40, 4, 1, 2**62),
        (2**63, 13, 0, -(2**63)),
    ]
    values = np.linspace(-1.0, 1.0, len(INSTANTS))
    signals = {
        "battery.voltage": Signal(INSTANTS, values),
        "motor.B.angle": Signal(INSTANTS.copy(), 2 * values),
        "pin.PA17": Signal(INSTANTS[:3], values[:3]),
    }
    clock, stop = Clock(Fraction(48_054_857)), Stop("reached", 2**63, "end")
    return Recording("step", clock, stop, np.array(rows, EVENT_TYPE), signals, (), (), "0" * 64)


def assert_same(found: Recording, wanted: Recording) -> None:
    assert found.events.dtype == EVENT_TYPE
    assert found.events.tolist() == wanted.events.tolist()
    assert list(found.signals) == list(wanted.signals)
    for name, signal in wanted.signals.items():
        for column in ("cycles", "values"):
            read, written = getattr(found.signals[name], column), getattr(signal, column)
            assert read.dtype == written.dtype and read.tolist() == written.tolist()
    assert found.stop == wanted.stop


def rewritten(path: Path, **changed: Any) -> None:
    """The file with other arrays; None leaves one out."""
    with np.load(path) as arrays:
        kept = {name: arrays[name] for name in arrays.files}
    kept |= {name.replace("__", ":"): array for name, array in changed.items()}
    np.savez(path, **{name: array for name, array in kept.items() if array is not None})


def test_a_file_holds_the_recording_and_shared_instants_once(tmp_path: Path) -> None:
    made().save(tmp_path / "run.npz")
    assert_same(Recording.load(tmp_path / "run.npz"), made())
    with np.load(tmp_path / "run.npz") as arrays:
        names = [name for name in arrays.files if name.startswith("cycles:")]
    assert names == ["cycles:battery.voltage", "cycles:pin.PA17"]


def test_pictures_threads_and_screens_are_kept(tmp_path: Path) -> None:
    """Each of the display's pixels."""
    pixels = np.random.default_rng(1).integers(2, size=(64, 100)).astype(bool)
    recording = replace(
        made(),
        pictures=(Picture(7, ~pixels, ()), Picture(2**40, pixels, ("speed  12", ""))),
        threads=(Thread("worker", 1, 1024, 100), Thread("urgent", 5, 2048, 0)),
        screens=(Screen(9, ("ready",)),),
        overflows=("worker",),
        warnings=("port 2",),
    )
    recording.save(tmp_path / "run.npz")
    found = Recording.load(tmp_path / "run.npz")
    assert [(p.at_cycles, p.text) for p in found.pictures] == [(7, ()), (2**40, ("speed  12", ""))]
    assert [p.pixels.tolist() for p in found.pictures] == [(~pixels).tolist(), pixels.tolist()]
    for name in ("threads", "screens", "overflows", "warnings", "clock", "digest", "scenario"):
        assert getattr(found, name) == getattr(recording, name)


def test_a_recording_without_events_and_signals_is_kept(tmp_path: Path) -> None:
    clock, stop = Clock(Fraction(48_054_857)), Stop("fault", 0, "")
    empty = Recording("step", clock, stop, np.zeros(0, EVENT_TYPE), {}, (), (), "0" * 64)
    empty.save(tmp_path / "run.npz")
    assert_same(Recording.load(tmp_path / "run.npz"), empty)


def test_files_of_earlier_versions_are_read(tmp_path: Path) -> None:
    """Events as records, and no sharing of instants."""
    path, recording = tmp_path / "run.npz", made()
    recording.save(path)
    columns = {f"event__{name}": None for name in EVENT_TYPE.names or ()}
    cycles = {f"cycles__{name}": signal.cycles for name, signal in recording.signals.items()}
    with np.load(path) as arrays:
        head = str(arrays["head"]).replace('"instants"', '"other"')
    rewritten(path, events=recording.events, head=np.array(head), **columns, **cycles)
    assert_same(Recording.load(path), recording)


@pytest.mark.parametrize(
    "column", [np.zeros(3, np.uint8), np.zeros((4, 1), np.uint8), np.zeros(4), None]
)
def test_columns_that_do_not_fit_are_refused(tmp_path: Path, column: Any) -> None:
    made().save(tmp_path / "run.npz")
    rewritten(tmp_path / "run.npz", event__kind=column)
    with pytest.raises(UsageError, match="not a recording of a run, or damaged"):
        Recording.load(tmp_path / "run.npz")
