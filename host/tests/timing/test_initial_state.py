# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is read of a program that has been elaborated."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.initial_state import attached_handlers, main_rests

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
