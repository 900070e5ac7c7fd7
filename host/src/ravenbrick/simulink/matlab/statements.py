# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions in MATLAB's language as statements; nothing is run."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ravenbrick.simulink.expressions import Apply, Infix, Name, Rows, Tree, parse

__all__ = [
    "Assign",
    "Branches",
    "Function",
    "Loop",
    "Persistent",
    "Statement",
    "functions",
    "split",
]

_DEEPEST = 40
_HEAD = re.compile(
    r"function\s+(?:(?:\[(?P<many>[^\]]*)\]|(?P<one>[A-Za-z]\w*))\s*=\s*)?"
    r"(?P<name>[A-Za-z]\w*)\s*(?:\((?P<inputs>[^)]*)\))?\Z"
)
_SHOWN = re.compile(
    r"(?:disp|display|fprintf|clc|close|figure|plot|coder\.\w+|clear\w*|hold|grid)\b(?!\s*=[^=])"
)
_KEYWORD = re.compile(r"(if|elseif|else|switch|case|otherwise|for|while|end|return|persistent|"
                      r"global|break|continue|try|catch|parfor|function)\b\s*")  # fmt: skip


@dataclass(frozen=True)
class Assign:
    """`name = value`, `name(places) = value`, or several names for the outputs of one call.

    A name of `~` takes nothing.
    """

    line: int
    targets: tuple[Tree, ...]
    value: Tree


@dataclass(frozen=True)
class Branches:
    """`if` or `switch`: conditions with what belongs to them; that of `else` is None."""

    line: int
    cases: tuple[tuple[Tree | None, tuple[Statement, ...]], ...]


@dataclass(frozen=True)
class Loop:
    """`for name = values`."""

    line: int
    name: str
    values: Tree
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Persistent:
    """Variables that keep their values from call to call."""

    line: int
    names: tuple[str, ...]


Statement = Assign | Branches | Loop | Persistent


