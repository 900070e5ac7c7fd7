# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exceptions, assertions and the last-chance handler."""

from __future__ import annotations

import re

import pytest

from verification.support.bricks.runtime_programs import PROGRAMS, Runner, is_in


def line_of(program: str, mark: str) -> int:
    """Line of the source of `program` that holds `mark`."""
    source = (PROGRAMS / program / f"{program}.adb").read_text().split("\n")
    return 1 + source.index(next(text for text in source if mark in text))


class TestFailures:
    def test_a_range_violation_reaches_the_hook_with_file_and_line(self, run: Runner) -> None:
        """The hook of the drivers is called once, then the processor halts."""
        result = run("range_check")
        source = (PROGRAMS / "range_check" / "failing_task.adb").read_text()
        line = 1 + source.split("\n").index(
            next(text for text in source.split("\n") if "the failing line" in text)
        )
        assert result.journal() == "0123456789!"
        assert result.failure() == ("failing_task.adb", line)
        assert result.text_at(result.brick.read_int("hook_message", "u32")) == "failing_task.adb"
        assert result.brick.read_int("hook_line", "i32") == line
        assert result.stop.reason == "halted"

    def test_a_raise_statement_gives_its_message(self, run: Runner) -> None:
        """Without a hook the processor halts all the same."""
        result = run("raise_statement")
        assert result.failure() == ("words of the programmer", 0)
        assert result.stop.reason == "halted"

    @pytest.mark.parametrize(
        ("program", "journal"),
        [("failed_assertion", "a"), ("failed_contract", "a"), ("failed_precondition", "9")],
    )
    def test_a_failed_assertion_tells_file_and_line(
        self, run: Runner, program: str, journal: str
    ) -> None:
        """pragma Assert, Post and Pre, when the assertion policy has them checked."""
        result = run(program)
        assert result.journal() == journal
        assert result.failure() == (f"{program}.adb", line_of(program, "the failing line"))
        assert result.stop.reason == "halted"

    @pytest.mark.parametrize("culprit", ["Pilot_Above_Ceiling", "Nameless_Task", "Handler_Of_TC1"])
    def test_the_context_of_a_failure_says_who_failed(self, run: Runner, culprit: str) -> None:
        """Task, handler by the source (datasheet, table 10-1: TC1 is 13), priority and object."""
        specification = (PROGRAMS / "who_failed" / "culprits.ads").read_text()
        kinds = re.findall(r"\w+", specification.split("is (", 1)[1].split(")", 1)[0])
        result = run("who_failed", values={"chosen": kinds.index(culprit)})
        address, size = result.brick.symbol("described")
        text = result.brick.read_memory(address, size).decode("ascii")
        *words, last = (text[start : start + 24].rstrip() for start in range(0, size, 24))
        if culprit == "Handler_Of_TC1":
            assert [*words, last] == ["interrupt 13", "", "", ""]
        elif culprit == "Nameless_Task":
            assert words[1:] == ["priority 9", ""] and last == ""
            kind, address_of_task = words[0].split()
            assert kind == "task" and len(address_of_task) == 8
            assert is_in(result, "culprits__nameless", int(address_of_task, 16))
        else:
            assert words == ["task pilot", "priority 12", "ceiling 10"]
            kind, address_of_object = last.split()
            assert kind == "object" and len(address_of_object) == 8
            assert is_in(result, "culprits__low", int(address_of_object, 16))

    def test_the_message_of_an_assertion_takes_the_place_of_its_file(self, run: Runner) -> None:
        """The compiler passes nothing else, even when the message ends with a number."""
        assert run("assertion_message").failure() == ("journal has 1", 0)

    def test_a_local_handler_takes_an_exception(self, run: Runner) -> None:
        """A handled exception goes on after the handler, an unhandled one halts."""
        result = run("local_handler")
        assert result.journal() == "acd"
        text, line = result.failure() or ("", 0)
        assert text == "local_handler.adb"
        assert line == 24
