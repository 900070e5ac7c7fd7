# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets in files, and what is said about wrong ones."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from ravenbrick.errors import ProjectFileError
from ravenbrick.schedule.assignment import Rule
from ravenbrick.schedule.model import CriticalSection, Frame, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.report import advice, analysis
from ravenbrick.schedule.response_time import response_time_bounds
from ravenbrick.schedule.task_file import read_task_file

TOML = """\
schema_version = 1
name = "vehicle"
unit = "ms"

[overheads]
switch_in = 0.002

[[tasks]]
name = "button"
release = "interrupt"
minimum_interrelease_time = 20
wcet = 0.1
priority = 10

[[tasks]]
name = "control"
period = 2.5
deadline = "7/3"
wcet = 1.18
priority = 2
phase = 1
release_jitter = 0.01
sections = [{ resource = "encoders", duration = 0.25, start = 0.5 }]

[[tasks]]
name = "display"
period = 500
wcet = 20
priority = 1
sections = [{ resource = "encoders", duration = 0.3 }]
"""


def written(folder: Path, text: str, name: str = "set.toml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_toml_file_is_read_exactly(tmp_path: Path) -> None:
    """Decimals are the fractions that they are written as."""
    file = read_task_file(written(tmp_path, TOML))
    control = file.task_set.task("control")
    assert (file.name, file.unit, len(file.task_set)) == ("vehicle", "ms", 3)
    assert file.overheads == Overheads(switch_in=Fraction(2, 1000))
    assert control == Task(
        "control",
        Fraction(5, 2),
        Fraction(118, 100),
        2,
        Fraction(7, 3),
        Fraction(1, 100),
        1,
        sections=(CriticalSection("encoders", Fraction(1, 4), Fraction(1, 2)),),
    )
    assert file.task_set.task("button").release == "interrupt"
    assert file.task_set.task("display").deadline == 500


def test_json_file_says_the_same_as_toml(tmp_path: Path) -> None:
    """The same tables in JSON give the same task set."""
    import tomllib

    toml = read_task_file(written(tmp_path, TOML))
    text = json.dumps(tomllib.loads(TOML), indent=1)
    found = read_task_file(written(tmp_path, text, "set.json"))
    assert found.task_set == toml.task_set and found.overheads == toml.overheads


@pytest.mark.parametrize(
    ("old", "new", "line", "field", "words"),
    [
        ("wcet = 1.18", "wcets = 1.18", 19, "tasks[1].wcets", "did you mean 'wcet'?"),
        ("wcet = 1.18", "", 15, "tasks[1].wcet", "is missing"),
        ("wcet = 1.18", "wcet = -1", 19, "tasks[1].wcet", "expected more than 0"),
        ("wcet = 1.18", "wcet = nan", 19, "tasks[1].wcet", "not a finite number"),
        ("wcet = 1.18", "wcet = 'much'", 19, "tasks[1].wcet", "not a finite number"),
        ("wcet = 1.18", "wcet = '1e999999999'", 19, "tasks[1].wcet", "exponent beyond 400"),
        ("wcet = 1.18", "wcet = true", 19, "tasks[1].wcet", "not a number"),
        ("period = 2.5", "minimum_interrelease_time = 2", 17, "", "has a 'period' instead"),
        ("priority = 2", "", 15, "tasks[1].priority", "or 'priorities' at the head"),
        ("priority = 2", "priority = 2.5", 20, "tasks[1].priority", "a whole number"),
        ("phase = 1", "phase = -1", 21, "tasks[1].phase", "at least 0"),
        ('"control"', '"button"', 16, "tasks[1].name", "is defined twice"),
        ('"interrupt"', '"aperiodic"', 10, "tasks[0].release", "expected one of cyclic"),
        ("start = 0.5", "start = 1", 23, "tasks[1].sections", "ends after 5/4"),
        ("start = 0.5", "begin = 1", 23, "tasks[1].sections[0].begin", "unknown field"),
        ("switch_in", "switch", 6, "overheads.switch", "did you mean 'switch_in'?"),
        ("switch_in = 0.002", "tick = 1", 5, "overheads.tick_period", "is missing"),
        ("schema_version = 1", "schema_version = 2", 1, "schema_version", "expected 1"),
        ("unit =", "priorities = 'best'\nunit =", 3, "priorities", "expected one of declared"),
        ('name = "vehicle"', "name = 3", 2, "name", "a text in quotes"),
    ],
)
def test_error_names_file_line_and_field(
    tmp_path: Path, old: str, new: str, line: int, field: str, words: str
) -> None:
    """The sentence says where the mistake is and what was expected."""
    path = written(tmp_path, TOML.replace(old, new, 1))
    with pytest.raises(ProjectFileError) as caught:
        read_task_file(path)
    assert (caught.value.path, caught.value.line) == (path, line)
    assert field in caught.value.field and words in caught.value.sentence


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ('{"schema_version": 1,\n "tasks": [\n  {"name": "a" "period": 3}]}', 3, "not valid JSON"),
        ('{"schema_version": 1,\n "tasks": [\n  {"name": "a",\n   "period": -3}]}', 4, "wcet"),
        ('{"schema_version": 1,\n "tasks": [\n  7]}', 2, "a list of tables"),
        ("[1]", 1, "an object"),
        ("[" * 100_000, 1, "nested too deeply"),
        ('{"schema_version": 1,\n "tasks": [\n  {"name": "a", "period": 1e-999999999}]}', 3, "400"),
        ('{"schema_version": 1, "tasks": []}', 1, "there is no task"),
    ],
)
def test_wrong_json_names_its_line(tmp_path: Path, text: str, line: int, words: str) -> None:
    """Syntax errors and wrong fields of JSON files are located too."""
    text = text.replace('"period": -3', '"period": 3, "priority": 1, "wcet": 0')
    with pytest.raises(ProjectFileError) as caught:
        read_task_file(written(tmp_path, text, "set.json"))
    assert caught.value.line == line and words in caught.value.sentence


