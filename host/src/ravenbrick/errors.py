# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What can go wrong in the user's hands: one sentence each, and an exit code.

The texts say what was expected and what to do. The command line prints the sentence without a
traceback and ends with `exit_code`.
"""

from __future__ import annotations

import os
from enum import IntEnum
from pathlib import Path
from typing import Any

__all__ = [
    "BrickDiffersError",
    "BuildError",
    "ConnectionFailedError",
    "CriteriaError",
    "DeadlineError",
    "DesignError",
    "ExitCode",
    "ImageFileError",
    "InterruptError",
    "PeerError",
    "ProjectFileError",
    "RavenbrickError",
    "RecordError",
    "RunFaultError",
    "ScenarioError",
    "ToolMissingError",
    "UsageError",
    "printable",
    "shown_path",
]


class ExitCode(IntEnum):
    """Exit codes of every command; `meaning` is the documented sentence."""

    meaning: str

    def __new__(cls, value: int, meaning: str) -> ExitCode:
        """Attach the documented sentence to the code."""
        member = int.__new__(cls, value)
        member._value_ = value
        member.meaning = meaning
        return member

    OK = 0, "Done."
    INTERNAL = 1, "An internal error of Ravenbrick: please report it with the printed text."
    USAGE = 2, "The command line is wrong: unknown command, option, folder or argument."
    PROJECT_FILE = 3, "robot.toml or a scenario file is wrong; file, line and field are named."
    TOOL_MISSING = 4, "A tool or module is missing; 'ravenbrick doctor' says how to install it."
    BUILD_FAILED = 5, "The compiler, binder or linker reported an error."
    BAD_IMAGE = 6, "The image or self-test record is missing, truncated, too large or a wrong one."
    RUN_FAULT = 7, "The program failed on the brick with an exception, a fault or a stack overflow."
    CRITERIA_NOT_MET = 8, "The run finished, but a pass criterion of the scenario is not met."
    SCENARIO_UNREACHABLE = 9, "The scenario cannot run: a file or an instant is missing."
    DESIGN_FAILED = 10, "design.py failed or wrote no design."
    CONNECTION_FAILED = 11, "No real brick was found, or the transfer to it failed."
    NO_TIMING_BOUND = 12, "A time has no bound; the missing flow fact is named."
    BRICK_DIFFERS = 13, "The brick differs from the virtual brick; rows and parameters are named."
    DEADLINE_CAN_BE_MISSED = (
        14,
        "A deadline can be missed, or a stack may overflow or has no bound.",
    )
    INTERRUPTED = 130, "Interrupted from the keyboard."


class RavenbrickError(Exception):
    """An error with a sentence for the user.

    `detail` holds further lines, such as the end of a compiler's output; `data` what `--json`
    prints besides.
    """

    exit_code = ExitCode.INTERNAL

    def __init__(self, sentence: str, *, detail: str = "") -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.detail = detail
        self.data: dict[str, Any] = {}


class UsageError(RavenbrickError):
    """A wrong argument on the command line."""

    exit_code = ExitCode.USAGE


class ProjectFileError(RavenbrickError):
    """A project file is wrong at `line` (1-based) in `field` (dotted path)."""

    exit_code = ExitCode.PROJECT_FILE

    def __init__(self, path: Path, line: int, field: str, problem: str) -> None:
        place = f"{shown_path(path)}:{line}: " + (f"{field}: " if field else "")
        super().__init__(place + problem)
        self.path = path
        self.line = line
        self.field = field
        self.problem = problem


class RecordError(RavenbrickError):
    """The record of a self-test cannot be used."""

    exit_code = ExitCode.BAD_IMAGE


class BrickDiffersError(RavenbrickError):
    """A real brick behaves otherwise than the virtual one; `data` holds the comparison."""

    exit_code = ExitCode.BRICK_DIFFERS


class ToolMissingError(RavenbrickError):
    """A program or module that the command needs is not installed."""

    exit_code = ExitCode.TOOL_MISSING


class BuildError(RavenbrickError):
    """The image could not be built."""

    exit_code = ExitCode.BUILD_FAILED


class ImageFileError(RavenbrickError):
    """The image cannot be loaded."""

    exit_code = ExitCode.BAD_IMAGE


class RunFaultError(RavenbrickError):
    """The program did not survive its run."""

    exit_code = ExitCode.RUN_FAULT


class CriteriaError(RavenbrickError):
    """A pass criterion is not met."""

    exit_code = ExitCode.CRITERIA_NOT_MET


class ScenarioError(RavenbrickError):
    """The scenario can never take place as written."""

    exit_code = ExitCode.SCENARIO_UNREACHABLE


class PeerError(RavenbrickError):
    """A Bluetooth or USB peer of the brick did not get what it waited for."""

    exit_code = ExitCode.SCENARIO_UNREACHABLE


class DesignError(RavenbrickError):
    """The controller's design failed."""

    exit_code = ExitCode.DESIGN_FAILED


class InterruptError(RavenbrickError):
    """Ctrl-C; `data` holds what was done before."""

    exit_code = ExitCode.INTERRUPTED

    def __init__(self, **data: Any) -> None:
        super().__init__("interrupted")
        self.data = data


class DeadlineError(RavenbrickError):
    """A deadline can be missed, or a stack may overflow or has no bound; `data` holds the
    analysis."""

    exit_code = ExitCode.DEADLINE_CAN_BE_MISSED


class ConnectionFailedError(RavenbrickError):
    """A real brick cannot be reached or used."""

    exit_code = ExitCode.CONNECTION_FAILED


def printable(text: str) -> str:
    """Lines that any terminal shows as they are: what could command it, or hide text, is '?'."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text.expandtabs(1))


def shown_path(path: str | Path) -> str:
    """A path as the user would type it from where they stand: relative, unless that is longer."""
    relative, absolute = os.path.relpath(path), os.path.abspath(path)
    return relative if len(relative) <= len(absolute) else absolute
