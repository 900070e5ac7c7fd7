# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Execution-time and stack bounds, from the analysis in the module `virtual_brick`."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ravenbrick.errors import (
    ExitCode,
    ImageFileError,
    ProjectFileError,
    RavenbrickError,
    UsageError,
)
from ravenbrick.installation import brick_module

__all__ = [
    "Bound",
    "Bounds",
    "Call",
    "ExecutionTimeError",
    "JobQuestion",
    "StackBound",
    "deepest_of",
    "execution_times",
    "recursion_words",
    "stack_bounds",
]


JobQuestion = tuple[str, tuple[str, ...], tuple[str, ...]]

# Begin of the analysis' sentences about the ELF file itself.
DAMAGE = "ELF file: "
UNREAD = re.compile(r"(.*): TOML parse error at line (\d+), column \d+\n.*\n([^\n]+)\n*", re.DOTALL)


class ExecutionTimeError(RavenbrickError):
    """A function or a task has no bound; the sentence says what is missing and where."""

    exit_code = ExitCode.NO_TIMING_BOUND


@dataclass(frozen=True)
class Bound:
    """Bounds of a function, or of the jobs of a task; without the fetches after its return.

    `critical_sections` are the longest ones (protected actions): urgency and cycles. `reached` are
    all functions that may be executed, `reached_inside` those that a job calls before it waits for
    its next release in one of `released_by`. What runs in the background has no cycles, nor has a
    task that stays in a loop for ever without a wait, at the line `endless`. `stack_lost` and
    `stack_gap` are those of `StackBound`. `remaining` are, for each beginning of a name that was
    asked for, the most cycles from a call of such a function to the end, None where none is called.
    `outside_cycles` are the most between two waits of a task that are none of its jobs, if it is
    said to execute such code.
    """

    symbol: str
    cycles: int
    stack_bytes: int | None
    critical_sections: tuple[tuple[int, int], ...]
    reached: frozenset[str]
    report: dict[str, Any]
    graph: dict[str, Any] | None = None
    reached_inside: frozenset[str] = frozenset()
    released_by: frozenset[str] = frozenset()
    endless: str | None = None
    path: dict[str, Any] | None = None
    stack_lost: str | None = None
    stack_gap: str | None = None
    remaining: tuple[int | None, ...] = ()
    outside_cycles: int = 0

    def longest_critical_section(self, above_urgency: int) -> int:
        """Longest critical section above an urgency, in cycles."""
        longer = (cycles for urgency, cycles in self.critical_sections if urgency > above_urgency)
        return max(longer, default=0)


@dataclass(frozen=True)
class StackBound:
    """The stack of a function with all it calls; None without a bound. Then its depth is lost at
    the line `lost`, or `gap` says why the code cannot be followed and which fact is missing."""

    bytes: int | None
    lost: str | None = None
    gap: str | None = None


def deepest_of(stacks: Sequence[StackBound]) -> StackBound:
    """The deepest of stacks that are used one after the other; one without a bound first."""
    return max(stacks, key=lambda found: (found.bytes is None, found.bytes or 0))


@dataclass(frozen=True)
class Call:
    """A call with r0 to r3 where they are constants."""

    callee: str
    caller: str
    arguments: tuple[int | None, int | None, int | None, int | None]


@dataclass(frozen=True)
class Bounds:
    """Answers in the order of the questions.

    `effort` counts, for the bounds of functions and jobs: functions, blocks, loops,
    instructions, and steps, instructions executed on abstract values.
    """

    timing: str
    return_cycles: int
    functions: tuple[Bound, ...]
    jobs: tuple[Bound, ...]
    background: tuple[Bound, ...]
    calls: tuple[Call, ...]
    known_memory_cycles: int | None = None
    known_memory_lines: tuple[tuple[str, int], ...] = ()
    effort: dict[str, int] = field(default_factory=dict)
    stacks: tuple[StackBound, ...] = ()
    runs: tuple[dict[str, Any], ...] = ()
    outside: tuple[int, ...] = ()