def test_missing_file_is_said_to_be_missing(tmp_path: Path) -> None:
    """Both formats give an error of the project file."""
    for name in ("none.toml", "none.json"):
        with pytest.raises(ProjectFileError, match="cannot be read"):
            read_task_file(tmp_path / name)


def test_file_can_leave_the_priorities_to_audsley(tmp_path: Path) -> None:
    """A feasible order is found, or the error says that there is none."""
    text = "schema_version = 1\npriorities = 'audsley'\n"
    for name, row in {"a": (52, 100, 110), "b": (52, 140, 154)}.items():
        text += f"[[tasks]]\nname = '{name}'\nwcet = {row[0]}\nperiod = {row[1]}\n"
        text += f"deadline = {row[2]}\n"
    found = read_task_file(written(tmp_path, text))
    assert [task.name for task in found.task_set.by_priority()] == ["b", "a"]
    with pytest.raises(ProjectFileError, match="no assignment of priorities"):
        read_task_file(written(tmp_path, text.replace("deadline = 110", "deadline = 53")))


def test_report_says_which_task_to_shorten_and_by_how_much(tmp_path: Path) -> None:
    """Set A of Burns and Wellings misses 50; each proposed change makes it schedulable."""
    text = "schema_version = 1\nunit = 'ms'\npriorities = 'rate_monotonic'\n"
    for name, wcet, period in (("a", 10, 30), ("b", 10, 40), ("c", 12, 50)):
        text += f"[[tasks]]\nname = '{name}'\nwcet = {wcet}\nperiod = {period}\n"
    file = read_task_file(written(tmp_path, text))
    result = analysis(file)
    assert not result["schedulable"] and result["schedulable_earliest_deadline_first"]
    assert json.loads(json.dumps(result)) == result
    assert advice(result) == [
        "c: response time 52 ms is above the deadline 50 ms",
        "all deadlines are met if a executes for 9 ms instead of 10 ms",
        "all deadlines are met if b executes for 9 ms instead of 10 ms",
        "all deadlines are met if c executes for 10 ms instead of 12 ms",
        "or if all execution times are multiplied by 0.961538",
    ]
    for changed in ({"a": 9}, {"b": 9}, {"c": 10}):
        rows = {"a": 10, "b": 10, "c": 12} | changed
        bounds = response_time_bounds(TaskSet.of(*zip(rows.values(), (30, 40, 50), strict=True)))
        assert all(found.meets_deadline for found in bounds)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: TaskSet(()), "there is no task"),
        (lambda: TaskSet((Task("a", 5, 1), Task("a", 6, 1))), "twice"),
        (lambda: Overheads(tick_period=1, tick_further=1), "at most 'tick_first'"),
        (lambda: TaskSet.of((1, 2)).task("x"), "there are: t1"),
    ],
)
def test_model_refuses_what_means_nothing(make: Callable[[], object], words: str) -> None:
    """In Python the same mistakes raise `TaskSetError` with a sentence."""
    with pytest.raises(TaskSetError, match=words):
        make()


