# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle's timing: bounds from its binary, never exceeded by its run."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from verification.support.needed_tools import NEEDS_TOOLCHAIN, NEEDS_VIRTUAL_BRICK
from verification.support.projects import VEHICLE

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.analyse import checked
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import DeadlineError, ImageFileError, ProjectFileError, RavenbrickError
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace
from ravenbrick.schedule.model import Task
from ravenbrick.schedule.quantity import Time, exact
from ravenbrick.schedule.response_time import ResponseTimeBound
from ravenbrick.schedule.sensitivity import largest_wcet, scaled, with_period
from ravenbrick.timing.analysis import Analysis, analyse
from ravenbrick.timing.bounds import ExecutionTimeError, execution_times
from ravenbrick.timing.facts.counted_facts import points_text
from ravenbrick.timing.facts.facts import Facts, read_facts
from ravenbrick.timing.facts.unmatched_facts import check_facts
from ravenbrick.timing.initial_state import elaborated
from ravenbrick.timing.ipet import FlowFact, longest_path
from ravenbrick.timing.kernel import kernel_facts, services
from ravenbrick.timing.margins import largest_scaling, longest_execution, smallest_period
from ravenbrick.timing.observation.fact_counts import check_facts_of_run, fact_counts
from ravenbrick.timing.observation.job_path import paths_of_longest_jobs
from ravenbrick.timing.observation.long_run import long_run
from ravenbrick.timing.observation.observed import exceeded, observe
from ravenbrick.timing.observation.worst_case_search import largest, search_worst_case
from ravenbrick.timing.results.explanation import overestimation
from ravenbrick.timing.results.result import advice, result_of
from ravenbrick.timing.results.worst_path import worst_paths
from ravenbrick.timing.task_set.scheduled_tasks import Change
from ravenbrick.trace.recording import Recording

Result = dict[str, Any]
pytestmark = [
    NEEDS_TOOLCHAIN,
    NEEDS_VIRTUAL_BRICK,
]


@pytest.fixture(scope="module")
def robot() -> Robot:
    return read_robot(VEHICLE)


@pytest.fixture(scope="module")
def scenario(robot: Robot) -> Scenario:
    return read_scenario(scenario_path(VEHICLE, "step"), robot)


@pytest.fixture(scope="module")
def image() -> ElfImage:
    path = Workspace.of(VEHICLE).image("ram", "vehicle")
    if not path.is_file():
        pytest.skip("the vehicle is not built; 'ravenbrick build examples/vehicle' builds it")
    return read_image(path)


def _analysed(robot: Robot, scenario: Scenario, image: ElfImage, facts: Facts) -> Analysis:
    return analyse(robot, image, elaborated(robot, scenario, image), facts)


@pytest.fixture(scope="module")
def analysis(robot: Robot, scenario: Scenario, image: ElfImage) -> Analysis:
    return _analysed(robot, scenario, image, read_facts(robot))


@pytest.fixture(scope="module")
def recording(robot: Robot, scenario: Scenario, image: ElfImage, analysis: Analysis) -> Recording:
    target = VirtualTarget(flow_points=points_text(analysis.counted))
    return target.run(robot, scenario, image)


@pytest.fixture(scope="module")
def result(robot: Robot, analysis: Analysis, recording: Recording) -> Result:
    return result_of(analysis, observe(robot, recording))


def result_without_margins(analysis: Analysis, **changes: Any) -> Result:
    """Of a changed analysis: searching margins takes long, and no stack matters to them."""
    changed = replace(analysis, changed_bounds=lambda _change: analysis.bounds, **changes)
    return result_of(changed, {})


def test_no_response_time_and_no_stack_of_the_run_exceeds_its_bound(
    robot: Robot, image: ElfImage, analysis: Analysis, recording: Recording, result: Result
) -> None:
    counts = fact_counts(robot, read_facts(robot), image, analysis.counted, recording)
    check_facts_of_run(counts, "the run")
    pragmas = [count for count in counts if count.fact.startswith("pragma Annotate")]
    (rows,) = (count.fact for count in pragmas if not count.seen)
    assert len(pragmas) > 1 and "nxt-display.adb" in rows  # no text is longer than a row
    seen = observe(robot, recording)
    assert set(seen) == {task.name for task in robot.tasks}
    assert exceeded(analysis, seen) == []
    for task in result["tasks"]:
        assert task["observed"]["response_cycles"] <= task["response_bound_cycles"], task
        assert task["observed"]["execution_cycles"] <= task["execution_bound_cycles"], task