def _question(loop: dict[str, Any], facts: str) -> str:
    """The question for a loop bound: where, in which calls, and the fact to paste."""
    file, _, line = loop["line"].rpartition(":")
    if line:
        fields = [f'file = "{file.rpartition("/")[2]}"', f"line = {line}"]
    else:
        fields = [f'symbol = "{loop["symbol"]}"', f"index = {loop['index']}"]
    callers = loop["callers"]
    if len(callers) > 1:
        # The outermost is what was asked for: with it, the fact would hold for all calls.
        fields.append(f'within = "{callers[-1]}"')
    chain = f", called by {', called by '.join(reversed(callers))}" if callers else ""
    fact = ["[[loop]]", *fields, "iterations = ...", 'reason = "..."']
    lines = [f"{loop['line'] or loop['symbol']}: how often at most{chain}? in {facts}:", *fact]
    return "\n  ".join(lines)


def _check_questions(answers: Sequence[dict[str, Any]], facts: str) -> None:
    """Asks for the missing loop bounds of all functions and jobs at once, each loop once."""
    asking = [answer for answer in answers if answer["missing"]]
    if not asking:
        return
    symbols = ", ".join(answer["symbol"] for answer in asking)
    missing = [loop for answer in asking for loop in answer["missing"]]
    questions = dict.fromkeys(_question(loop, facts) for loop in missing)
    error = ExecutionTimeError(
        f"{symbols}: loops without a bound; say in {facts} how often each is repeated",
        detail="\n".join(questions),
    )
    endless = [(answer["symbol"], answer["endless"]) for answer in answers]
    stuck = dict(found for found in endless if found[1] is not None)
    error.data = {"missing": missing, **({"endless": stuck} if stuck else {})}
    raise error


def _bound(answer: dict[str, Any]) -> Bound:
    if answer["error"] is not None:
        head, *detail = answer["error"].split("\n")
        raise ExecutionTimeError(f"{answer['symbol']}: {head}", detail="\n".join(detail))
    return Bound(
        answer["symbol"],
        answer["cycles"],
        answer["stack_bytes"],
        tuple((urgency, cycles) for urgency, cycles in answer["critical_sections"]),
        frozenset(answer["reached"]),
        answer["report"],
        answer["graph"],
        frozenset(answer["reached_inside"]),
        frozenset(answer["released_by"]),
        answer["endless"],
        answer["path"],
        answer["stack_lost"] or None,
        remaining=tuple(answer["remaining"]),
    )


def _stack(answer: dict[str, Any]) -> StackBound:
    gap = answer["error"]
    if gap is not None:
        gap = f"{answer['symbol']}: {gap}".replace("\n", ";")
    return StackBound(answer["stack_bytes"], answer["stack_lost"] or None, gap)


def _known_memory_cycles(answer: dict[str, Any] | None) -> int | None:
    if answer is None:
        return None
    if answer["error"] is not None:
        error = ExecutionTimeError(f"{answer['symbol']}: {answer['error']}")
        error.data = {"missing": answer["missing"]}
        raise error
    return int(answer["cycles"])


def _known_memory_lines(answer: dict[str, Any] | None) -> tuple[tuple[str, int], ...]:
    rows = [] if answer is None else answer["lines"]
    return tuple((row["line"], row["executions"]) for row in rows)


def recursion_words(report: dict[str, Any]) -> list[str]:
    """Recursive functions of a bound's report: each activation costs as much as the longest."""
    recursive = [found for found in report["functions"] if found["activations"]]
    words = [
        f"{found['symbol']} calls itself: the bound takes {found['activations']} activations, each "
        f"with the {found['cycles'] // found['activations']} cycles of the longest, so it is far "
        "above the time of a recursion whose activations differ"
        for found in recursive
    ]
    if len(recursive) > 1:
        names = " and ".join(found["symbol"] for found in recursive)
        words.append(
            f"if {names} call one another, their activations multiply: "
            "keep the [[recursion]] fact of one of them"
        )
    return words


def answer_of(
    elf: bytes, request: dict[str, Any], name: str, timing: str = "nominal", wait_states: int = 1
) -> dict[str, Any]:
    """What the analysis answers to a request about the image, which is called `name`.

    Raises `ImageFileError` for a wrong image, `ProjectFileError` for an annotation file that cannot
    be read, `UsageError` for another wrong annotation.
    """
    try:
        text = brick_module().bound_execution_times(elf, json.dumps(request), timing, wait_states)
    except ValueError as error:
        if str(error).startswith(DAMAGE):
            raise ImageFileError(f"{name}: {error}; it is damaged: build it again") from None
        if unread := UNREAD.fullmatch(str(error)):
            raise ProjectFileError(Path(unread[1]), int(unread[2]), "", unread[3]) from None
        raise UsageError(str(error)) from None
    return dict(json.loads(text))


