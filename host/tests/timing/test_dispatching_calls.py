# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Dispatching calls of Ada: bounded with the targets that runs show, or asked for with a reason."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ravenbrick.image.build import TOOLS, find_tool

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)
if any(find_tool(tool) is None for tool in TOOLS):
    pytest.skip("the cross toolchain is not installed", allow_module_level=True)

from verification.support.timing.programs import analysed, subject

from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.dispatch import dispatching_calls
from ravenbrick.timing.dispatch.ada_library import read_library
from ravenbrick.timing.dispatch.dispatch_code import DispatchCode
from ravenbrick.timing.dispatch.dispatching_calls import DispatchingCalls
from ravenbrick.timing.facts.counted_facts import points_text
from ravenbrick.timing.facts.facts import annotations_of
from ravenbrick.timing.observation.fact_counts import fact_counts
from ravenbrick.timing.observation.observed import exceeded, observe

FOLDER = b"build/verification/dispatching"
SHORT = "devices__kinds__start"
LONG = "a_name_of_its_own"  # of Nested.Long, inherited by Longest
SLOW, LAMP, SEND = (f"devices__kinds__{name}" for name in ("read", "read__2", "send"))


def derived(image: ElfImage) -> list[set[str]]:
    """Targets of each call that has been found, by address; thunks without their numbers."""
    rows = tomllib.loads(DispatchingCalls(image.path, image.content).facts()[1]).get("call", [])
    return [{re.sub(r"T\d+s$", "thunk", name) for name in row["targets"]} for row in rows]


TARGETS: dict[str, list[set[str]]] = {
    # The line of this instruction has a call of Start only: a call of Read was joined to it.
    "joined": [{SHORT, LONG, SLOW, LAMP}],
    "one_line": [{SHORT, LONG, SLOW, LAMP}] * 2,
    "levels": [{"devices__rest"}, {SHORT, LONG}],
    # A type whose parent is the interface has its operation in its own table.
    "signals": [{LAMP, SEND, "devices__kinds__thunk"}],
    "guarded": [{"values__send", "values__thunk"}],
    "class_wide": [{SHORT, LONG}],
}
# In a debugging build, the ceiling of the protected type in "guarded" is computed.
DEBUGGING = [(program, "-O0") for program in TARGETS if program != "guarded"]


@pytest.mark.parametrize("build", [*((program,) for program in TARGETS), *DEBUGGING])
def test_calls_are_bounded_with_all_targets_that_a_run_shows(build: tuple[str, ...]) -> None:
    found, expected = subject("dispatching", *build), TARGETS[build[0]]
    targets = derived(found.image)
    assert all(each in targets for each in expected)
    assert all(each in expected for each in targets)
    analysis = analysed(found, found.facts)
    target = VirtualTarget(flow_points=points_text(analysis.counted))
    recording = target.run(found.robot, found.scenario, found.image)
    observed = observe(found.robot, recording)
    assert exceeded(analysis, observed) == []
    (task,) = analysis.tasks
    assert task.job.cycles < 2 * observed["environment"].execution_cycles
    counts = fact_counts(found.robot, found.facts, found.image, analysis.counted, recording)
    assert [count.excess for count in counts if count.excess] == []
    calls = [count for count in counts if count.fact.startswith("dispatch tables: [[call]]")]
    assert len(calls) == len(targets)


@pytest.mark.parametrize(
    ("program", "place", "reason"),
    [
        ("called_back", "called_back.adb:16", "callbacks declares an access-to-subprogram type"),
        ("fired", "fired.adb:14", "handlers names what ada.interrupts declares"),
        ("local", "devices.adb:16", "local extends a type in a subprogram"),
        ("made_anew", "made_anew.adb:14", "the code does not show the number of the word"),
        ("placed", "placed.adb:16", "the code does not show the number of the word"),
        ("tested", "tested.adb:23", "the code does not show the number of the word"),
    ],
)
def test_other_calls_are_asked_for_with_the_reason(program: str, place: str, reason: str) -> None:
    found = subject("dispatching", program)
    with pytest.raises(ExecutionTimeError, match=place) as asked:
        analysed(found, found.facts)
    assert f"dispatch tables do not tell them: {reason}" in asked.value.detail


