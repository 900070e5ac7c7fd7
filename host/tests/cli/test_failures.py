# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The first line that a person sees when the program fails on the brick."""

from __future__ import annotations

import re

import pytest
from typer.testing import CliRunner
from verification.support.failing_program import FailingProgram, failing_project

from ravenbrick.cli.app import app

CONTROL, DISPLAY, MAIN = 1, 2, 3
PRESS = "press"


@pytest.fixture(scope="module")
def unchecked(tmp_path_factory: pytest.TempPathFactory) -> FailingProgram:
    """Without stack checking."""
    return failing_project(tmp_path_factory.mktemp("unchecked"), stack_check=False)


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> FailingProgram:
    """As `ravenbrick new` makes it."""
    return failing_project(tmp_path_factory.mktemp("checked"), stack_check=True)


def output(program: FailingProgram, task: int, way: str, amount: int = 1) -> list[str]:
    """What `run` prints, from the failure on."""
    elf = program.image(task, way, amount)
    done = CliRunner().invoke(app, ["run", str(program.project), PRESS, "--elf", str(elf)])
    assert done.exit_code in (0, 7), done.output
    lines = done.output.splitlines()
    first = next((i for i, line in enumerate(lines) if line.startswith("ravenbrick: ")), 0)
    return lines[first:]


def first_line(program: FailingProgram, task: int, way: str, amount: int = 1) -> str:
    """The sentence of the failure."""
    return output(program, task, way, amount)[0]


@pytest.mark.parametrize(
    ("way", "name", "mark"),
    [
        ("range_check", "Constraint_Error", "the range check"),
        ("index_check", "Constraint_Error", "the index check"),
        ("overflow", "Constraint_Error", "the overflow"),
        ("division", "Constraint_Error", "the division"),
        ("raised", "Program_Error", "the raise statement"),
        ("raised_with_message", 'Too_Hot ("98 degrees")', "the raise with a message"),
        ("own_exception", "Too_Hot", "the own exception"),
        ("storage", "Storage_Error", "the storage error"),
        ("assertion", "Assertion_Error", "the assertion"),
        ("in_protected", "Constraint_Error", "in the protected procedure"),
    ],
)
def test_an_exception_is_told_by_name_place_and_task(
    unchecked: FailingProgram, way: str, name: str, mark: str
) -> None:
    """The source line follows; nothing is said about the loop in which the program ended."""
    line, source, *rest = output(unchecked, CONTROL, way)
    assert line == f"ravenbrick: {name} at {unchecked.place(mark)} in task control_task"
    assert mark in source
    assert not any("loops" in text for text in (line, *rest))


def test_an_exception_of_the_main_procedure_is_not_of_a_task(unchecked: FailingProgram) -> None:
    """Nobody has written a task called environment."""
    place = unchecked.place("the division")
    expected = f"ravenbrick: Constraint_Error at {place} in the main procedure"
    assert first_line(unchecked, MAIN, "division") == expected


def test_an_exception_in_a_handler_names_the_handler(unchecked: FailingProgram) -> None:
    """A handler has no task."""
    place = unchecked.place("in the handler")
    expected = f"ravenbrick: Constraint_Error at {place} in the handler of a timing event"
    assert first_line(unchecked, CONTROL, "in_handler") == expected


def test_a_rule_of_the_run_time_is_told_with_the_call(unchecked: FailingProgram) -> None:
    """A violated ceiling."""
    line = first_line(unchecked, CONTROL, "ceiling")
    assert re.fullmatch(
        r"ravenbrick: Program_Error \(ceiling violated\) at failing.adb:\d+ in task control_task",
        line,
    )


@pytest.mark.parametrize(
    ("way", "words", "mark"),
    [
        (
            "no_memory",
            "access to address 0x00400000, where there is no memory (data abort)",
            "the access",
        ),
        ("misaligned", "misaligned access to address 0x00209001 (data abort)", "the access"),
        ("undefined", "undefined instruction", "the undefined instruction"),
        (
            "wild_jump",
            "jump to 0x00500000, where there is no memory (prefetch abort)",
            "the wild jump",
        ),
    ],
)
def test_what_the_processor_refuses_in_c_is_told_with_address_place_and_task(
    unchecked: FailingProgram, way: str, words: str, mark: str
) -> None:
    """C has no exceptions: the processor has."""
    place = unchecked.place(mark, "failing_c.c")
    line = first_line(unchecked, CONTROL, way)
    assert line == f"ravenbrick: {words} at {place} in task control_task"


