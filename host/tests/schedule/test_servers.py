# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Servers: published schedules and sizes, and random runs in unit steps below the bounds."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from verification.support.timing.unit_steps import Finished, Request, served

from ravenbrick.schedule import CriticalSection, Task, TaskSet, TaskSetError, response_time_bounds
from ravenbrick.schedule.task_models.servers import (
    KINDS,
    Kind,
    Server,
    largest_server_utilization,
    served_response_time_bounds,
)


def ends(finished: list[Finished], name: str = "job") -> list[int]:
    return [job.end for job in finished if job.task == name]


def requests(*rows: tuple[int, int]) -> list[Request]:
    return [Request("job", arrival, execution, 1) for arrival, execution in rows]


def test_largest_servers_of_the_textbook_s_exercises() -> None:
    """U = 1/6 and 2/7: 1/3 for sporadic and polling, 1/4 for deferrable servers (Buttazzo 2011,
    solutions 5.1 to 5.3), so C = 2 and 1.5 with T = 6."""
    task_set = TaskSet.of((1, 6), (2, 7))
    assert largest_server_utilization("sporadic", task_set) == pytest.approx(1 / 3)
    assert largest_server_utilization("polling", task_set) == pytest.approx(1 / 3)
    assert largest_server_utilization("deferrable", task_set) == pytest.approx(1 / 4)
    for kind, capacity in (("sporadic", 2), ("deferrable", Fraction(3, 2))):
        server = Server("server", kind, 6, capacity, 9)  # type: ignore[arg-type]
        found = response_time_bounds(TaskSet((server.task, *task_set)))
        assert all(each.meets_deadline for each in found)


def test_polling_server_serves_the_textbook_s_requests_at_its_polls() -> None:
    """Buttazzo 2011, figure 5.3: the request at 2 waits until the poll at 5, that at 12 for 15."""
    server = Server("server", "polling", 5, 2, 2)
    tasks = [Task("t1", 4, 1, 3), Task("t2", 6, 2, 1)]
    found, _ = served(server, tasks, requests((2, 2), (8, 1), (12, 2), (19, 1)), 30, {})
    assert ends(found) == [7, 11, 18, 22]


def test_sporadic_servers_return_what_the_textbook_says() -> None:
    """Buttazzo 2011, figures 5.17 (ends at 7, then 2 and 2 return at 14 and 18) and 5.18 (served at
    2 and at 10, where the budget returns; 2 and 2 return at 10 and 18)."""
    tasks = [Task("t1", 5, 1, 3), Task("t2", 15, 4, 1)]
    server = Server("server", "sporadic", 10, 5, 2)
    found, budget = served(server, tasks, requests((4, 2), (8, 2)), 13, {})
    assert ends(found) == [7, 10]
    assert [pair for pair in budget.returns if pair[1]] == [(14, 2), (18, 2)]
    tasks = [Task("t1", 10, 3, 2), Task("t2", 15, 4, 1)]
    server = Server("server", "sporadic", 8, 2, 3)
    found, budget = served(server, tasks, requests((2, 2), (6, 2)), 20, {})
    assert ends(found) == [4, 12]
    assert [pair for pair in budget.returns if pair[1]] == [(10, 2), (18, 2)]


def test_deferrable_server_of_liu_s_book_ends_its_request_at_6_5() -> None:
    """J. Liu, Real-Time Systems, figure 7-3: TDS = (3, 1), T1 = (2, 3.5, 1.5), T2 = (6.5, 0.5), and
    a request of 1.7 at 2.8, here in tenths."""
    server = Server("server", "deferrable", 30, 10, 3)
    tasks = [Task("t1", 35, 15, 2), Task("t2", 65, 5, 1)]
    found, _ = served(server, tasks, requests((28, 17)), 100, {"t1": 20})
    assert ends(found) == [65]


