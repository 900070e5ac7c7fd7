# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is read of a program that has been elaborated."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.bounds import Call
from ravenbrick.timing.initial_state import (
    ENTRY_INITIALIZER,
    INITIALIZER,
    attached_handlers,
    main_rests,
    object_words,
    protected_objects,
)

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"
IMAGE = ElfImage(Path("robot.elf"), b"", "ram", 0, (), {})
READY, DELAYED, SUSPENDED, TERMINATED = 1, 2, 3, 5
NEVER = 2**63 - 2


def with_main(state: int, wake: int, *tasks: str) -> SimpleNamespace:
    """A brick whose main procedure is in this state."""
    names = ("environment", *tasks)
    common = {"base_priority": 1, "stack_size": 4096, "state": state, "address": 64}
    threads = [SimpleNamespace(name=name, **common) for name in names]
    memory = {(64 + 40, 8): wake.to_bytes(8, "little")}
    return SimpleNamespace(threads=lambda: threads, read_memory=lambda *place: memory[place])


def test_a_task_as_urgent_as_a_handler_is_refused_by_name() -> None:
    threads = [
        SimpleNamespace(name="main", base_priority=30),
        SimpleNamespace(name="siren", base_priority=31),
    ]
    brick = SimpleNamespace(threads=lambda: threads)
    with pytest.raises(ImageFileError, match=r"the task 'siren' .* 31, .* at most 30"):
        attached_handlers(brick, IMAGE)


@pytest.mark.parametrize(
    ("state", "wake", "rests"),
    [
        (TERMINATED, 0, True),
        (DELAYED, NEVER, True),
        (DELAYED, 21_024_000, False),
        (READY, NEVER, False),
        (SUSPENDED, NEVER, False),
    ],
)
def test_a_main_procedure_rests_when_it_has_ended_or_waits_for_ever(
    state: int, wake: int, rests: bool
) -> None:
    assert main_rests(with_main(state, wake)) == rests


def laid_out(**places: int) -> Any:
    """An image with objects of 16 bytes, and two words at 0x2000."""
    symbols = {name: SimpleNamespace(address=at, size=16) for name, at in places.items()}
    record = (0x2100).to_bytes(4, "little") + (0x2200).to_bytes(4, "little")
    return SimpleNamespace(
        path=Path("robot.elf"), symbols=symbols,
        bytes_at=lambda at, size: record[:size] if at == 0x2000 else b"",
    )  # fmt: skip


def test_protected_objects_are_those_that_the_program_sets_up() -> None:
    """Also through the linker's veneers; what the run-time calls for itself is no further one."""
    image = laid_out(gate=0x1000, counter=0x1100, highest=0x1200)
    found = protected_objects(
        image,
        [
            Call(f"__{ENTRY_INITIALIZER}_from_thumb", "adainit", (0x1100, 9, 0, 0x2000)),
            Call(INITIALIZER, f"__{ENTRY_INITIALIZER}_from_arm", (0x1100, 9, 0, 77)),
            Call(INITIALIZER, ENTRY_INITIALIZER, (0x1100, 9, 0, 77)),
            Call(f"__{INITIALIZER}_from_arm", "adainit", (0x1000, 5, 0, 77)),
            Call(INITIALIZER, "adainit", (0x1200, 0xFFFF_FFFF, 0, 77)),
        ],
    )
    assert [(one.name, one.ceiling, one.code) for one in found] == [
        ("gate", 5, 0), ("counter", 9, 0x2000), ("highest", 30, 0),
    ]  # fmt: skip
    # Twice the ceiling and one more; the span is 0 only where interrupts are masked.
    words = {word["address"]: word["value"] for word in object_words(found)}
    assert words == {
        0x1000: 11, 0x1004: 11, 0x1100: 19, 0x1104: 19, 0x1114: 0x2000,
        0x2000: 0x2100, 0x2004: 0x2200, 0x1200: 61, 0x1204: 61,
    }  # fmt: skip


def test_a_ceiling_that_is_not_known_before_the_run_is_refused_with_its_place() -> None:
    with pytest.raises(ImageFileError, match="set up in maker has no static ceiling"):
        protected_objects(laid_out(), [Call(INITIALIZER, "maker", (0x1000, None, 0, None))])
