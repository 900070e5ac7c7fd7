# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Facts that the run contradicts: each is named with what was declared and seen, when and where."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.paths import ROOT
from verification.support.recordings import preempted
from verification.support.timing.programs import HERE, Subject, analysed, subject

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError
from ravenbrick.project.robot import read_robot
from ravenbrick.timing.facts.counted_facts import points_text
from ravenbrick.timing.facts.facts import read_facts
from ravenbrick.timing.observation import fact_counts as fact_counts_of
from ravenbrick.timing.observation.fact_counts import (
    check_facts_of_run,
    fact_counts,
    left_modes,
)
from ravenbrick.timing.observation.job_facts import TOLERANCE_CYCLES, FactCount, have_deadline
from ravenbrick.timing.observation.observed import exceeded, observe, outside_counts
from ravenbrick.timing.results.result import result_of
from ravenbrick.trace.flow_counts import ARRIVAL, NO_THREAD
from ravenbrick.trace.recording import EventKind, Recording
from ravenbrick.trace.schedule import jobs_of
from ravenbrick.trace.task_set import check_shortest_interval

CLOCK_HZ = int(MASTER_CLOCK.hertz)
OUTSIDE = """[[outside]]
symbol = "workers__seldom"
task = "control"
period_us = 1_000
reason = ""

"""


FLOW = """[[flow]]
symbol = "workers__sum"
lines = ["workers.adb:46"]
at_most = {at_most}
reason = ""

"""


def test_what_happens_in_a_handler_is_said_to_be_there() -> None:
    """Not in the job that it interrupts, and no longer after it."""
    run = fact_counts_of._Run(read_robot(ROOT / "examples" / "blank"), preempted())
    places = [run.words(1, at).partition(", ")[2] for at in (2_050, 2_500, 100_100, 100_500)]
    assert places == ["in the handler of TC0", "job 1 of urgent", "in the handler of TC0",
                      "job 2 of urgent"]  # fmt: skip


@cache
def program() -> Subject:
    found = subject("counted", "counted_load")
    return replace(found, scenario=replace(found.scenario, duration_ms=1_000))


def changed(folder: Path, old: str, new: str) -> Subject:
    """The program beside another timing.toml."""
    text = (HERE / "counted" / "timing.toml").read_text()
    assert old in text
    shutil.copy(HERE / "counted" / "robot.toml", folder)
    (folder / "timing.toml").write_text(text.replace(old, new, 1))
    robot = read_robot(folder)
    return replace(program(), robot=robot, facts=read_facts(robot).of_image(program().image))


def counted(found: Subject, engine: str = "fast") -> tuple[list[FactCount], Recording]:
    analysis = analysed(found, found.facts)
    target = VirtualTarget(settings={"engine": engine}, flow_points=points_text(analysis.counted))
    recording = target.run(found.robot, found.scenario, found.image)
    counts = fact_counts(found.robot, found.facts, found.image, analysis.counted, recording)
    return counts, recording


@cache
def as_it_is() -> tuple[list[FactCount], Recording]:
    return counted(program())


def test_facts_that_hold_are_counted_and_the_run_stays_the_same() -> None:
    counts, recording = as_it_is()
    assert [count.excess for count in counts if count.excess] == []
    seen = {count.fact.split("]] ")[1].split(",")[0]: count.seen for count in counts}
    assert seen['symbol = "workers__sum"'] == 40
    plain = VirtualTarget().run(program().robot, program().scenario, program().image)
    assert plain.digest == recording.digest


def test_a_run_of_hours_counts_nothing() -> None:
    found = program()
    points = points_text(analysed(found, found.facts).counted)
    target = VirtualTarget(flow_points=points)
    bricks = [
        chosen.prepare(found.robot, found.scenario, found.image)
        for chosen in (target, target.without_counts())
    ]
    assert [len(json.loads(brick.flow_counts())) for brick in bricks] == [
        len(json.loads(points)),
        0,
    ]


@pytest.mark.parametrize("engine", ["blocks", "reference"])
def test_all_engines_count_the_same(engine: str) -> None:
    counts, recording = counted(program(), engine)
    assert (counts, recording.digest) == (as_it_is()[0], as_it_is()[1].digest)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("iterations = 40", "iterations = 5", "declared 5, seen 40 at "),
        ("iterations = 40", 'within = "workers__controlTKB"\niterations = 5',
         "declared 5, seen 40 at "),
        ("iterations = 40", 'within = "*__controlTKB"\niterations = 5',
         "declared 5, seen 40 at "),
        (', "workers__half"', "", "seen the target workers__half at "),
        ("[[loop]]", '[[never]]\nsymbol = "workers__seldom"\nreason = ""\n\n[[loop]]',
         "declared 0, seen 1 executions at "),
        ("[[loop]]", OUTSIDE + "[[loop]]",
         "declared 0, seen 1 executions in a job at "),
        ("[[loop]]", FLOW.format(at_most=39) + "[[loop]]",
         "declared 39, seen 40 executions in one call at "),
    ],
)  # fmt: skip
def test_a_wrong_fact_is_told_with_the_job_and_the_line(
    old: str, new: str, said: str, tmp_path: Path
) -> None:
    counts, _ = counted(changed(tmp_path, old, new))
    (excess,) = (count.excess for count in counts if count.excess)
    assert excess.startswith(said)
    assert ", job " in excess and " of control, workers.adb:" in excess


