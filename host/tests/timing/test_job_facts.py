# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Facts about when jobs and interrupts come, counted in a run of the vehicle: those that are stated
hold, and wrong ones are told."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.schedule.quantity import Time
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.facts.counted_facts import points_text, turn_facts
from ravenbrick.timing.facts.facts import (
    SOURCE_NUMBERS,
    Facts,
    InterruptLoad,
    KindOfJob,
    OutsideLoad,
    Suspension,
    annotations_of,
    read_facts,
)
from ravenbrick.timing.facts.unmatched_facts import check_facts
from ravenbrick.timing.initial_state import elaborated
from ravenbrick.timing.observation.fact_counts import fact_counts, latest
from ravenbrick.timing.observation.job_facts import FactCount, request_counts, rest_counts
from ravenbrick.timing.observation.observed import check_job_kinds
from ravenbrick.timing.observation.outside_jobs import outside_count
from ravenbrick.timing.task_set.alarm import exact_cycles
from ravenbrick.timing.task_set.scheduled_tasks import phased_in_jobs
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import jobs_of

pytestmark = [NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK]


@cache
def run() -> tuple[Robot, Facts, ElfImage, Analysis, Recording]:
    """The vehicle's analysis and a second of its drive."""
    path = Workspace.of(VEHICLE).image("ram", "vehicle")
    if not path.is_file():
        pytest.skip("the vehicle is not built; 'ravenbrick build examples/vehicle' builds it")
    robot, image = read_robot(VEHICLE), read_image(path)
    facts = read_facts(robot).of_image(image)
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    short = replace(scenario, duration_ms=2_000)
    analysis = analyse(robot, image, elaborated(robot, scenario, image), facts)
    return robot, facts, image, analysis, VirtualTarget().run(robot, short, image)


def wrong_counts(facts: Facts, robot: Robot | None = None) -> list[FactCount]:
    """Facts that the run contradicts."""
    own, _, image, analysis, recording = run()
    counts = fact_counts(robot or own, facts, image, (), recording, analysis.requests)
    return [count for count in counts if count.excess]


def test_a_run_contradicts_no_stated_fact_about_jobs() -> None:
    robot, facts, _, analysis, recording = run()
    assert facts.together and analysis.requests and analysis.kinds
    assert wrong_counts(facts) == []
    check_job_kinds(robot, analysis, recording)


def test_a_release_away_from_the_common_one_is_told() -> None:
    robot, facts, _, _, _ = run()
    tasks = tuple(
        replace(task, period_us=300_000) if task.name == "display_task" else task
        for task in robot.tasks
    )
    (found,) = wrong_counts(facts, replace(robot, tasks=tasks))
    assert "[[common_release]]" in found.fact and found.excess.startswith("display_task")


def test_releases_of_jobs_so_long_behind_the_common_one_are_counted() -> None:
    robot, facts, _, _, _ = run()
    apart = replace(facts, together=facts.together - {"control_task"})
    assert wrong_counts(replace(apart, in_jobs={"control_task": 8_000})) == []
    (found,) = wrong_counts(replace(apart, in_jobs={"control_task": 9_000}))
    assert "[[common_release]]" in found.fact and found.excess.startswith("control_task")
    # A task that does not keep its period executes code outside of jobs: no release is judged.
    tasks = tuple(
        replace(task, period_us=3_000) if task.name == "control_task" else task
        for task in robot.tasks
    )
    setting_up = replace(robot, tasks=tasks)
    assert wrong_counts(replace(apart, in_jobs={"control_task": 9_000}), setting_up) == []


