# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exceptions, assertions and the last-chance handler."""

from __future__ import annotations

import pytest

from verification.support.bricks.runtime_programs import PROGRAMS, Runner


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