def test_lines_are_counted_in_each_call_of_their_function_anew(tmp_path: Path) -> None:
    counts, _ = counted(changed(tmp_path, "[[loop]]", FLOW.format(at_most=40) + "[[loop]]"))
    (flow,) = (count for count in counts if "[[flow]]" in count.fact)
    assert (flow.place, flow.declared, flow.seen, flow.excess) == ("workers.adb:46", 40, 40, "")


def test_a_wrong_target_is_kept_when_it_is_first_and_last_called(tmp_path: Path) -> None:
    """So one that the elaboration calls as well is told of a job."""
    wrong = changed(tmp_path, ', "workers__half"', "")
    counts, recording = counted(wrong)
    (place,) = (at for at, count in enumerate(counts) if count.excess)
    found = recording.flow_counts[place]
    assert found.most > 2 and found.arrivals.size == 2
    first, last = found.arrivals["at_cycles"]
    assert last > recording.stop.at_cycles // 2 > first


def test_a_fact_is_not_taken_for_true_beyond_the_arrivals_that_are_kept(tmp_path: Path) -> None:
    found = changed(tmp_path, "[[loop]]", OUTSIDE + "[[loop]]")
    _, recording = counted(found)
    points = analysed(found, found.facts).counted
    (place,) = (at for at, fact in enumerate(points) if fact.table == "avoided")
    counts = list(recording.flow_counts)
    # The first was executed in the elaboration, before jobs begin.
    early = np.array([(CLOCK_HZ // 1_000, 1, NO_THREAD, 0)], ARRIVAL)
    for dropped, said in ((0, ""), (7, "only the first 1 times that ")):
        counts[place] = replace(counts[place], arrivals=early, dropped=dropped)
        run = replace(recording, flow_counts=tuple(counts))
        told = fact_counts(found.robot, found.facts, found.image, points, run)[place]
        assert told.excess.startswith(said) and bool(told.excess) == bool(dropped)
    assert told.excess.endswith(", until 0.001000 s, are looked at: run it shorter")


def test_a_search_after_which_the_task_is_released_anew_is_outside(tmp_path: Path) -> None:
    wrong = changed(tmp_path, "[[loop]]", OUTSIDE + "[[loop]]")
    counts, recording = counted(wrong)
    (fact,) = (count for count in counts if count.excess)
    numbers = re.findall(r", job (\d+) of control", fact.excess)
    names = [thread.name for thread in recording.threads]
    control = names.index("control")
    after = jobs_of(recording, control)[int(numbers[0])].release_cycles
    events = recording.events
    is_release = (events["kind"] == int(EventKind.RELEASE)) & (events["subject"] == control)
    late = replace(recording, events=events[~(is_release & (events["value"] == after))])
    analysis = analysed(wrong, wrong.facts)
    counts = fact_counts(wrong.robot, wrong.facts, wrong.image, analysis.counted, late)
    assert [count.excess for count in counts if count.excess] == []
    longest, soonest = outside_counts(wrong.robot, wrong.facts, analysis, late)
    assert (longest.excess, soonest.excess, soonest.seen) == ("", "", 8_000)
    assert 0 < longest.seen <= longest.declared
    few = tuple(replace(t, job=replace(t.job, outside_cycles=10)) for t in analysis.tasks)
    longest, _ = outside_counts(wrong.robot, wrong.facts, replace(analysis, tasks=few), late)
    assert longest.excess.startswith(f"at most 10 cycles, seen {longest.seen} in the job at ")
    often = changed(tmp_path, "[[loop]]", OUTSIDE.replace("1_000", "9_000") + "[[loop]]")
    _, soonest = outside_counts(often.robot, often.facts, analysis, late)
    assert soonest.excess.startswith("declared 9000 us, released again 8000 us after at ")
    whole, without = (observe(wrong.robot, late, 1, names) for names in ((), {"control"}))
    assert without["control"].jobs < whole["control"].jobs
    assert without["listener"] == whole["listener"]


def test_a_job_has_a_deadline_if_the_next_release_is_a_period_later() -> None:
    """To within the clock's resolution; of the last job it is not known."""
    task = program().robot.task("control")
    assert task is not None and task.period_us is not None
    period = MASTER_CLOCK.cycles_of_us(task.period_us)
    apart = [TOLERANCE_CYCLES, -TOLERANCE_CYCLES, TOLERANCE_CYCLES + 1, -TOLERANCE_CYCLES - 1]
    releases = np.cumsum([7, *(period + late for late in apart)])
    found = have_deadline(task, releases, {"control"})
    assert found.tolist() == [True, True, False, False, False]
    assert have_deadline(task, releases, ()).all()


def test_code_outside_of_jobs_delays_less_urgent_tasks_and_not_its_own(tmp_path: Path) -> None:
    """The job with that code, and a call of the alarm with the return to the listener."""
    stated = changed(tmp_path, "[[loop]]", OUTSIDE.replace("1_000", "8_000") + "[[loop]]")
    never = OUTSIDE.replace("outside", "never").replace('task = "control"\nperiod_us = 1_000\n', "")
    without = changed(tmp_path, "[[loop]]", never + "[[loop]]")
    outside, other = (analysed(found, found.facts) for found in (stated, without))
    bounds, less = outside.bounds, other.bounds
    assert bounds["control"].bound == less["control"].bound
    (job,) = (timing.job for timing in outside.tasks if timing.task.name == "control")
    assert job.outside_cycles > job.cycles
    longer, shorter = bounds["listener"].bound, less["listener"].bound
    assert longer is not None and shorter is not None and longer - shorter >= job.outside_cycles
    assert bounds.keys() == less.keys() and "listener" in bounds


def test_a_release_is_of_a_job_or_of_code_outside_of_jobs(tmp_path: Path) -> None:
    """So the longer one alone delays others, if the next release may come as soon."""
    for period, met in (("4_000", False), ("4_001", True)):
        found = changed(tmp_path, "[[loop]]", OUTSIDE.replace("1_000", period) + "[[loop]]")
        terms = analysed(found, found.facts).bounds["listener"].terms
        assert terms is not None
        names = {part.task for part in terms.interference}
        assert "control, outside of jobs" in names and ("control" in names) == met


REFILL = OUTSIDE.replace("seldom", "refill").replace('"control"', '"listener"')
SAME = """[[mode]]
name = "the same"
reason = ""

[[mode.loop]]
symbol = "workers__sum"
iterations = 40

"""


@pytest.mark.parametrize("timing", ["nominal", "pessimistic"])
def test_sections_outside_of_jobs_block_as_those_in_jobs(timing: str, tmp_path: Path) -> None:
    """In each timing profile, and in modes too."""
    found = changed(tmp_path, "[[loop]]", REFILL + SAME + "[[loop]]")
    outside = analysed(found, found.facts, timing)
    inside = analysed(program(), program().facts, timing)
    blocking = [one.tasks[0].blocking for one in (outside, inside)]
    assert blocking[0] == blocking[1] and blocking[0].kind == "protected action"
    (mode,) = (one for one in outside.modes if one.mode.name == "the same")
    assert mode.bounds["control"].bound == outside.bounds["control"].bound


MODE = """
[[mode]]
name = "short"
reason = ""

[[mode.never]]
symbol = "workers__seldom"

[[mode.loop]]
symbol = "workers__sum"
iterations = 30

"""


def test_a_run_that_leaves_a_mode_is_told_and_not_compared_with_it(tmp_path: Path) -> None:
    counts, recording = counted(changed(tmp_path, "[[loop]]", MODE + "[[loop]]"))
    check_facts_of_run(counts, "the run")
    left = left_modes(counts, "the run")["short"]
    (loop,) = (one for one in counts if one.mode == "short" and "[[mode.loop]]" in one.fact)
    assert (loop.declared, loop.seen) == (30, 40) and "declared 30, seen 40 at " in loop.excess
    assert "[[mode." in left and ", job " in left and " of control, workers.adb:" in left
    found = changed(tmp_path, "[[loop]]", MODE.replace("30", "90") + "[[loop]]")
    analysis, seen = analysed(found, found.facts), observe(found.robot, recording)

    def row(words: dict[str, str]) -> dict[str, Any]:
        modes = result_of(analysis, seen, left=words, margins=False)["tasks"][0]["modes"]
        return next(mode for mode in modes if mode["name"] == "short")

    away, inside = row({"short": left}), row({})
    assert (away["left"], away["ratio"], away["response_max_seen_cycles"]) == (left, None, None)
    assert inside["left"] == "" and inside["ratio"] is not None


def test_a_wrong_fact_shows_in_the_own_time_of_the_job_too(tmp_path: Path) -> None:
    """Cycles that transfers take are no part of it, on either side."""
    wrong = changed(tmp_path, "iterations = 40", "iterations = 5")
    _, recording = counted(wrong)
    found = exceeded(analysed(wrong, wrong.facts), observe(wrong.robot, recording))
    assert any(text.startswith("control showed an execution time of") for text in found), found


def test_a_sporadic_task_that_is_released_more_often_than_declared_is_told(
    tmp_path: Path,
) -> None:
    text = (HERE / "counted" / "robot.toml").read_text()
    path = tmp_path / "robot.toml"
    path.write_text(text)
    check_shortest_interval(read_robot(tmp_path), as_it_is()[1], "listener")
    path.write_text(text.replace("period_us = 11_900", "period_us = 200_000"))
    with pytest.raises(ProjectFileError, match=r"is 200000, but .* listener is released 1\d{4}"):
        check_shortest_interval(read_robot(tmp_path), as_it_is()[1], "listener")
