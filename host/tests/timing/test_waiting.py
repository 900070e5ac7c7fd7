# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A sporadic task that waits for a time inside its jobs, below an interrupt that is more urgent
than the alarm: neither is seen later than its bound."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from fractions import Fraction

import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import Subject, analysed, subject

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError
from ravenbrick.schedule.sensitivity import scaled
from ravenbrick.timing.analysis import Analysis
from ravenbrick.timing.observation.fact_counts import check_facts_of_run, fact_counts
from ravenbrick.timing.observation.observed import exceeded, observe
from ravenbrick.trace.task_set import check_shortest_interval

INTERRUPT = "TC1"
CYCLES_PER_COUNT = 2


@pytest.fixture(scope="module")
def program() -> Subject:
    return subject("waiting", "waiting_load")


@pytest.fixture(scope="module")
def analysis(program: Subject) -> Analysis:
    return analysed(program, program.facts)


@pytest.fixture(scope="module")
def noted(program: Subject) -> dict[str, int]:
    """What the program noted in the whole scenario, in cycles."""
    brick = VirtualTarget().prepare(program.robot, program.scenario, program.image)
    brick.run_until(MASTER_CLOCK.cycles_of_ms(program.scenario.duration_ms))
    found = {}
    for name in ("shortest_latency", "longest_latency", "longest_response"):
        word = brick.read_memory(program.image.symbols[name].address, 4)
        found[name] = CYCLES_PER_COUNT * int.from_bytes(word, "little")
    return found


def test_jobs_that_wait_inside_end_within_their_bounds(
    program: Subject, analysis: Analysis, noted: dict[str, int]
) -> None:
    recording = program.run()
    counts = fact_counts(program.robot, program.facts, program.image, (), recording)
    check_facts_of_run(counts, "the run")
    (suspension,) = (c for c in counts if "[[suspension]]" in c.fact)
    assert 480 < suspension.seen <= suspension.declared
    (fact,) = program.facts.suspensions
    wrong = replace(program.facts, suspensions=(replace(fact, longest_us=400),))
    counts = fact_counts(program.robot, wrong, program.image, (), recording)
    (excess,) = (count.excess for count in counts if count.excess)
    assert excess.startswith("declared 400 us, seen 48") and excess.endswith(" of server")
    seen = observe(program.robot, recording)
    for name in ("control", "server", "display"):
        bound = analysis.bounds[name].bound
        assert bound is not None and seen[name].response_cycles <= bound
    server = next(t for t in analysis.tasks if t.task.name == "server")
    assert server.suspension_cycles < noted["longest_response"] <= analysis.bounds["server"].bound
    assert seen["server"].jobs > 3_000 and exceeded(analysis, seen) == []


def test_bounds_of_much_shorter_jobs_that_wait_inside_are_no_longer(analysis: Analysis) -> None:
    """The search for margins goes there, below what the job waits."""
    shorter = analysis.changed_bounds(lambda task: scaled(task, Fraction(1, 64)))
    for name in ("control", "server", "display"):
        assert 0 < (shorter[name].bound or 0) < (analysis.bounds[name].bound or 0)


def test_own_times_leave_out_the_way_in_and_out_of_interrupts(
    program: Subject, analysis: Analysis
) -> None:
    """Each job of Display is interrupted several times and does the same work."""
    display = observe(program.robot, program.run())["display"]
    bound = next(t.job.cycles for t in analysis.tasks if t.task.name == "display")
    assert 0.998 * bound < display.execution_cycles <= bound


def test_a_wait_inside_is_charged_and_blocks_once_more(analysis: Analysis) -> None:
    server = next(t for t in analysis.tasks if t.task.name == "server")
    assert server.suspension_cycles == MASTER_CLOCK.cycles_of_us(500)
    scheduled = {task.name: task for task in analysis.task_set.tasks}
    assert scheduled["server"].wcet == server.job.cycles + server.suspension_cycles
    assert scheduled["server"].blocking == 2 * server.blocking.cycles
    inside = [name for name in scheduled if name.startswith("alarm inside")]
    assert inside == ["alarm inside server"]
    assert scheduled["alarm inside server"].wcet >= analysis.overheads.alarm


def test_without_a_fact_both_waits_release_the_task(program: Subject) -> None:
    """A job ends at each wait, and the run shows at most two releases in a period."""
    analysis = analysed(program, replace(program.facts, suspensions=()))
    server = next(t for t in analysis.tasks if t.task.name == "server")
    assert (server.releases, server.suspension_count) == (2, 0)
    assert "server, second release" in {task.name for task in analysis.task_set.tasks}
    recording = program.run()
    seen = observe(program.robot, recording)
    assert exceeded(analysis, seen) == [] and analysis.schedulable
    check_shortest_interval(program.robot, recording, "server", server.releases - 1)
    with pytest.raises(ProjectFileError, match=r"period_us.*is 5900"):
        check_shortest_interval(program.robot, recording, "server")


def test_an_urgent_interrupt_waits_for_masked_stretches_at_most_as_bounded(
    analysis: Analysis, noted: dict[str, int]
) -> None:
    """The program has no protected action that would delay it."""
    least, most = noted["shortest_latency"], noted["longest_latency"]
    interrupt = next(task for task in analysis.task_set.tasks if task.name == INTERRUPT)
    assert 100 < most - least <= interrupt.blocking
    bound = analysis.bounds[INTERRUPT].bound
    assert bound is not None and most <= bound
