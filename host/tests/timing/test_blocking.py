# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What less urgent tasks may do before a released one goes on."""

from dataclasses import replace
from pathlib import Path

import pytest

from ravenbrick.project.robot import Task, read_robot
from ravenbrick.timing.bounds import Bound
from ravenbrick.timing.facts.facts import Facts, RequestedInterrupts
from ravenbrick.timing.kernel import Services
from ravenbrick.timing.task_set.scheduled_tasks import BlockingCause, blocking_cause, requests_of

ROOT = Path(__file__).resolve().parents[3]
SERVICES = Services(delay_until=0, resume=30, masking={"set_true": 100, "delay": 50})
MIDDLE = 5


def job(service: str, section_cycles: int = 0) -> Bound:
    """A job with a protected action of ceiling 6, shorter ones of higher ceilings, and a service
    that masks interrupts."""
    sections = ((2 * 6, section_cycles), *((2 * n, section_cycles // 2) for n in (7, 8)))
    return Bound("job", 1_000, 0, sections, frozenset({service}), {})


def jobs(*rows: tuple[int, Bound]) -> list[tuple[Task, Bound]]:
    """Tasks `t<priority>`."""
    task = read_robot(ROOT / "examples" / "vehicle").tasks[0]
    return [(replace(task, name=f"t{p}", priority=p), bound) for p, bound in rows]


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([(MIDDLE, job("delay")), (7, job("set_true", 900))], (0, "")),
        ([(MIDDLE, job("delay")), (2, job("set_true"))], (100, "t2")),
        ([(MIDDLE, job("delay")), (2, job("set_true", 500))], (500, "t2")),
        ([(MIDDLE, job("delay")), (2, job("set_true")), (1, job("delay"))], (180, "t2")),
        ([(MIDDLE, job("delay")), (2, job("delay", 500)), (1, job("set_true"))], (630, "t2")),
        ([(MIDDLE, job("delay")), (2, job("none", 500)), (1, job("none", 300))], (500, "t2")),
    ],
)
def test_one_task_is_in_an_action_and_each_other_may_mask_interrupts_before(
    rows: list[tuple[int, Bound]], expected: tuple[int, str]
) -> None:
    """A masked service of another task comes with the return to the one interrupted in it."""
    cause: BlockingCause = blocking_cause(MIDDLE, f"t{MIDDLE}", jobs(*rows), SERVICES)
    assert (cause.cycles, cause.task) == expected
    assert ("after others" in cause.kind) == (len(rows) == 3 and rows[2][1].reached != {"none"})


def test_the_rest_after_a_request_holds_the_critical_section_that_may_be_around_it() -> None:
    """At the task's own priority there is none, whatever it takes."""
    own = ((2 * MIDDLE, 900), (2 * MIDDLE + 2, 300), (2 * MIDDLE + 4, 200))
    asking = replace(
        job("nxt__display__update"), critical_sections=own, remaining=(400,),
        reached=frozenset({"nxt__display__update"}),
    )  # fmt: skip
    facts = Facts(None, "", requests=(RequestedInterrupts(5, "NXT.Display", 0, "shown"),))
    found = requests_of(facts, (), jobs((MIDDLE, asking), (2, job("none"))))
    assert {request.rest for request in found} == {((f"t{MIDDLE}", 400 + 300),)}