def _tasks(questions: Sequence[JobQuestion]) -> list[dict[str, Any]]:
    return [
        {"body": body, "waits": list(waits), "otherwise": list(otherwise)}
        for body, waits, otherwise in questions
    ]


def execution_times(
    elf: bytes,
    *,
    functions: Sequence[str] = (),
    jobs: Sequence[JobQuestion] = (),
    background: Sequence[str] = (),
    outside: Sequence[JobQuestion] = (),
    outside_places: Sequence[dict[str, Any]] = (),
    stacks: Sequence[str] = (),
    annotations: Sequence[tuple[str, str]] = (),
    root: str | None = None,
    callees: Sequence[str] = (),
    graphs: bool = False,
    paths: bool = False,
    requesting: Sequence[str] = (),
    runs: Sequence[Sequence[tuple[int, int]]] = (),
    known_memory: tuple[Sequence[str], int] | None = None,
    inputs: Sequence[str | dict[str, Any]] = (),
    timing: str = "nominal",
    wait_states: int = 1,
    name: str = "the image",
) -> Bounds:
    """Bounds of functions, and of jobs as (body, functions in which the task waits, those in which
    it waits if its body calls none of these). `background` are functions that run beside the tasks
    and need not end: only their stack and their effects on others are bounded. Of `stacks` only the
    stack is, for which no loop needs a bound. `outside` are tasks, as jobs are, of which the most
    cycles between two waits that are no job are wanted; `outside_places` say where such code lies.

    `annotations` are names and TOML texts. With `root`, the arguments of all calls of `callees` in
    what it calls. With `graphs`, bounds bring the graphs of their longest paths, with `paths` the
    longest paths by source lines. `requesting` are beginnings of names of functions, of which
    bounds tell what is `remaining` from a call on. `runs` are sequences of executed instructions,
    each its address and cycles; their paths come in the same form.
    With `known_memory`, functions called one after the other and their stack pointer, the last of
    them is bounded as it is, with memory as the image says and written by nothing else, but for
    `inputs`, variables that may then have any content; `known_memory_lines` are the lines it
    executes. An input is a name, or a dictionary with `symbol`, `offset_bytes`, `size_bytes`,
    `element_bytes` and `range` (least and greatest element, without sign).

    Raises `ExecutionTimeError` when there is no bound, `ImageFileError` for a wrong image, which is
    called `name`, `ProjectFileError` or `UsageError` for a wrong annotation.
    """
    request = {
        "functions": list(functions),
        "jobs": _tasks(jobs),
        "outside": _tasks(outside),
        "outside_places": list(outside_places),
        "background": list(background),
        "stacks": list(stacks),
        "annotations": [{"name": name, "text": text} for name, text in annotations],
        "root": root,
        "callees": list(callees),
        "graphs": graphs,
        "paths": paths,
        "requesting": list(requesting),
        "runs": runs,
    }
    if known_memory is not None:
        request["known_memory"] = {
            "calls": list(known_memory[0]),
            "stack_pointer": known_memory[1],
            "inputs": [{"symbol": i} if isinstance(i, str) else i for i in inputs],
        }
    answer = answer_of(elf, request, name, timing, wait_states)
    facts = annotations[0][0] if annotations else "an annotation file"
    kinds = ("functions", "jobs", "background", "outside")
    _check_questions([found for kind in kinds for found in answer[kind]], facts)
    return Bounds(
        answer["timing"],
        answer["return_cycles"],
        tuple(_bound(found) for found in answer["functions"]),
        tuple(_bound(found) for found in answer["jobs"]),
        tuple(_bound(found) for found in answer["background"]),
        tuple(Call(c["callee"], c["caller"], tuple(c["arguments"])) for c in answer["calls"]),
        _known_memory_cycles(answer["known_memory"]),
        _known_memory_lines(answer["known_memory"]),
        answer["effort"],
        tuple(_stack(found) for found in answer["stacks"]),
        tuple(answer["runs"]),
        tuple(_bound(found).cycles for found in answer["outside"]),
    )


def stack_bounds(
    elf: bytes, symbols: Sequence[str], annotations: Sequence[tuple[str, str]]
) -> tuple[StackBound, ...]:
    """Stacks of functions with all they call, whatever time that takes."""
    return execution_times(elf, stacks=symbols, annotations=annotations).stacks