def test_a_task_meets_its_own_phase_and_that_of_others_whose_other_code_is_stated() -> None:
    _, facts, _, analysis, _ = run()
    slow = {"display_task": 1_000}
    apart = replace(facts, together=facts.together - set(slow), in_jobs=slow)
    code = OutsideLoad("display_task", 2_000, "a test")
    phase = exact_cycles(1_000)

    def seen_by(priority: int, own: str, facts: Facts) -> Time | None:
        timings = [
            replace(t, task=replace(t.task, priority=priority)) if t.task.name == own else t
            for t in analysis.tasks
        ]
        tasks = [analysis.task_set.task(t.task.name) for t in timings]
        tasks = [replace(task, phase=None) for task in tasks]
        (timing,) = (t for t in timings if t.task.name == own)
        met = phased_in_jobs(timing, timings, tasks, facts)
        return next(task.phase for task in met if task.name == "display_task")

    stated = replace(apart, outside_loads=(code,))
    assert seen_by(1, "display_task", apart) == phase
    assert seen_by(2, "control_task", apart) is None
    assert seen_by(2, "control_task", stated) is None
    assert seen_by(0, "control_task", apart) is None
    assert seen_by(0, "control_task", stated) == phase


@pytest.mark.parametrize(("gap_us", "is_told"), [(4_000, False), (2_000, True)])
def test_the_last_job_of_a_run_is_outside_only_if_it_comes_at_another_time(
    gap_us: int, is_told: bool
) -> None:
    """A run that ends in a long job says nothing of code outside of jobs."""
    task = next(task for task in run()[0].tasks if task.name == "control_task")
    facts = replace(run()[1], outside_loads=(OutsideLoad("control_task", 1_000, "a test"),))
    releases_us = [0, 4_000, 8_000, 8_000 + gap_us]
    release = np.array([MASTER_CLOCK.cycles_of_us(at) for at in releases_us], np.int64)
    own = np.array([100, 200, 300, 9_000], np.int64)
    counts = outside_count(facts, task, 500, release, own, since=0)
    assert [bool(count.excess) for count in counts] == [is_told, False]


def test_edges_are_as_many_as_the_motors_that_are_plugged_in(tmp_path: Path) -> None:
    text = (VEHICLE / "robot.toml").read_text()
    ports = [text.index(f"[ports.{port}]") for port in ("A", "B")]
    for name, motors in ((text, 3), (text[: ports[0]] + text[ports[1] :], 2)):
        (tmp_path / "robot.toml").write_text(name)
        found = read_facts(read_robot(tmp_path)).loads(SOURCE_NUMBERS["PIOA"])
        assert [load.at_most for load in found] == [3 * motors, motors]


def test_interrupts_after_the_job_that_requests_them_is_over_are_told() -> None:
    facts = run()[1]
    short = tuple(replace(request, lasts_us=100) for request in facts.requests)
    (found,) = wrong_counts(replace(facts, requests=short))
    assert "[[request]]" in found.fact and "after a job of display_task" in found.excess


def test_a_job_executes_no_more_after_its_request_than_the_bound_and_more_is_told() -> None:
    _, facts, _, analysis, recording = run()
    (found,) = rest_counts(analysis.requests, facts, recording, since=0)
    task, job = next((t.task, t.job) for t in analysis.tasks if t.task.name == "display_task")
    assert found.place == "display_task" and not found.excess
    (remaining,) = filter(None, job.remaining)
    section = job.longest_critical_section(2 * task.priority)
    assert found.declared == remaining + section > remaining
    assert 0 < found.seen <= found.declared < job.cycles / 4
    rest = tuple((name, found.seen - 1) for name, _ in analysis.requests[0].rest)
    wrong = [replace(request, rest=rest) for request in analysis.requests]
    (found,) = rest_counts(wrong, facts, recording, since=0)
    assert "display_task executes" in found.excess


def test_interrupts_that_the_elaboration_requests_are_no_excess() -> None:
    _, facts, _, analysis, recording = run()
    counts = request_counts(analysis.requests, facts, recording, since=0)
    assert counts and [count.excess for count in counts if count.excess] == []


def test_interrupts_that_come_too_densely_are_told() -> None:
    facts = run()[1]
    slow = tuple(
        replace(load, window_us=60) if load.late_us and load.window_us == 40 else load
        for load in facts.interrupts
    )
    (found,) = wrong_counts(replace(facts, interrupts=slow))
    assert "declared 1 each 60 us late by 40 us, seen late by" in found.excess


