# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said of stacks: that one suffices, may overflow, or that no bound of it was found."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from ravenbrick.cli.analyse import checked
from ravenbrick.errors import DeadlineError
from ravenbrick.timing.bounds import StackBound, deepest_of
from ravenbrick.timing.environment_stack import CALLED_AT_START
from ravenbrick.timing.results.stacks import stack_lines, stack_of, stacks_suffice

START = Path(__file__).resolve().parents[3] / "runtime" / "arm7tdmi" / "start.S"
ENOUGH = stack_of("control", 400, 1024)
SHALLOW = stack_of("display", 1040, 1024)
LOST = stack_of("logger", None, 1024, lost="panel.adb:64")
ELABORATION = stack_of("environment", None, 4096, gap="main: no target is known")


def _verdict(*stacks: dict[str, Any]) -> str:
    result = {
        "schedulable": True,
        "stacks": list(stacks),
        "stacks_suffice": stacks_suffice(stacks),
        "advice": stack_lines(stacks),
    }
    with pytest.raises(DeadlineError) as caught:
        checked(result)
    return str(caught.value)


def test_a_stack_of_which_no_bound_was_found_is_not_called_an_overflow() -> None:
    words = _verdict(ENOUGH, LOST)
    head = "a stack is not shown to suffice: no bound was found for the stack of logger"
    assert words.startswith(head) and "overflow" not in words
    assert "at panel.adb:64" in words and '[[never]] file = "panel.adb", line = 64' in words


def test_a_stack_that_may_overflow_comes_before_one_without_a_bound() -> None:
    words = _verdict(LOST, SHALLOW)
    assert words.startswith("a stack may overflow: display may need 1040 bytes of stack, and there")
    assert [stack["verdict"] for stack in (ENOUGH, LOST, SHALLOW)] == [
        "suffices",
        "no bound",
        "may overflow",
    ]


def test_a_stack_as_large_as_its_bound_suffices() -> None:
    verdicts = [stack_of("control", bound, 1024)["verdict"] for bound in (1024, 1028)]
    assert verdicts == ["suffices", "may overflow"]


def test_code_that_cannot_be_followed_is_named_with_the_fact_that_is_missing() -> None:
    assert stack_lines([ELABORATION]) == [
        "no bound was found for the stack of environment (4096 bytes): main: no target is known"
    ]


def test_the_stack_of_the_environment_task_without_a_bound_is_not_judged() -> None:
    assert stacks_suffice([ELABORATION]) is None and stacks_suffice([ELABORATION, ENOUGH]) is None
    assert stacks_suffice([ELABORATION, SHALLOW]) is False
    assert stacks_suffice([ELABORATION, LOST]) is False and stacks_suffice([ENOUGH]) is True


def test_an_environment_task_that_may_overflow_is_enlarged_by_the_linker() -> None:
    (words,) = stack_lines([stack_of("environment", 5000, 4096)])
    assert "enlarge the linker's symbol ravenbrick_environment_stack_size" in words


def test_the_deepest_stack_is_one_without_a_bound() -> None:
    lost = StackBound(None, "panel.adb:64")
    assert deepest_of([StackBound(8), lost, StackBound(376)]) == lost
    assert deepest_of([StackBound(8), StackBound(376), StackBound(0)]) == StackBound(376)


def test_all_that_the_start_up_calls_on_the_stack_of_the_environment_task_is_bounded() -> None:
    """Its own subroutines use no stack."""
    _, after = START.read_text().split("ravenbrick_environment_stack_top")
    way, _ = after.split(".size")
    called = re.findall(r"^\s+bl?\s+(\w+)", way, re.MULTILINE)
    assert tuple(name for name in called if name not in ("clear", "copy")) == CALLED_AT_START