def test_the_vehicle_meets_its_deadlines_and_is_told_how_much_room_there_is(result: Result) -> None:
    assert result["schedulable"]
    assert any("control_task may take" in line for line in advice(result))


def test_margins_are_the_border_at_which_the_bounds_miss_a_deadline(analysis: Analysis) -> None:
    """By the bounds as they are, which are closer than those without a common release."""

    def misses(change: Change) -> list[str]:
        bounds = analysis.changed_bounds(change)
        return [name for name, bound in bounds.items() if not bound.meets_deadline]

    def longer(cycles: Time) -> Change:
        return lambda t: replace(t, wcet=t.wcet + cycles) if t.name == "control_task" else t

    task_set, own = analysis.task_set, analysis.task_set.task("control_task").wcet
    limit, limited_by = longest_execution(analysis, "control_task")
    plain, _ = largest_wcet(task_set, "control_task", analysis.overheads)
    assert limit is not None and plain is not None and own < plain < limit
    assert misses(longer(limit - own)) == []
    assert limited_by in misses(longer(limit - own + exact(Fraction(own, 128))))
    factor = largest_scaling(analysis).factor
    assert factor is not None and misses(lambda task: scaled(task, Fraction(factor))) == []
    assert misses(lambda task: scaled(task, Fraction(factor) + Fraction(1, 128)))

    def each(period: Time) -> Change:
        return lambda t: (
            replace(with_period(t, period), phase=None) if t.name == "control_task" else t
        )

    period, step = smallest_period(analysis, "control_task"), exact(MASTER_CLOCK.hertz / 10_000)
    assert period is not None and period < task_set.task("control_task").period
    assert misses(each(period)) == [] and misses(each(period - step))


