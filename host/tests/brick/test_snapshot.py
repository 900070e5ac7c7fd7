# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Snapshot files: the run goes on as it did, and nothing but a whole snapshot is taken for one."""

from __future__ import annotations

import hashlib
import json
import random
import struct
from pathlib import Path

import pytest
import virtual_brick
from verification.support.bricks.nxt_firmware import CONFIGURATION, IMAGE

from ravenbrick.brick.snapshot import Snapshot, SnapshotError
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.stimuli import TimedInput

SAVED_CYCLES, END_CYCLES = 60_000_000, 100_000_000
INPUTS = (
    TimedInput(10_000_000, "touch.1", 1.0),
    TimedInput(80_000_000, "touch.1", 0.0),
    TimedInput(81_234_567, "battery.voltage", 7.25),
)


def image() -> ElfImage:
    if not IMAGE.exists():
        pytest.skip(f"{IMAGE} is absent: install the Debian package nxt-firmware")
    content = IMAGE.read_bytes()
    return ElfImage(IMAGE, content, "flash", 0x0010_0000, (), {}, bare=True)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A snapshot's file and the digest of the run that went on without a stop."""
    path = tmp_path_factory.mktemp("snapshot") / "kept" / "brick.rbs"
    configuration, loaded = json.dumps(CONFIGURATION), image()
    brick = virtual_brick.VirtualBrick.from_binary(configuration, loaded.content, loaded.entry)
    for timed in INPUTS:
        brick.schedule_input(timed.at_cycles, timed.name, timed.value)
    brick.run_until(SAVED_CYCLES)
    Snapshot.take(brick, configuration, loaded, INPUTS, ()).save(path)
    brick.run_until(END_CYCLES)
    return path, brick.trace_digest()


def test_a_restored_run_goes_on_as_the_one_that_was_saved(saved: tuple[Path, str]) -> None:
    path, digest = saved
    snapshot = Snapshot.load(path)
    brick = snapshot.restore(virtual_brick, image())
    assert brick.cycles == snapshot.cycles >= SAVED_CYCLES
    assert brick.read_memory(0x0020_0000, 0x1_0000) == snapshot.memory[:0x1_0000]
    brick.run_until(END_CYCLES)
    assert brick.trace_digest() == digest


def test_another_image_and_another_state_are_refused(saved: tuple[Path, str]) -> None:
    snapshot = Snapshot.load(saved[0])
    loaded = image()
    other = ElfImage(IMAGE, loaded.content + b"\0", "flash", loaded.entry, (), {}, bare=True)
    with pytest.raises(SnapshotError, match="not the image"):
        snapshot.restore(virtual_brick, other)
    changed = Snapshot(**{**vars(snapshot), "memory": bytes(len(snapshot.memory))})
    with pytest.raises(SnapshotError, match="comes to another state"):
        changed.restore(virtual_brick, loaded)
    unknown = Snapshot(**{**vars(snapshot), "inputs": (TimedInput(1, "horn", 1.0),)})
    with pytest.raises(SnapshotError, match="horn"):
        unknown.restore(virtual_brick, loaded)


ODD = (
    "null",
    "-1",
    "1e999",
    "NaN",
    "1" + 60 * "0",
    '"\\ud800"',
    "[[1]]",
    '[[-5,"touch.1",1]]',
    "{}",
)


@pytest.mark.parametrize("odd", ODD)
def test_fields_that_are_wrong_under_a_right_sum_are_refused(
    saved: tuple[Path, str], tmp_path: Path, odd: str
) -> None:
    content = saved[0].read_bytes()[:-32]
    begin = content.index(b"{")
    (length,) = struct.unpack_from("<I", content, begin - 4)
    fields = json.loads(content[begin : begin + length])
    made_up = tmp_path / "made-up.rbs"
    for name in fields:
        parts = [f"{json.dumps(k)}:{odd if k == name else json.dumps(fields[k])}" for k in fields]
        header = ("{" + ",".join(parts) + "}").encode()
        bad = content[: begin - 4] + struct.pack("<I", len(header)) + header
        bad += content[begin + length :]
        made_up.write_bytes(bad + hashlib.sha256(bad).digest())
        with pytest.raises(SnapshotError, match="made-up"):
            Snapshot.load(made_up)


def test_damaged_files_and_other_versions_are_refused(
    saved: tuple[Path, str], tmp_path: Path
) -> None:
    content, numbers = saved[0].read_bytes(), random.Random(1)
    damaged = tmp_path / "damaged.rbs"
    for trial in range(300):
        bad = bytearray(content)
        if trial % 3 == 0:
            del bad[numbers.randrange(len(bad)) :]
        else:
            bad[numbers.randrange(len(bad))] ^= 1 << numbers.randrange(8)
        if trial % 3 == 1:
            # What somebody wrote on purpose, with the right sum.
            bad[-32:] = hashlib.sha256(bad[:-32]).digest()
        damaged.write_bytes(bad)
        try:
            Snapshot.load(damaged)
        except SnapshotError as error:
            assert str(damaged) in str(error)
    assert content.startswith(b"RAVENBRICK SNAPSHOT\n\1\0\0\0")
    damaged.write_bytes(content.replace(b"\n\1\0\0\0", b"\n\2\0\0\0", 1))
    with pytest.raises(SnapshotError, match="version is 2"):
        Snapshot.load(damaged)
    with pytest.raises(SnapshotError, match="no such snapshot"):
        Snapshot.load(tmp_path / "absent.rbs")