@pytest.mark.parametrize(("number", "told"), [(1, False), (2, True)])
def test_interrupts_after_releases_are_counted_from_the_second_one_on(
    number: int, told: bool
) -> None:
    """The first release is the start of the program."""
    robot, facts, image, _, recording = run()
    job = jobs_of(recording, recording.thread_index("display_task"))[number - 1]
    source, events = SOURCE_NUMBERS["SPI"], recording.events
    entered = (events["kind"] == int(EventKind.INTERRUPT_ENTERED)) & (events["subject"] == source)
    moved = events[entered][:4]
    moved["at_cycles"] = job.release_cycles + np.arange(4)
    mixed = np.concatenate([events[~entered], moved])
    alone = replace(recording, events=mixed[np.argsort(mixed["at_cycles"], kind="stable")])
    load = InterruptLoad(source, 3, 100_000, "a test", task="display_task")
    counts = fact_counts(robot, replace(facts, interrupts=(load,)), image, (), alone)
    (found,) = (count for count in counts if ', task = "display_task"' in count.fact)
    assert found.excess.startswith("declared 3, seen 4 ") == told
    assert told == found.excess.endswith(f", job {number} of display_task")


def test_a_transfer_of_a_peripheral_without_a_fact_is_told() -> None:
    robot, facts, image, _, recording = run()
    for at, excess in (
        ([40_000_000, 50_000_000], "declared 0, seen 2, the first at 0.83"),
        ([1_000], None),  # before all tasks have begun
    ):
        more = replace(recording, transfers={"SSC": np.array(at, np.int64)})
        counts = fact_counts(robot, facts, image, (), more)
        told = [count.excess for count in counts if 'peripheral = "SSC"' in count.fact]
        assert len(told) == (excess is not None) and all(t.startswith(str(excess)) for t in told)


def test_a_job_of_no_kind_is_told() -> None:
    robot, _, _, analysis, recording = run()
    few = ((SOURCE_NUMBERS["TWI"], 3),)
    kinds = tuple((replace(kind, most=few), most, turns) for kind, most, turns in analysis.kinds)
    with pytest.raises(ExecutionTimeError, match="of none of the kinds 'reset', 'exchange'"):
        check_job_kinds(robot, replace(analysis, kinds=kinds), recording)


def test_jobs_that_execute_what_their_turn_leaves_out_are_told() -> None:
    """Those of the vehicle's link take turns as stated, and not the other way round."""
    robot, facts, image, _, _ = run()
    (stated,) = facts.turns
    wrong = replace(facts, turns=(replace(stated, never=stated.never[::-1]),))
    points = turn_facts(image, facts)
    assert {fact.turn for fact in points} == {(0, stated.task), (1, stated.task)}
    scenario = replace(read_scenario(scenario_path(VEHICLE, "step"), robot), duration_ms=1_000)
    recording = VirtualTarget(flow_points=points_text(points)).run(robot, scenario, image)
    assert all(count.arrivals.size > 200 for count in recording.flow_counts)
    told = [
        [count.excess for count in fact_counts(robot, each, image, counted, recording)
         if "[[jobs_in_turn]]" in count.fact and count.excess]
        for each, counted in ((facts, points), (wrong, turn_facts(image, wrong)))
    ]  # fmt: skip
    assert told[0] == []
    assert told[1] and all("a job of turn " in text for text in told[1])
    assert any(", job " in text and "of coprocessor_task" in text for text in told[1])
    alone = replace(facts, together=facts.together - {stated.task})
    assert turn_facts(image, alone) == ()


def test_turns_make_bounds_below_closer_and_not_those_of_their_task() -> None:
    robot, facts, image, analysis, _ = run()
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    without = analyse(robot, image, elaborated(robot, scenario, image), replace(facts, turns=()))
    longer = {name: bound.bound for name, bound in without.bounds.items()}
    closer = {name: bound.bound for name, bound in analysis.bounds.items()}
    assert closer["coprocessor_task"] == longer["coprocessor_task"]
    assert (closer["control_task"] or 0) < (longer["control_task"] or 0)
    assert (closer["display_task"] or 0) <= (longer["display_task"] or 0)
    (mode,), (other,) = analysis.modes, without.modes
    least, most = (each.bounds["display_task"].bound for each in (mode, other))
    assert least is not None and most is not None and least < most