def test_what_is_said_to_help_is_enough_and_no_more(analysis: Analysis) -> None:
    """With a deadline that half of its job would meet, the control job must be shorter."""
    own = analysis.task_set.task("control_task").wcet
    response = analysis.bounds["control_task"].bound
    assert response is not None

    def tight(change: Change) -> dict[str, ResponseTimeBound]:
        def changed(task: Task) -> Task:
            task = change(task)
            control = task.name == "control_task"
            return replace(task, deadline=response - own // 2) if control else task

        return dict(analysis.changed_bounds(changed))

    def meets(most: Time) -> bool:
        def shorter(t: Task) -> Task:
            return replace(t, wcet=min(t.wcet, most)) if t.name == "control_task" else t

        return all(bound.meets_deadline for bound in tight(shorter).values())

    limit, limited_by = longest_execution(replace(analysis, changed_bounds=tight), "control_task")
    assert limited_by == "control_task" and limit is not None and 0 < limit < own
    assert not meets(own) and meets(limit) and not meets(limit + exact(Fraction(own, 128)))


def test_a_task_that_robot_toml_leaves_out_is_an_error(
    robot: Robot, scenario: Scenario, image: ElfImage
) -> None:
    """Its jobs and protected actions would not be counted."""
    fewer = replace(robot, tasks=robot.tasks[:2])
    with pytest.raises(RavenbrickError, match="the image has a task 'display_task', which is mis"):
        _analysed(fewer, scenario, image, read_facts(robot))
    renamed = replace(robot, tasks=(replace(robot.tasks[0], name="link"), *robot.tasks[1:]))
    with pytest.raises(RavenbrickError, match=r"tasks\[0\].name: the image has no task 'link'"):
        _analysed(renamed, scenario, image, read_facts(robot))


def test_a_stack_that_may_overflow_is_said_first(analysis: Analysis) -> None:
    tasks = [replace(found, task=replace(found.task, stack_bytes=600)) for found in analysis.tasks]
    result = result_without_margins(analysis, tasks=tuple(tasks))
    assert not result["stacks_suffice"] and result["schedulable"]
    first, second, *_ = advice(result)
    assert re.match(r"control_task may need \d+ bytes of stack, and there are 600: enlarge", first)
    assert "of stack" not in second


def test_a_stack_without_a_bound_does_not_suffice(analysis: Analysis) -> None:
    """The verdict names the task and the line, in text and data, and no deadline is missed."""
    first, *others = analysis.tasks
    job = replace(first.job, stack_bytes=None, stack_lost="panel.adb:64")
    result = result_without_margins(analysis, tasks=(replace(first, job=job), *others))
    assert result["schedulable"] and result["stacks_suffice"] is False
    (lost,) = (stack for stack in result["stacks"] if stack["bound_bytes"] is None)
    assert lost["name"] == first.task.name and lost["lost_at"] == "panel.adb:64"
    words = rf"no bound was found for the stack of {first.task.name} \(\d+ bytes\): at panel.adb:64"
    with pytest.raises(DeadlineError, match=words) as caught:
        checked({**result, "advice": advice(result)})
    assert caught.value.data["stacks_suffice"] is False


def test_the_handlers_stack_is_judged_too(analysis: Analysis, result: Result) -> None:
    assert result["stacks_suffice"]
    assert analysis.handlers_stack_bytes == 2048  # runtime/README.md; the vehicle states no other
    result = result_without_margins(analysis, handlers_stack_bytes=64)
    first, *_ = advice(result)
    assert re.match(r"interrupt handlers may need \d+ bytes of stack, and there are 64", first)
    assert "ravenbrick_handler_stack_size" in first and not result["stacks_suffice"]


def test_without_a_job_that_can_be_shortened_the_largest_term_is_named(analysis: Analysis) -> None:
    result = result_without_margins(analysis)
    tight = {"meets_deadline": False, "execution_max_cycles": 0}
    result["tasks"][1] |= tight
    result["tasks"][1]["terms"]["interrupts_cycles"] = 100_000
    miss = {"name": "control_task", "kind": "task", "deadline_cycles": 192_220}
    result["misses"] = [miss | {"response_bound_cycles": 200_000}]
    lines = advice(result)
    assert lines[0].startswith("control_task can miss its deadline of 4000 us")
    assert "the largest term of its bound, interrupts with" in lines[1]


def test_a_damaged_image_is_named_with_what_to_do(image: ElfImage) -> None:
    content = image.content
    place = content.index(b".debug_abbrev")
    with pytest.raises(ImageFileError, match="it is damaged: build it again"):
        execution_times(content[: place // 2], functions=["memcpy"])


def test_missing_bounds_of_several_functions_are_asked_for_at_once(image: ElfImage) -> None:
    with pytest.raises(ExecutionTimeError, match="memcpy, memset: loops without a bound") as caught:
        execution_times(image.content, functions=["memcpy", "memset"])
    assert {loop["symbol"] for loop in caught.value.data["missing"]} == {"memcpy", "memset"}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"nxt__display__put_integer"', '"put_intger"', "symbol: the image has no function"),
        ('"panel__put_hundredths"', '"put_hundreds"', "within: the image has no function"),
        (
            'symbol = "nxt__display__put_integer"',
            'file = "nowhere.adb"',
            "file: the image has no code of a file 'nowhere.adb'",
        ),
    ],
)
def test_a_fact_that_matches_nothing_is_refused_with_its_line(
    image: ElfImage, tmp_path: Path, old: str, new: str, said: str
) -> None:
    check_facts(read_facts(read_robot(VEHICLE)), image)
    text = (VEHICLE / "timing.toml").read_text()
    line = text[: text.index(old)].count("\n") + 1
    (tmp_path / "robot.toml").write_text((VEHICLE / "robot.toml").read_text())
    (tmp_path / "timing.toml").write_text(text.replace(old, new, 1))
    with pytest.raises(ProjectFileError) as refused:
        check_facts(read_facts(read_robot(tmp_path)), image)
    assert refused.value.line == line
    assert f"loop[0].{said}" in str(refused.value)


def test_a_folder_in_place_of_the_facts_is_not_passed_over(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text((VEHICLE / "robot.toml").read_text())
    (tmp_path / "timing.toml").mkdir()
    with pytest.raises(RavenbrickError, match=r"timing\.toml:1: cannot be read \(Is a directory\)"):
        read_facts(read_robot(tmp_path))


def test_ceilings_and_handlers_are_those_of_the_sources(analysis: Analysis) -> None:
    ceilings = {item.name: item.ceiling for item in analysis.objects}
    assert ceilings["panel__latest__objectX"] == 2
    assert ceilings["nxt__avr__shared"] == 30
    priorities = {cost.handler.source: cost.handler.priority for cost in analysis.interrupts}
    assert priorities[9] == 38 and priorities[12] == 31


def test_a_loop_without_a_bound_is_asked_for_by_file_and_line(image: ElfImage) -> None:
    with pytest.raises(ExecutionTimeError) as refused:
        execution_times(
            image.content,
            functions=["nxt__display__put_noupdate__2"],
            annotations=[("timing.toml", kernel_facts(4, ()))],
        )
    asked = re.search(r"nxt-canvas\.adb:(\d+): how often at most", refused.value.detail)
    assert asked is not None
    assert f'file = "nxt-canvas.adb"\n  line = {asked[1]}\n' in refused.value.detail


def test_a_function_that_nothing_disturbs_is_bounded_as_it_is_with_its_lines(
    image: ElfImage,
) -> None:
    name = "functional_initialize_instance"
    calls = ([name], 0x0021_0000)
    own = execution_times(image.content, known_memory=calls)
    any_data = execution_times(image.content, functions=[name]).functions[0]
    assert own.known_memory_cycles is not None and 0 < own.known_memory_cycles <= any_data.cycles
    assert own.known_memory_lines
    assert all(
        line.rpartition("/")[2].startswith("functional.c:") for line, _ in own.known_memory_lines
    )
    with pytest.raises(ExecutionTimeError, match="'nothing': the image has no such variable"):
        execution_times(image.content, known_memory=calls, inputs=["nothing"])


def test_a_loop_of_a_function_alone_is_asked_for_too(image: ElfImage) -> None:
    with pytest.raises(ExecutionTimeError) as refused:
        execution_times(image.content, functions=["memcpy"])
    asked = re.search(r"memory\.S:(\d+): how often at most", refused.value.detail)
    assert asked is not None
    assert f'file = "memory.S"\n  line = {asked[1]}\n' in refused.value.detail


def test_a_fact_about_an_unknown_task_is_refused_with_its_line(
    robot: Robot, tmp_path: Path
) -> None:
    for name in ("robot.toml", "timing.toml"):
        (tmp_path / name).write_text((VEHICLE / name).read_text())
    wrong = (tmp_path / "timing.toml").read_text().replace('"control_task"', '"panel_task"')
    (tmp_path / "timing.toml").write_text(wrong)
    with pytest.raises(RavenbrickError, match=r"timing\.toml:\d+: .*no task 'panel_task'"):
        read_facts(read_robot(tmp_path))


def test_an_interrupt_that_comes_more_often_than_said_is_noticed(
    analysis: Analysis, image: ElfImage, recording: Recording, tmp_path: Path
) -> None:
    text = (VEHICLE / "timing.toml").read_text().replace("at_most = 32", "at_most = 3")
    (tmp_path / "robot.toml").write_text((VEHICLE / "robot.toml").read_text())
    (tmp_path / "timing.toml").write_text(text)
    wrong = read_robot(tmp_path)
    counts = fact_counts(wrong, read_facts(wrong), image, analysis.counted, recording)
    said = r'source = "SPI": declared 3, seen 32 in 400000 us at \d\.\d+ s; in the run'
    with pytest.raises(ExecutionTimeError, match=said):
        check_facts_of_run(counts, "the run")


def test_a_function_alone_is_bounded(image: ElfImage) -> None:
    found = execution_times(image.content, functions=["functional_step_instance"]).functions[0]
    assert 500 < found.cycles < 5_000
    assert "__aeabi_fmul" in found.reached


def test_bounds_of_a_mode_stand_beside_those_of_any(result: Result) -> None:
    for task in result["tasks"]:
        (mode,) = task["modes"]
        assert mode["name"] == "link up"
        assert task["observed"]["execution_cycles"] <= mode["execution_bound_cycles"]
        assert task["observed"]["response_cycles"] <= mode["response_bound_cycles"]
        assert mode["response_bound_cycles"] < task["response_bound_cycles"]


def test_the_report_says_what_the_bound_holds_that_the_run_did_not_show(result: Result) -> None:
    link, *_, display = overestimation(result)
    assert link.startswith("coprocessor_task: the bound is")
    assert "that path takes only" in link and "in mode 'link up' (the link was set up" in link
    assert "2 x coprocessor_task" in display or "1 x coprocessor_task" in display
    first = result["tasks"][0]
    seen = {**first["observed"], "response_cycles": first["response_bound_cycles"]}
    close = {**first, "observed": seen}
    assert "which is close" in overestimation({"tasks": [close]})[0]
    terms, own = first["terms"], first["execution_bound_cycles"]
    met = {f"{key}_cycles": terms[f"{key}_cycles"] for key in ("interference", "blocking")}
    met |= {"interrupt_cycles": terms["interrupts_cycles"], "execution_cycles": own}
    rest = {**first, "observed": {**first["observed"], **met}}
    (line,) = overestimation({"tasks": [rest]})
    charged = terms["overheads_cycles"] + terms["release_jitter_cycles"]
    assert line.endswith(f"are charged {charged} cycles, which the run does not show separately")


def test_an_image_older_than_the_run_time_is_named_with_what_to_do(image: ElfImage) -> None:
    old = {name: symbol for name, symbol in image.symbols.items() if name != "resume"}
    with pytest.raises(ImageFileError, match="older: build it again with 'ravenbrick build'"):
        services(replace(image, symbols=old), [])


def test_the_integer_program_finds_the_longest_path_of_the_graph(image: ElfImage) -> None:
    names = ["functional_step_instance", "ada__real_time__delays__delay_until"]
    facts = [("run-time", kernel_facts(4, ()))]
    found = execution_times(image.content, functions=names, annotations=facts, graphs=True)
    for bound in found.functions:
        assert bound.graph is not None
        assert longest_path(bound.graph) == bound.graph["path_cycles"] >= bound.cycles


def test_a_fact_about_far_places_shortens_the_path_and_a_wrong_line_is_named(
    image: ElfImage,
) -> None:
    found = execution_times(image.content, functions=["functional_step_instance"], graphs=True)
    graph = found.functions[0].graph
    assert graph is not None
    lines = sorted({line for block in graph["blocks"][1:] for line in block["lines"]})
    shorter = []
    for line in lines:
        fact = FlowFact("functional_step_instance", (line,), 0, "a test")
        try:
            shorter.append(longest_path(graph, [fact]))
        except ExecutionTimeError:
            continue
    assert min(shorter) < graph["path_cycles"]
    assert max(shorter) <= graph["path_cycles"]
    unknown = FlowFact("functional_step_instance", ("none.c:1",), 0, "a test")
    with pytest.raises(ExecutionTimeError, match=r"no block has the line none\.c:1"):
        longest_path(graph, [unknown])


def test_a_worst_case_search_and_a_long_run_find_no_response_above_its_bound(
    analysis: Analysis, robot: Robot, scenario: Scenario, image: ElfImage, recording: Recording
) -> None:
    short = replace(scenario, duration_ms=1_300, pictures_ms=())
    shares: list[float] = []
    found = search_worst_case(robot, short, image, variants=3, progress=shares.append)
    assert 0 < shares[0] < shares[2] < shares[3] < 1
    assert shares == sorted(shares) and shares[-1] <= 1
    assert set(found.worst) >= {"coprocessor_task", "control_task"}
    gained = {n: s.response_cycles - found.unvaried[n] for n, s in found.worst.items()}
    assert min(gained.values()) >= 0 and max(gained.values()) > 0, gained
    reset = "coprocessor_task"
    assert found.worst[reset].response_cycles > 1.5 * found.undisturbed[reset].response_cycles
    for sample in found.worst.values():
        assert sample.recording is not None
        counts = fact_counts(robot, read_facts(robot), image, (), sample.recording)
        check_facts_of_run(counts, "a variant")
    both = largest(observe(robot, recording), found.worst)
    run = long_run(robot, short, image, seconds=2.6)
    assert exceeded(analysis, both, run.plain()) == []
    control = run.tasks["control_task"]
    assert run.repetitions == 2 and control.misses == 0
    assert 500 < control.response.count <= 660
    assert control.latency.most is not None and control.response.most is not None
    assert control.latency.most < control.response.most
    assert sum(control.response.bins.values()) == control.response.count


def test_the_end_of_an_action_that_lets_others_in_is_charged_to_their_releases(
    analysis: Analysis,
) -> None:
    timings = {timing.task.name: timing for timing in analysis.tasks}
    terms = {name: analysis.bounds[name].terms for name in timings}
    control, display = terms["control_task"], terms["display_task"]
    assert control is not None and display is not None
    # Six brakes and three drives in the longest job, each with a protected action.
    charged_to_jobs = timings["control_task"].job.cycles - control.own
    assert charged_to_jobs >= 9 * (analysis.services.dispatch - 10)
    parts = {part.task: part for part in display.interference}
    assert parts["control_task"].jobs == 1
    assert parts["control_task"].time == control.own + analysis.services.dispatch


def test_lines_add_up_to_the_bound_of_a_job_and_to_the_time_of_one_in_the_run(
    robot: Robot, scenario: Scenario, image: ElfImage, analysis: Analysis, recording: Recording
) -> None:
    target = VirtualTarget(flow_points=points_text(analysis.counted))
    runs = paths_of_longest_jobs(robot, scenario, image, target, recording, 1)
    seen = observe(robot, recording)
    paths = worst_paths(analysis.tasks, image, runs)
    assert [path.task for path in paths] == [timing.task.name for timing in analysis.tasks]
    for timing, path in zip(analysis.tasks, paths, strict=True):
        lines = [line for _, line in path.function.all_lines()]
        assert sum(line.worst.cycles for line in lines if line.worst) == timing.job.cycles
        own = sum(line.run.cycles for line in lines if line.run)
        assert own == seen[path.task].execution_cycles == runs[path.task].cycles
        # The instructions alone, without what the trace charges besides.
        assert abs(runs[path.task].path["cycles"] - own) < 100


def test_a_line_of_the_worst_path_has_its_source_and_the_calls_below_it(
    image: ElfImage, analysis: Analysis
) -> None:
    control = next(t for t in worst_paths(analysis.tasks, image, {}) if t.task == "control_task")
    lines = {line.text: line for line in control.function.lines}
    line = lines["Driving.Control (Vehicle);"]
    assert line.place.startswith("tasks.adb:")
    assert line.worst is not None and line.worst.times == 1 and line.run is None
    assert [called.name for called in line.calls] == ["driving.control"]
    below = {called.name for owner, each in line.calls[0].all_lines() for called in each.calls}
    assert any("functional_step" in name for name in below)
    # The compiler's library has no source here.
    places = {each.place for _, each in control.function.all_lines() if not each.text}
    assert any(re.fullmatch(r"__aeabi_fmul at 0x[0-9a-f]+", place) for place in places), places


def test_a_result_without_margins_differs_in_nothing_else(
    robot: Robot, analysis: Analysis, recording: Recording, result: Result
) -> None:
    found = result_of(analysis, observe(robot, recording), margins=False)
    gone = {"execution_max_cycles": None, "limited_by": "", "smallest_period_us": None}
    tasks = [{**task, **gone} for task in result["tasks"]]
    none = {"largest_scaling": None, "scaling_limited_by": ""}
    assert found == {**result, **none, "tasks": tasks}
