# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tasks made in Python: what means nothing is refused, and a longer task is longer in all of it."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from ravenbrick.schedule.model import CriticalSection, Frame, Task, TaskSet, TaskSetError
from ravenbrick.schedule.sensitivity import largest_section_scaling, scaled


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"release": "sometimes"}, r"release: is 'sometimes'; expected one of cyclic"),
        ({"phase": 1, "release": "sporadic"}, r"phase: has no meaning .* as 'sporadic'"),
        ({"period": 0}, r"period: is 0; expected more than 0"),
        ({"wcet": "soon"}, r"wcet: .*; write a time"),
        ({"phase": -1}, r"phase: is -1; expected at least 0"),
        ({"deadline": -2}, r"deadline: is -2; expected more than 0"),
        ({"deadline": 0}, r"deadline: is 0; expected more than 0"),
        ({"bcet": 5}, r"bcet: is 5, more than the execution time of a job"),
        ({"bcet": 3, "frames": (Frame(4, 9, 9), Frame(2, 9, 9))}, r"bcet: is 3, more than"),
        ({"wcet_high": 3}, r"wcet_high: is 3; expected at least 4"),
        ({"limits": ((0, 1),)}, r"limits: has a share or a window that is not more than 0"),
        ({"limits": ((1, 0),)}, r"limits: has a share or a window"),
        ({"limits": ((1, 1, -1),)}, r"limits: has a share or a window"),
        ({"limits": ((1, 1),), "frames": (Frame(4, 9, 9),)}, r"frames: does not go with 'limits'"),
        ({"sections": (CriticalSection("a", 3, 2),)}, r"'a' ends after 5 .* but the wcet is 4"),
        (
            {"sections": (CriticalSection("a", 2, 0), CriticalSection("b", 2, 1))},
            r"'b' begins inside 'a' and ends after it",
        ),
        (
            {"sections": (CriticalSection("a", 2, 1), CriticalSection("a", 2, 1))},
            r"'a' is taken while it is held",
        ),
        (
            {"sections": (CriticalSection("a", 3, 0), CriticalSection("a", 1, 2))},
            r"'a' is taken while it is held",
        ),
    ],
)
def test_a_task_that_means_nothing_is_refused(fields: dict[str, Any], sentence: str) -> None:
    """The task and its field are named."""
    whole: dict[str, Any] = {"name": "a_task", "period": 9, "wcet": 4} | fields
    with pytest.raises(TaskSetError, match=sentence):
        Task(**whole)


def test_what_just_means_something_is_taken() -> None:
    """As long as the execution time, the same object again at once, one inside another."""
    Task("a", 9, 4, bcet=4, wcet_high=4, phase=0)
    again = (CriticalSection("x", 2, 0), CriticalSection("x", 2, 2))
    inside = (CriticalSection("x", 4, 0), CriticalSection("y", 2, 1))
    for sections in (again, inside):
        assert Task("a", 9, 4, sections=sections).deadline == 9


def test_a_task_that_takes_longer_takes_longer_in_every_part() -> None:
    """By hand, three halves: frames, sections and the time of high criticality; not the least."""
    parts = (CriticalSection("x", 2, 1),)
    task = scaled(Task("a", 9, 4, sections=parts, bcet=3, wcet_high=6), Fraction(3, 2))
    assert (task.wcet, task.wcet_high, task.bcet) == (6, 9, 3)
    assert task.sections == (CriticalSection("x", 3, Fraction(3, 2)),)
    assert (task.period, task.deadline) == (9, 9)
    framed = Task("a", 9, 4, bcet=2, frames=(Frame(4, 9, 8), Frame(2, 10, 9)))
    halved = scaled(framed, Fraction(1, 2))
    assert halved.frames == (Frame(2, 9, 8), Frame(1, 10, 9))
    assert (halved.wcet, halved.bcet, halved.period, halved.deadline) == (2, 1, 9, 8)


def test_sections_on_an_object_that_no_task_uses_have_no_scaling() -> None:
    tasks = TaskSet((Task("t", 10, 4, 1, sections=(CriticalSection("used", 2),)),))
    assert largest_section_scaling(tasks, "used").factor == 4
    with pytest.raises(TaskSetError, match=r"no task has a section on 'other'; .* on: used"):
        largest_section_scaling(tasks, "other")