@pytest.mark.parametrize("waits", [False, True])
def test_a_job_takes_no_longer_than_its_longest_kind_unless_it_waits_inside(waits: bool) -> None:
    robot, facts, image, _, _ = run()
    never = annotations_of({"never": [{"symbol": "functional_step_instance"}]})
    kinds = (KindOfJob("control_task", "the vehicle stands", never, (), "a test"),)
    suspensions = (Suspension("control_task", 1, 10, "a test"),) if waits else ()
    scenario = read_scenario(scenario_path(VEHICLE, "step"), robot)
    without, found = (
        analyse(robot, image, elaborated(robot, scenario, image), replace(facts, **changed))
        for changed in ({"kinds": ()}, {"kinds": kinds, "suspensions": suspensions})
    )
    before, job = (
        next(timing.job for timing in each.tasks if timing.task.name == "control_task")
        for each in (without, found)
    )
    ((_, longest, _),) = found.kinds
    assert longest < before.cycles
    assert job.cycles == (before.cycles if waits else longest)
    assert job.path is not None and job.path["cycles"] == job.cycles


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('task = "control_task"', 'task = "controltask"', "robot.toml has no task 'controltask'"),
        ('"driving__start"', '"driving__begin"', "the image has no function 'driving__begin'"),
        ('"nxt__avr__inputs"', '"nxt__avr__input"', "the image has no function 'nxt__avr__input'"),
        ('"control_task"\nnever', '"display_task"\nnever', "no ..job_kind.. is of 'display_task'"),
    ],
)
def test_a_kind_of_job_that_matches_nothing_is_refused_with_its_line(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    image = run()[2]
    kind = '[[job_kind]]\ntask = "control_task"\nname = "a"\nnever = ["driving__start"]\n'
    kind += 'reason = "it has started"\n[[jobs_in_turn]]\ntask = "control_task"\n'
    kind += 'never = [[], ["nxt__avr__inputs"]]\nreason = "a test"\n'
    kind = f'[[common_release]]\ntasks = ["control_task"]\nreason = ""\n{kind}'
    (tmp_path / "robot.toml").write_text((VEHICLE / "robot.toml").read_text())
    for text in (kind, kind.replace(old, new)):
        (tmp_path / "timing.toml").write_text(f"schema_version = 1\n{text}")
        if text == kind:
            check_facts(read_facts(read_robot(tmp_path)), image)
    with pytest.raises(ProjectFileError, match=said) as refused:
        check_facts(read_facts(read_robot(tmp_path)), image)
    assert refused.value.line == text[: text.index(new)].count("\n") + 2


def test_turns_of_a_task_without_a_common_release_are_refused(tmp_path: Path) -> None:
    image = run()[2]
    text = 'schema_version = 1\n[[jobs_in_turn]]\ntask = "coprocessor_task"\nnever = [[], []]\n'
    (tmp_path / "robot.toml").write_text((VEHICLE / "robot.toml").read_text())
    (tmp_path / "timing.toml").write_text(f'{text}reason = "a test"\n')
    with pytest.raises(ProjectFileError, match=r"_task' has no ..common_release") as found:
        check_facts(read_facts(read_robot(tmp_path)), image)
    assert found.value.line == 3


@pytest.mark.parametrize("seed", range(20))
def test_lateness_is_the_least_with_which_no_window_has_too_many(seed: int) -> None:
    """Compared with all windows between two instants."""
    rng = np.random.default_rng(seed)
    at_most, period = int(rng.integers(1, 4)), 20.0
    at = np.sort(rng.integers(0, 500, 60))
    late, _ = latest(at, at_most, period)

    def holds(lateness: float) -> bool:
        # A window that holds both instants is longer than their distance.
        return all(
            j - i + 1 <= at_most * (np.floor((at[j] - at[i] + lateness) / period) + 1)
            for i in range(at.size)
            for j in range(i, at.size)
        )

    assert holds(late) and (late == 0 or not holds(late - 1))
