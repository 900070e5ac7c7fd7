# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many mutants of a Rust crate in one build: a function that has some chooses by the environment.

The body of such a function stands once for each of its mutants and once unchanged. Building a crate
takes many times as long as its tests, so that a campaign with one build for all takes a fraction.
What a run cannot choose is built by itself: constants, types, `const fn`, and what the compiler
refuses.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from verification.mutation.mutants import Mutant, code_of
from verification.mutation.rooms import Room
from verification.mutation.scratch import Scratch

__all__ = ["Combined", "combined", "one_build", "refused_in"]

VARIABLE = "RAVENBRICK_MUTANT"
CHOICE = f"""
/// Whether this run is the mutant's.
#[doc(hidden)]
pub(crate) fn chosen_mutant(number: u32) -> bool {{
    static CHOSEN: std::sync::LazyLock<Option<u32>> = std::sync::LazyLock::new(|| {{
        std::env::var("{VARIABLE}").ok().and_then(|text| text.parse().ok())
    }});
    *CHOSEN == Some(number)
}}
"""
# A function that a run may choose in; none in constants, and closures that are returned differ.
FUNCTION = re.compile(r"^([^\n]*)\bfn \w+", re.MULTILINE)
FIXED = re.compile(r"\b(?:const|async|extern)\b")
ERROR = re.compile(r"^error\b[^\n]*\n\s*--> (\S+?):(\d+):", re.MULTILINE)


@dataclass(frozen=True)
class Combined:
    """A file with all of its mutants, and the lines from and to which each has its body."""

    text: str
    lines: dict[int, tuple[int, int]]


def _end(code: str, start: int) -> int:
    """Where the bracket at `start` is closed."""
    depth = 0
    for found in re.compile(r"[{}]").finditer(code, start):
        depth += 1 if found.group() == "{" else -1
        if depth == 0:
            return found.start()
    return len(code)


def _bodies(code: str) -> list[tuple[int, int]]:
    """Opening and closing bracket of each outermost function that may choose."""
    bodies: list[tuple[int, int]] = []
    for found in FUNCTION.finditer(code):
        if bodies and found.start() < bodies[-1][1]:
            continue
        depth, start = 0, found.end()
        while start < len(code) and (depth or code[start] not in "{;"):
            depth += (code[start] in "([") - (code[start] in ")]")
            start += 1
        between = code[found.end() : start]
        if code[start : start + 1] == "{":
            fixed = FIXED.search(found[1]) or "-> impl" in between
            bodies.append((start, start if fixed else _end(code, start)))
    return bodies


def combined(file: str, source: str, mutants: dict[int, Mutant]) -> Combined:
    """A source with those of the numbered mutants of its file that a run can choose."""
    bodies = _bodies(code_of(file, source))
    inside: dict[tuple[int, int], list[tuple[int, Mutant]]] = defaultdict(list)
    for number, mutant in mutants.items():
        for body in bodies:
            if mutant.file == file and body[0] < mutant.start and mutant.end <= body[1]:
                inside[body].append((number, mutant))
    text, at, lines = "", 0, {}
    for (start, end), own in sorted(inside.items()):
        text += source[at:start] + "{"
        for number, mutant in own:
            first = text.count("\n") + 1
            changed = mutant.applied(source)
            block = changed[start : end + 1 + len(changed) - len(source)]
            text += f"if crate::chosen_mutant({number}) {block} else "
            lines[number] = (first, text.count("\n") + 1)
        text += source[start : end + 1] + "}"
        at = end + 1
    return Combined(text + source[at:], lines)


def refused_in(log: str, files: dict[str, Combined]) -> set[int]:
    """The mutants in whose bodies the compiler reports an error."""
    refused: set[int] = set()
    for path, line in ERROR.findall(log):
        for file, made in files.items():
            if file.endswith(path):
                within = (n for n, (a, b) in made.lines.items() if a <= int(line) <= b)
                refused.update(within)
    return refused


@contextmanager
def one_build(
    room: Room, scratch: Scratch, mutants: Sequence[Mutant], limit_s: float
) -> Iterator[dict[Mutant, str]]:
    """Build a crate with all mutants that a run can choose; the command that tests each of them.

    The files are as before afterwards.
    """
    root = f"{room.sources}/lib.rs"
    files = {root, *(mutant.file for mutant in mutants)}
    sources = {file: (scratch.tree / file).read_text("utf-8") for file in files}
    numbered = dict(enumerate(mutants, 1))
    try:
        while numbered:
            made = {file: combined(file, text, numbered) for file, text in sources.items()}
            for file, one in made.items():
                text = one.text + (CHOICE if file == root else "")
                (scratch.tree / file).write_text(text, "utf-8")
            chosen = {n: numbered[n] for one in made.values() for n in one.lines}
            if scratch.run(room.build, limit_s)[0]:
                break
            refused = refused_in(scratch.log.read_text(errors="replace"), made)
            numbered = {n: m for n, m in chosen.items() if refused and n not in refused}
        yield {m: f"export {VARIABLE}={n}; {room.test}" for n, m in numbered.items() if n in chosen}
    finally:
        for file, text in sources.items():
            (scratch.tree / file).write_text(text, "utf-8")
