# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether what happened is a pass, a failure, or outside what the profile admits, and why.

A refusal is excluded only for a reason of the tables below; what they do not know is a failure.
"""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path

from verification.acats.build import BuildError
from verification.acats.execution import Verdict
from verification.acats.suite import AcatsTest

__all__ = ["is_only_ravenscar", "judge", "judge_refused"]

EXCLUSIONS = Path(__file__).resolve().parent / "exclusions.toml"

ONLY_RAVENSCAR = (
    *("No_Calendar", "No_Entry_Queue", "No_Implicit_Heap_Allocations", "No_Relative_Delay"),
    *("Simple_Barriers", "Max_Protected_Entries"),
)
"""Restrictions that the Jorvik profile does not have (Ada RM 2022 D.13 (6), (17))."""

BOTH_PROFILES = (
    *("No_Abort_Statements", "No_Asynchronous_Control", "No_Dynamic_Attachment"),
    *("No_Dynamic_CPU_Assignment", "No_Dynamic_Priorities", "No_Local_Protected_Objects"),
    *("No_Local_Timing_Events", "No_Protected_Type_Allocators", "No_Requeue_Statements"),
    *("No_Select_Statements", "No_Specific_Termination_Handlers", "No_Task_Allocators"),
    *("No_Task_Attributes_Package", "No_Task_Hierarchy", "No_Terminate_Alternatives"),
    *("Max_Asynchronous_Select_Nesting", "Max_Select_Alternatives", "Max_Task_Entries"),
    *("No_Implicit_Task_Allocations", "No_Implicit_Protected_Object_Allocations"),
    *("Pure_Barriers", "No_Exception_Propagation", "No_Finalization", "No_Streams"),
)
RESTRICTIONS = {name.lower(): name for name in (*ONLY_RAVENSCAR, *BOTH_PROFILES)}

ABSENT = (
    (r"ada\.calendar$|calendar$", "No_Calendar"),
    (r"ada\.calendar\.", "dates beyond Ada.Calendar: no time zones, no leap seconds"),
    (r"ada\.(asynchronous_task_control)", "No_Asynchronous_Control"),
    (r"ada\.dynamic_priorities", "No_Dynamic_Priorities"),
    (r"ada\.task_attributes", "No_Task_Attributes_Package"),
    (r"ada\.dispatching\.|ada\.execution_time\.(group|timers)",
     "No_Dependence on other policies, timers and group budgets (D.13)"),
    (r"ada\.(finalization|containers|strings\.(unbounded|wide_))|.*unbounded", "No_Finalization"),
    (r".*finalization|system\.(finalization|storage_pools\.subpools)", "No_Finalization"),
    (r"ada\.streams|system\.stream", "No_Streams"),
    (r"(ada\.)?(wide_)*(text|direct|sequential|storage)_io|.*_io$|ada\.(directories|command_line"
     r"|environment_variables|io_exceptions)|check_file|enum_check|length_check",
     "No_IO: no files, no command line"),
    (r"ada\.exceptions|.*exception_(name|message|information|identity|occurrence)|.*reraise.*"
     r"|system\.soft_links|.*save_occurrence", "No_Exception_Propagation"),
    (r"system\.tasking\.rendezvous", "Max_Task_Entries"),
    (r"system\.tasking\.(stages|async_delays|storage_size)", "No_Task_Hierarchy"),
    (r"system\.(relative_delays|calendar)", "No_Relative_Delay"),
    (r"system\.tasking\.protected_objects\.(entries|operations)", "Max_Protected_Entries"),
    (r"system\.interrupts\.(dynamic|static)", "No_Dynamic_Attachment"),
    (r"ada\.numerics\.(float|discrete)_random", "no random numbers in this run-time"),
    (r"ada\.(locales|strings\.utf_encoding)", "no locales and transformation formats"),
    (r"interfaces\.(cobol|fortran)", "optional interface to another language"),
    (r"system\.rpc", "no distribution"),
)  # fmt: skip
"""Units and entities that the run-time lacks, as the tools name them, and the reason."""


def _restriction(reason: str) -> str | None:
    """The restriction behind one reason of a refusal."""
    if match := re.match(r"restriction (\w+)", reason):
        return RESTRICTIONS.get(match.group(1).lower())
    if match := re.search(r'violation of implicit restriction "(\w+)', reason):
        return RESTRICTIONS.get(match.group(1).lower())
    if re.search(r'not declared in "(Ada\.)?Exceptions"', reason):
        return "No_Exception_Propagation"
    if match := re.search(r'"(\w+_Handler)" not declared in "(Ada\.)?Interrupts"', reason):
        return "No_Dynamic_Attachment"
    match = re.match(r"absent (?:unit|entity) (\S+)", reason) or re.match(
        r'"(\w+)" is undefined', reason
    )
    if match:
        name = match.group(1).lower()
        return next((text for pattern, text in ABSENT if re.match(pattern, name)), None)
    return None


@cache
def _exclusions() -> dict[str, str]:
    return {name: str(text) for name, text in tomllib.loads(EXCLUSIONS.read_text()).items()}


def is_only_ravenscar(reason: str) -> bool:
    """Whether the reason of an exclusion does not hold for Jorvik."""
    return reason in ONLY_RAVENSCAR


def judge(test: AcatsTest, found: BuildError | Verdict) -> tuple[str, str]:
    """Status and reason."""
    if isinstance(found, BuildError):
        known = [x for x in map(_restriction, found.reasons) if x]
        lasting = [x for x in known if x not in ONLY_RAVENSCAR]
        if known:
            return "excluded", (lasting or known)[0]
        text = str(found)
        if re.search(r"will not fit in region|overflowed by", text):
            return "excluded", "more data than the chip has memory"
    elif found.word in {"passed", "tentative"}:
        return "passed", ""
    elif found.word == "inapplicable":
        return "excluded", f"inapplicable: {found.text.splitlines()[-1][2:]}"
    elif found.word in {"raised", "silent"} and found.removed_handlers:
        return "excluded", "No_Exception_Propagation"
    else:
        text = f"{found.word}: {found.text} ({found.removed_handlers} handlers removed)"
    if test.name in _exclusions():
        return "excluded", _exclusions()[test.name]
    return "failed", text.replace("\n", " ").strip()


def judge_refused(test: AcatsTest, found: BuildError | Verdict) -> tuple[str, str]:
    """A program that violates a restriction passes by being refused for it."""
    if isinstance(found, Verdict):
        return "failed", f"not refused: {found.word}"
    named = [x for x in found.reasons if "estriction" in x]
    behind = [f"restriction {x}" for x in map(_restriction, found.reasons) if x]
    if refused := named or sorted(set(behind)):
        return "passed", f"refused at {found.step}: {'; '.join(refused)}"
    return "failed", f"{test.name} refused for another reason: {found}"