def test_interrupts_stay_above_tasks_whatever_the_rule(tmp_path: Path) -> None:
    path = tmp_path / "tasks.toml"
    path.write_text(
        'schema_version = 1\n[[tasks]]\nname = "slow"\nperiod = 50\nwcet = 10\npriority = 3\n'
        '[[tasks]]\nname = "fast"\nperiod = 10\nwcet = 2\npriority = 2\n'
        '[[tasks]]\nname = "link"\nrelease = "interrupt"\nminimum_interrelease_time = 100\n'
        'wcet = 4\npriority = 30\nlimits = [{ share = "1/2", window = 20 }]\n'
    )
    for rule in (Rule.RATE_MONOTONIC, Rule.DEADLINE_MONOTONIC, Rule.AUDSLEY):
        found = read_task_file(path, rule).task_set
        assert [task.name for task in found.by_priority()] == ["link", "fast", "slow"]
        assert found.task("link").limits == ((Fraction(1, 2), 20, 0),)
    assert read_task_file(path).task_set.by_priority()[1].name == "slow"


FRAMES = """schema_version = 1
[[tasks]]
name = "telemetry"
frames = [{ wcet = 4, separation = 20, deadline = 10 }, { wcet = 1, separation = 10 }]
priority = 1
"""


def test_frames_that_all_say_their_separation_need_no_period(tmp_path: Path) -> None:
    """The least separation is the period, and the deadline of a frame that has none of its own."""
    (task,) = read_task_file(written(tmp_path, FRAMES)).task_set
    assert task.frames == (Frame(4, 20, 10), Frame(1, 10, 10))
    assert (task.period, task.wcet, task.deadline) == (10, 4, 10)
    path = written(tmp_path, FRAMES.replace("wcet = 1, separation = 10", "wcet = 1"))
    with pytest.raises(ProjectFileError, match=r"tasks\[0\]\.period: is missing"):
        read_task_file(path)


MODELS = """schema_version = 1
[[tasks]]
name = "sense"
period = 20
wcet = 2
priority = 4
[[tasks]]
name = "act"
release = "sporadic"
minimum_interrelease_time = 20
wcet = 1
priority = 3
[[tasks]]
name = "command"
release = "sporadic"
minimum_interrelease_time = 100
wcet = 3
priority = 1
server = "requests"
[[servers]]
name = "requests"
kind = "polling"
period = 10
capacity = 1
priority = 2
[[transactions]]
name = "steer"
tasks = ["sense", "act"]
deadline = 10
"""


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        (
            'server = "requests"',
            'server = "other"',
            "19: tasks[2].server: there is no server 'other'",
        ),
        ('server = "requests"\n', "", "20: servers[0].name: no task names this server"),
        (
            'kind = "polling"',
            'kind = "constant"',
            "22: servers[0].kind: is 'constant'; expected one",
        ),
        ("capacity = 1", "capacity = 11", "24: servers[0].capacity: is 11, more than the period"),
        ('["sense", "act"]', '["sense", "command"]', "28: transactions[0].tasks: 'command' is not"),
        ("time = 20", "time = 21", "10: tasks[1].minimum_interrelease_time: is 21, but 'sense'"),
        ("deadline = 10", "deadline = 0", "29: transactions[0].deadline: is 0; expected more than"),
        ("wcet = 2", "frames = [2, 0]", "5: tasks[0].frames: is 0; expected more than 0"),
        ("wcet = 2", "wcet = 2\nframes = [2]", "5: tasks[0].wcet: a task with 'frames' has its"),
        (
            "wcet = 2",
            "wcet = 2\nwcet_high = 3",
            '6: tasks[0].wcet_high: needs criticality = "high"',
        ),
        ("wcet = 2", "wcet = 2\nbcet = 3", "6: tasks[0].bcet: is 3, more than the execution time"),
    ],
)
def test_errors_of_the_models_name_line_and_field(
    old: str, new: str, place: str, tmp_path: Path
) -> None:
    path = tmp_path / "set.toml"
    path.write_text(MODELS.replace(old, new, 1))
    with pytest.raises(ProjectFileError) as caught:
        read_task_file(path)
    assert place in str(caught.value)


def test_the_models_of_a_file_are_one_system(tmp_path: Path) -> None:
    """A server's task stands among the others; the transaction's later task has its jitter."""
    path = tmp_path / "set.toml"
    path.write_text(MODELS)
    solution = read_task_file(path).system.solution
    assert [task.name for task in solution.task_set.by_priority()] == ["sense", "act", "requests"]
    assert solution.task_set.task("act").release_jitter == 2
    assert [found.bound for found in solution.served] == [34]
    assert solution.schedulable