def random_system(seed: int, kind: Kind) -> tuple[Server, TaskSet]:
    """A server with one or two tasks beside one to three others."""
    dice = random.Random(f"{kind} {seed}")
    while True:
        period = dice.choice((5, 8, 10))
        capacity = dice.randint(1, period // 2)
        jobs = []
        for index in range(dice.randint(1, 2)):
            wcet = dice.randint(1, 4)
            apart = dice.randint(wcet * period // capacity + 1, 60)
            jobs.append(Task(f"s{index}", apart, wcet, 5 - index, 10**4, release="sporadic"))
        tasks = []
        for index in range(dice.randint(1, 3)):
            span = dice.choice((6, 9, 12, 20))
            tasks.append(Task(f"t{index}", span, dice.randint(1, span // 3), 2 * index))
        server = Server("server", kind, period, capacity, 2 * dice.randint(0, 3) + 1, tuple(jobs))
        task_set = TaskSet((server.task, *tasks))
        if all(found.meets_deadline for found in response_time_bounds(task_set)):
            bounds = served_response_time_bounds(task_set, server)
            if all(found.bound is not None for found in bounds):
                return server, task_set


def arrivals(server: Server, dice: random.Random, end: int) -> list[Request]:
    """Requests as early as they may be, or a little later, from an instant of each task."""
    found = []
    start = dice.randrange(30)
    for task in server.served:
        arrival = start + dice.randrange(3)
        while arrival < end:
            found.append(Request(task.name, arrival, int(task.wcet), task.priority))
            arrival += int(task.period) + (dice.random() < 0.3) * dice.randrange(5)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_no_run_with_a_server_exceeds_a_bound(kind: Kind) -> None:
    """Neither of what it serves nor of the other tasks; more than a third of them are reached."""
    reached = total = 0
    for seed in range(40):
        server, task_set = random_system(seed, kind)
        bounds = {found.task.name: found.bound for found in response_time_bounds(task_set)}
        for each in served_response_time_bounds(task_set, server):
            bounds[each.task.name] = each.bound
        worst = dict.fromkeys(bounds, 0)
        dice = random.Random(seed)
        others = [task for task in task_set if task.name != server.name]
        for _ in range(60):
            phases = {task.name: dice.randrange(int(task.period)) for task in others}
            jobs = arrivals(server, dice, 260)
            for job in served(server, others, jobs, 400, phases)[0]:
                worst[job.task] = max(worst[job.task], job.end - job.arrival)
        for name, time in worst.items():
            limit = bounds[name]
            assert limit is not None and time <= limit, (seed, name, time, limit)
            if name != server.name:
                reached += time == limit
                total += 1
    assert reached > 0.33 * total, (reached, total)


def test_a_server_without_room_has_no_bound() -> None:
    """More is asked for than its budget, or the budget is not used up in its period."""
    busy = Task("busy", 10, 3, 1, release="sporadic")
    server = Server("server", "polling", 10, 3, 2, (busy,))
    task_set = TaskSet((server.task, Task("t", 10, 4, 3)))
    assert served_response_time_bounds(task_set, server)[0].bound is None
    late = TaskSet((server.task, Task("t", 10, 8, 3)))
    assert not served_response_time_bounds(late, server)[0].meets_deadline


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "constant"}, "server.kind: is 'constant'; expected one of polling, "),
        ({"capacity": 11}, "server.capacity: is 11, more than the period"),
        (
            {"served": (Task("a", 9, 3, sections=(CriticalSection("q", 1),)),)},
            "a.sections: has no meaning for a task of a server",
        ),
    ],
)
def test_a_server_that_means_nothing_is_refused(change: dict[str, object], message: str) -> None:
    values = {"kind": "polling", "period": 10, "capacity": 3, "priority": 2} | change
    with pytest.raises(TaskSetError, match=message):
        Server("server", **values)  # type: ignore[arg-type]


def test_a_sporadic_server_that_can_be_blocked_is_refused() -> None:
    """Each piece of its budget would be blocked again."""
    users = [
        Task("above", 20, 2, 3, sections=(CriticalSection("q", 1),)),
        Task("below", 40, 4, 1, sections=(CriticalSection("q", 2),)),
    ]
    server = Server("server", "sporadic", 10, 3, 2, (Task("a", 50, 2, release="sporadic"),))
    with pytest.raises(TaskSetError, match=r"server\.kind: can be blocked for 2"):
        served_response_time_bounds(TaskSet((server.task, *users)), server)
