# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many mutants of a Rust crate in one build: a function that has some chooses by the environment.

The body of such a function stands once for each of its mutants and once unchanged. Building a crate
takes many times as long as its tests, so that a campaign with one build for all takes a fraction.
What a run cannot choose is built by itself: constants, the functions that they call, types, and
what the compiler refuses.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

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
FUNCTION = re.compile(r"^([^\n]*)\bfn (\w+)", re.MULTILINE)
# A constant chooses nothing, so that a function that chooses is none of a constant's.
CONSTANT = re.compile(r"\bconst (?=(?:unsafe )?$)")
ERROR = re.compile(r"^error\b[^\n]*\n\s*--> (\S+?):(\d+):", re.MULTILINE)
OF_CONSTANT = re.compile(r"^error\[E0015\]: cannot call non-const [^\n`]*`([^`\n]+)`", re.MULTILINE)
GENERICS = re.compile(r"::<.*?>(?=::|$)")


@dataclass(frozen=True)
class Function:
    """The place of its `const `, if it has one, and its outer brackets."""

    name: str
    constant: tuple[int, int]
    start: int
    end: int


@dataclass(frozen=True)
class Combined:
    """A file with all of its mutants; of each the lines of its body and the function's name."""

    text: str
    lines: dict[int, tuple[int, int]]
    names: dict[int, str]


def _end(code: str, start: int) -> int:
    """Where the bracket at `start` is closed."""
    depth = 0
    for found in re.compile(r"[{}]").finditer(code, start):
        depth += 1 if found.group() == "{" else -1
        if depth == 0:
            return found.start()
    return len(code)


def _functions(code: str) -> list[Function]:
    """The outermost ones; closures that are returned differ in type, so that none may choose."""
    functions: list[Function] = []
    for found in FUNCTION.finditer(code):
        if functions and found.start() < functions[-1].end:
            continue
        depth, start = 0, found.end()
        while start < len(code) and (depth or code[start] not in "{;"):
            depth += (code[start] in "([") - (code[start] in ")]")
            start += 1
        if code[start : start + 1] == "{" and "-> impl" not in code[found.end() : start]:
            constant = CONSTANT.search(found[1])
            at = found.start()
            span = (at + constant.start(), at + constant.end()) if constant else (start, start)
            functions.append(Function(found[2], span, start, _end(code, start)))
    return functions


def combined(file: str, source: str, mutants: dict[int, Mutant]) -> Combined:
    """A source with those of the numbered mutants of its file that a run can choose."""
    inside: dict[Function, dict[int, Mutant]] = {
        function: {
            number: mutant
            for number, mutant in mutants.items()
            if mutant.file == file and function.start < mutant.start < function.end
        }
        for function in _functions(code_of(file, source))
    }
    made = Combined("", {}, {})
    text, at = "", 0
    for function, own in inside.items():
        if not own:
            continue
        (first, last), start, end = function.constant, function.start, function.end + 1
        text += source[at:first] + source[last:start] + "{"
        for number, mutant in own.items():
            line = text.count("\n") + 1
            changed = mutant.applied(source)
            block = changed[start : end + len(changed) - len(source)]
            text += f"if crate::chosen_mutant({number}) {block} else "
            made.lines[number] = (line, text.count("\n") + 1)
            made.names[number] = function.name
        text += source[start:end] + "}"
        at = end
    return replace(made, text=text + source[at:])


def refused_in(log: str, files: dict[str, Combined]) -> set[int]:
    """The mutants in whose bodies the compiler reports an error, or that a constant would call."""
    calls = {re.findall(r"\w+", GENERICS.sub("", path))[-1] for path in OF_CONSTANT.findall(log)}
    refused = {n for made in files.values() for n, name in made.names.items() if name in calls}
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