def test_facts_about_calls_over_one_branch_are_counted_each_for_its_own_call() -> None:
    """The calls of Thumb code here share one `bx r3`, whose line is that of the last one."""
    found = subject("dispatching", "levels", "-mthumb")

    def excess(*started: str) -> list[str]:
        lines = {18: sorted(started), 19: ["devices__rest"]}
        rows: list[dict[str, object]] = [
            {"file": "levels.adb", "line": line, "targets": targets, "reason": "a test"}
            for line, targets in lines.items()
        ]
        facts = replace(found.facts, annotations=annotations_of({"call": rows}))
        counted = analysed(found, facts).counted
        target = VirtualTarget(flow_points=points_text(counted))
        recording = target.run(found.robot, found.scenario, found.image)
        counts = fact_counts(found.robot, facts, found.image, counted, recording)
        assert sum("[[call]]" in count.fact for count in counts) == len(rows)
        return [count.excess for count in counts if count.excess]

    assert excess(SHORT, LONG) == []
    (told,) = excess(SHORT)
    assert f"seen the target {LONG} at" in told and told.endswith("levels.adb:18")


def test_library_files_that_are_not_those_of_the_image_are_not_used(tmp_path: Path) -> None:
    image = subject("dispatching", "levels").image
    assert derived(image)
    copy = tmp_path / "old.elf"
    copy.write_bytes(image.content)
    os.utime(copy, (0, 0))
    assert derived(replace(image, path=copy)) == []
    moved = image.content.replace(FOLDER, FOLDER[:-1] + b"x")
    assert derived(replace(image, content=moved)) == []


def test_the_bound_of_one_function_uses_the_same_tables(tmp_path: Path) -> None:
    def wcet(file: Path, *options: str) -> dict[str, Any]:
        command = ["wcet", str(file), "devices__run", *options, "--json"]
        found: dict[str, Any] = json.loads(CliRunner().invoke(app, command).stdout)
        return found

    image = subject("dispatching", "class_wide").image
    (tmp_path / "facts.toml").write_text(
        f'[[call]]\nsymbol = "devices__run"\ntargets = ["{SHORT}", "{LONG}"]\nreason = "both"\n'
    )
    stated = wcet(image.path, "--annotations", str(tmp_path / "facts.toml"))
    assert wcet(image.path)["cycles"] == stated["cycles"]
    elsewhere = tmp_path / "elsewhere.elf"
    elsewhere.write_bytes(image.content.replace(FOLDER, FOLDER[:-1] + b"x"))
    asked = wcet(elsewhere)
    assert asked["exit_code"] == ExitCode.NO_TIMING_BOUND
    assert "class_wide.ali is missing" in asked["detail"]


def test_library_files_of_another_compiler_are_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    image = subject("dispatching", "levels").image
    monkeypatch.setattr(dispatching_calls, "COMPILER", "GNAT Lib v13")
    assert derived(image) == []


def calls(instructions: list[int], *addresses: int) -> list[tuple[int, set[int]]]:
    """Calls in instructions from address 0 on, beside words that hold these addresses."""
    words = dict(enumerate(instructions))
    words = {4 * number: word for number, word in words.items()}
    beside = {0x1000 + 4 * number: word for number, word in enumerate(addresses)}
    return list(DispatchCode(words | beside, words, [0]).calls(0, 4 * len(instructions)))


TAG, OPERATION, TEST, CHAIN, CODE, BRANCH = CALL = [
    0xE590_3000,  # ldr r3, [r0]
    0xE593_4014,  # ldr r4, [r3, #20]
    0xE314_0002,  # tst r4, #2
    0x1514_C002,  # ldrne ip, [r4, #-2]
    0x1594_4002,  # ldrne r4, [r4, #2]
    0xE12F_FF14,  # bx r4
]
OTHER = 0xE593_4008  # ldr r4, [r3, #8]


def test_the_number_of_the_word_is_told_by_all_ways_to_the_branch() -> None:
    assert calls(CALL) == [(20, {5})]
    # beq over one load to the other one; and with a load that an instruction between them replaces
    assert calls([TAG, OTHER, 0x0A00_0000, *CALL[1:]]) == [(28, {2, 5})]
    assert calls([TAG, 0xE3A0_4000, 0x0A00_0000, *CALL[1:]]) == []
    # ldrne r4, [r3, #8] and ldreq r4, [r3, #20]: one of them is executed; not if a cmp is between
    either = [TAG, 0x1593_4008, 0x0593_4014, *CALL[2:]]
    assert calls(either) == [(24, {2, 5})]
    assert calls([*either[:2], 0xE350_0000, *either[2:]]) == []
    for address in range(4, 4 * len(CALL), 4):
        assert calls(CALL, address) == []  # perhaps the target of a jump that is not seen