CASES = [
    # task, way, amount, who, stack, bytes missing at least
    (CONTROL, "recursion", 1, "task control_task", 2048, 1000),
    (DISPLAY, "recursion", 1, "task display_task", 4096, 1000),
    (MAIN, "recursion", 1, "the main procedure", 4096, 1000),
    (CONTROL, "deep_calls", 84, "task control_task", 2048, 4),
    (MAIN, "deep_calls", 170, "the main procedure", 4096, 4),
    (CONTROL, "large_array", 1, "task control_task", 2048, 3952),
    (DISPLAY, "large_array", 1, "task display_task", 4096, 1904),
    (CONTROL, "sized_array", 600, "task control_task", 2048, 352),
    (CONTROL, "handler_recursion", 300, "a chain of interrupt handlers", 2048, 1000),
]


@pytest.mark.parametrize(("task", "way", "amount", "who", "stack", "least"), CASES)
def test_a_stack_overflow_is_the_headline_whatever_follows(
    unchecked: FailingProgram, task: int, way: str, amount: int, who: str, stack: int, least: int
) -> None:
    """Without checks: noticed from outside, also where the program goes on as if nothing was."""
    line = first_line(unchecked, task, way, amount)
    found = re.match(
        rf"ravenbrick: stack overflow: {who} needs (?:at least )?(\d+) bytes more than its stack "
        rf"of {stack} bytes has at failing.adb:\d+; .*(?:Storage_Size|_stack_size=BYTES).*"
        r"\(more than (\d+)\)",
        line,
    )
    assert found, line
    assert int(found[1]) >= least
    assert int(found[2]) == stack + int(found[1])


@pytest.mark.parametrize(
    ("task", "way", "amount", "who", "stack"),
    [case[:5] for case in CASES if case[1] in ("recursion", "large_array", "sized_array")],
)
def test_a_checked_stack_is_told_before_anything_is_overwritten(
    checked: FailingProgram, task: int, way: str, amount: int, who: str, stack: int
) -> None:
    """The check stops the program in the subprogram that does not fit."""
    line = first_line(checked, task, way, amount)
    pattern = rf"ravenbrick: stack overflow: {who} needs at least \d+ bytes more than its stack of "
    assert re.match(rf"{pattern}{stack} bytes has at failing.adb:\d+; ", line), line
    assert "the program ended with" not in line


def test_an_array_of_absurd_size_is_a_stack_overflow(checked: FailingProgram) -> None:
    """Its end lies beyond all addresses."""
    line = first_line(checked, CONTROL, "sized_array", 1_000_000_000)
    assert "task control_task needs at least 65536 bytes more" in line
    assert checked.place("the sized array") in line


def test_a_sensor_that_is_not_plugged_in_is_told(unchecked: FailingProgram) -> None:
    """As a warning: the run is judged by its criteria."""
    text = "\n".join(output(unchecked, CONTROL, "read_early"))
    place = re.search(r"failing\.adb:\d+", text)
    assert place, text
    assert (
        f"warning: the program reads port 2 ({place[0]}), but robot.toml has nothing plugged into "
        "port 2; add [ports.2]"
    ) in text
    assert "before the link" not in text


def test_a_reading_from_before_the_link_is_up_is_told(unchecked: FailingProgram) -> None:
    """A value that is read once at the start is that of an idle brick for ever."""
    text = "\n".join(output(unchecked, MAIN, "read_early"))
    assert re.search(
        r"warning: port 2 is read at \d+\.\d ms \(failing\.adb:\d+\), before the link to the "
        r"co-processor was up, which first answered at \d+\.\d ms: .* call "
        r"NXT\.AVR\.Await_Data_Available before",
        text,
    ), text


def test_another_device_than_the_drivers_is_told(unchecked: FailingProgram) -> None:
    """The template reads a touch sensor at port 1 and drives motor B."""
    toml = unchecked.project / "robot.toml"
    before = toml.read_text()
    try:
        toml.write_text(
            before.replace('device = "touch"', 'device = "light"').replace("[ports.B]", "[ports.C]")
        )
        scenario = unchecked.project / "scenarios" / "still.toml"
        head = (unchecked.project / "scenarios" / "press.toml").read_text().split("[[")[0]
        scenario.write_text(head.replace('name = "press"', 'name = "still"'))
        elf = unchecked.image(MAIN, "drive")
        run = ["run", str(unchecked.project), "still", "--elf", str(elf)]
        text = CliRunner().invoke(app, run).output
    finally:
        toml.write_text(before)
    assert re.search(
        r"warning: the program reads port 1 as a touch sensor \(tasks\.adb:\d+\), but robot\.toml "
        r'has device = "light" in \[ports\.1\]; correct one of both',
        text,
    ), text
    assert (
        "warning: the program drives motor B, but robot.toml has nothing plugged into port B; add "
        "[ports.B]"
    ) in text