@dataclass(frozen=True)
class Function:
    """A function of a file, `line` its own."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    body: tuple[Statement, ...]
    line: int


def split(text: str) -> Iterator[tuple[int, str]]:
    """Statements with their lines, without comments; brackets may go over several lines."""
    text = re.sub(r"(?ms)^\s*%\{\s*$.*?^\s*%\}\s*$", lambda m: "\n" * m[0].count("\n"), text)
    current, depth, first = "", 0, 1
    for number, line in enumerate(text.splitlines(), 1):
        bare = re.sub(r"('[^']*')|\.\.\..*|%.*", _without_comment, line)
        for sign in f"{bare}\n":
            depth += (sign in "([{") - (sign in ")]}")
            if not current.strip():
                first = number
            if sign in ";,\n" and depth <= 0 and not (sign == "\n" and bare.endswith("...")):
                if current.strip():
                    yield first, current.strip()
                current, depth = "", 0
            elif sign == "\n":
                current = current.removesuffix("...") + ("" if bare.endswith("...") else ";")
            else:
                current += sign
    if current.strip():
        yield first, current.strip()


def _without_comment(match: re.Match[str]) -> str:
    return match[1] or ("..." if match[0].startswith("...") else "")


def functions(text: str) -> dict[str, Function]:
    """The functions of a file in order; raises `ValueError` with the line of what is not read."""
    reader = _Reader(list(split(text)))
    return reader.functions()


class _Reader:
    def __init__(self, statements: list[tuple[int, str]]) -> None:
        self._waiting = statements
        self._place = 0
        self._depth = 0

    def functions(self) -> dict[str, Function]:
        found: dict[str, Function] = {}
        while self._place < len(self._waiting):
            line, text = self._waiting[self._place]
            self._place += 1
            head = _HEAD.match(text)
            if head is None:
                raise ValueError(f"line {line}: expected a function, found '{text[:40]}'")
            many = head["many"] if head["many"] is not None else head["one"] or ""
            body = self._block(("function", "end"), whole=True)
            if self._word() == "end":
                self._place += 1
            inputs, outputs = (tuple(re.findall(r"\w+|~", part))
                               for part in (head["inputs"] or "", many))  # fmt: skip
            found.setdefault(head["name"], Function(head["name"], inputs, outputs, body, line))
        return found

    def _word(self) -> str:
        """The keyword that the next statement begins with."""
        if self._place == len(self._waiting):
            return ""
        match = _KEYWORD.match(self._waiting[self._place][1])
        return match[1] if match else ""

    def _block(self, ends: tuple[str, ...], *, whole: bool = False) -> tuple[Statement, ...]:
        """Statements up to one of these words, which stays; `whole` of a function."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ValueError(f"statements nested more than {_DEEPEST} deep")
        found: list[Statement] = []
        while self._word() not in ends:
            if self._place == len(self._waiting):
                if whole:
                    break
                raise ValueError(f"line {self._waiting[-1][0]}: an 'end' is missing")
            line = self._waiting[self._place][0]
            try:
                found += self._statement(last=whole)
            except ValueError as error:
                text = str(error)
                raise ValueError(text if text.startswith("line ") else f"line {line}: {text}") \
                    from error  # fmt: skip
        self._depth -= 1
        return tuple(found)

    def _statement(self, *, last: bool) -> list[Statement]:
        line, text = self._waiting[self._place]
        word = self._word()
        rest = text[len(word) :].strip()
        if word in ("if", "switch"):
            return [self._branches(line, word)]
        self._place += 1
        if word == "for":
            match = re.match(r"\(?\s*([A-Za-z]\w*)\s*=(.*)\Z", rest, re.DOTALL)
            if match is None:
                raise ValueError(f"'{text}' is not understood")
            values = match[2].strip()
            values = values[:-1] if rest.startswith("(") and values.endswith(")") else values
            body = self._block(("end",))
            self._place += 1
            return [Loop(line, match[1], parse(values), body)]
        if word == "persistent":
            return [Persistent(line, tuple(rest.split()))]
        if word == "return" and last and self._word() in ("", "end", "function"):
            return []
        if word:
            raise ValueError(f"the statement '{word}' has no counterpart in a diagram")
        return _assignment(line, text)

    def _branches(self, line: int, word: str) -> Branches:
        """`if` with its branches; `switch` becomes comparisons."""
        chosen: Tree | None = None
        if word == "switch":
            chosen = parse(self._waiting[self._place][1].removeprefix("switch"))
            self._place += 1
            if self._word() not in ("case", "otherwise"):
                raise ValueError("expected 'case' after 'switch'")
        words = ("case", "otherwise", "end") if chosen else ("elseif", "else", "end")
        cases: list[tuple[Tree | None, tuple[Statement, ...]]] = []
        while (own := self._word()) != "end":
            rest = self._waiting[self._place][1].removeprefix(own).strip()
            self._place += 1
            other = own in ("else", "otherwise")
            test = None if other else _equal(chosen, parse(rest)) if chosen else parse(rest)
            cases.append((test, self._block(words)))
        self._place += 1
        return Branches(line, tuple(cases))


def _equal(chosen: Tree, value: Tree) -> Tree:
    """A case of a `switch`: one value, or several in braces."""
    values = value.rows[0] if isinstance(value, Rows) and value.rows else (value,)
    test: Tree = Infix("==", chosen, values[0])
    for one in values[1:]:
        test = Infix("||", test, Infix("==", chosen, one))
    return test


def _assignment(line: int, text: str) -> list[Statement]:
    if _SHOWN.match(text):
        return []
    match = re.match(r"(\[[^\]]*\]|[A-Za-z][\w.]*\s*(?:\(.*?\))?)\s*=(?!=)(.*)\Z", text, re.DOTALL)
    if match is None:
        raise ValueError(f"'{text[:60]}' is not an assignment")
    left, value = match[1].strip(), parse(match[2])
    if not left.startswith("["):
        return [Assign(line, (_target(left),), value)]
    names = re.findall(r"~|[A-Za-z]\w*(?:\([^)]*\))?", left)
    return [Assign(line, tuple(Name("~") if n == "~" else _target(n) for n in names), value)]


def _target(text: str) -> Tree:
    found = parse(text)
    if not isinstance(found, Name | Apply):
        raise ValueError(f"'{text}' is not a variable")
    return found