def test_a_way_over_a_jump_backwards_counts_too() -> None:
    """The other load, behind the call, jumps back to the test."""
    there, back = 0x0A00_0004, 0xEAFF_FFF9  # beq to `OTHER`, b to `TEST`
    assert calls([TAG, there, *CALL[1:], OTHER, back]) == [(24, {2, 5})]


@pytest.mark.parametrize("register", range(15))
@pytest.mark.parametrize(
    "call",
    [
        [0xEB00_0100],  # bl
        [0xE1A0_E00F, 0xE12F_FF11],  # mov lr, pc; bx r1
        [0xE1A0_E00F, 0xE12F_FF12],  # the same with r2
    ],
)
def test_a_tag_outlives_a_call_where_the_procedure_call_standard_says(
    register: int, call: list[int]
) -> None:
    """In r4 to r11 and in the stack pointer (AAPCS, section 6.1.1)."""
    load = 0xE590_0000 | register << 12
    operation = 0xE590_4014 | register << 16
    found = calls([load, *call, operation, *CALL[2:]])
    assert (found == [(20 + 4 * len(call), {5})]) == (4 <= register <= 11 or register == 13)


WRITE_R3 = [
    0xE1A0_3001,  # mov r3, r1
    0xE003_0291,  # mul r3, r1, r2
    0xE003_0192,  # mul r3, r2, r1
    0xE023_0291,  # mla r3, r1, r2, r0
    0xE083_5291,  # umull r5, r3, r1, r2
    0xE085_3192,  # umull r3, r5, r2, r1
    0xE1D1_30B2,  # ldrh r3, [r1, #2]
    0xE1F3_20B2,  # ldrh r2, [r3, #2]!
    0xE5B3_2004,  # ldr r2, [r3, #4]!
    0xE5A3_2004,  # str r2, [r3, #4]!
    0xE483_2004,  # str r2, [r3], #4
    0xE891_0008,  # ldm r1, {r3}
    0xE8B3_0004,  # ldm r3!, {r2}
    0xE10F_3000,  # mrs r3, cpsr
    0x1083_3001,  # addne r3, r3, r1
]
LEAVE_R3 = [
    0xE353_0000,  # cmp r3, #0
    0xE113_0001,  # tst r3, r1
    0xE002_0391,  # mul r2, r1, r3
    0xE583_2004,  # str r2, [r3, #4]
    0xE593_2004,  # ldr r2, [r3, #4]
    0xE881_0008,  # stm r1, {r3}
    0xE1A0_2003,  # mov r2, r3
]


@pytest.mark.parametrize("instruction", [*WRITE_R3, *LEAVE_R3])
def test_what_an_instruction_writes_is_as_the_architecture_says(instruction: int) -> None:
    """Encodings by hand (ARM DDI 0100I, chapter A3); an operand is not written."""
    found = calls([TAG, instruction, *CALL[1:]])
    assert found == ([] if instruction in WRITE_R3 else [(24, {5})])


@pytest.mark.parametrize(
    "instructions",
    [
        [0xE513_300C, *CALL[1:]],  # a predefined operation: ldr r3, [r3, #-12]
        [0xE59F_3000, *CALL[1:]],  # a constant: ldr r3, [pc]
        [TAG, OPERATION, BRANCH],  # an address: no descriptor is looked for
        [TAG, 0xE283_3004, *CALL[1:]],  # add r3, r3, #4
        [TAG, 0xE4B3_2004, *CALL[1:]],  # ldrt r2, [r3], #4
        [TAG, OPERATION, 0xE283_4004, *CALL[2:]],  # add r4, r3, #4
        [0xE3A0_4000, TAG, 0x1593_4014, *CALL[2:]],  # mov r4, #0 before ldrne r4, [r3, #20]
        [TAG, 0xEA00_0010, *CALL[1:]],  # b: what leads to the next instruction is not seen
    ],
)
def test_code_that_takes_something_else_than_a_word_of_a_table_is_not_taken_for_it(
    instructions: list[int],
) -> None:
    assert calls(instructions) == []


@pytest.mark.parametrize("line", ["1K9*Shapes 24-5", "* shapes", "1"])
def test_a_library_file_with_lines_that_are_not_understood_is_refused(
    line: str, tmp_path: Path
) -> None:
    path = tmp_path / "shapes.ali"
    path.write_text(f'V "GNAT Lib v12"\nD shapes.ads 20260101 0 shapes%s\nX 1 shapes.ads\n{line}\n')
    with pytest.raises(ValueError, match="is no"):
        read_library(path)
