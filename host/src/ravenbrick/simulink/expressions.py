# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expressions in the dialogs of Simulink's blocks, read into trees; nothing is run."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

__all__ = ["Apply", "Infix", "Name", "Number", "Prefix", "Rows", "Span", "Tree", "parse"]

_LONGEST = 20_000
_DEEPEST = 60
_TOKEN = re.compile(
    r"""(?P<blank>\s+|\.\.\.[^\n]*\n?)
    |(?P<number>(?:\d+(?:\.(?![*/^\\'])\d*)?|\.\d+)(?:[eE][+-]?\d+)?)
    |(?P<name>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)
    |(?P<sign>\.\^|\.\*|\./|\.'|==|~=|<=|>=|&&|\|\||[-+*/\\^<>&|~!()\[\]{},;:'])""",
    re.VERBOSE,
)
_LEVELS = (
    ("||",), ("&&",), ("|",), ("&",), ("==", "~=", "<", "<=", ">", ">="), (":",), ("+", "-"),
    ("*", "/", ".*", "./", "\\"),
)  # fmt: skip
_RANGE = 5


@dataclass(frozen=True)
class Number:
    """A number."""

    value: float


@dataclass(frozen=True)
class Name:
    """A variable, or a field of a structure as `a.b`."""

    text: str


@dataclass(frozen=True)
class Prefix:
    """`-`, `+` or `~` before a value; `'` is the transpose."""

    operator: str
    operand: Tree


@dataclass(frozen=True)
class Infix:
    """Two values and the operator between them; with a dot it works element by element."""

    operator: str
    left: Tree
    right: Tree


@dataclass(frozen=True)
class Apply:
    """A function of arguments, or elements of a variable."""

    name: str
    arguments: tuple[Tree, ...]


@dataclass(frozen=True)
class Span:
    """`first:step:last`."""

    first: Tree
    step: Tree
    last: Tree


@dataclass(frozen=True)
class Rows:
    """A matrix in brackets, or the list in braces as one row."""

    rows: tuple[tuple[Tree, ...], ...]


Tree = Number | Name | Prefix | Infix | Apply | Span | Rows


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    spaced: bool
    tight: bool


def _tokens(text: str) -> Iterator[_Token]:
    place, spaced, before = 0, False, ""
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise ValueError(f"'{text[place]}' in '{text.strip()}' is not understood")
        place = match.end()
        kind = match.lastgroup or ""
        if kind == "blank":
            spaced = True
            continue
        if kind == "number" and re.match(r"[ij]\b", text[place:]):
            raise ValueError(f"'{text.strip()}' is complex; signals are real numbers")
        tight = place < len(text) and not text[place].isspace()
        own = match.group()
        if own == "'" and (spaced or not (before.isalnum() or before in ")]}'_.")):
            raise ValueError(f"text in quotes in '{text.strip()}' is not a number")
        yield _Token(kind, own, spaced, tight)
        spaced, before = False, own[-1]


def parse(text: str) -> Tree:
    """The tree of an expression; raises `ValueError` that says what is not understood."""
    if len(text) > _LONGEST:
        raise ValueError(f"an expression of {len(text)} characters")
    parser = _Parser(text.rstrip("; \t\n"))
    tree = parser.level(0)
    parser.end()
    return tree


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text.strip()
        self._tokens = list(_tokens(text))
        self._place = 0
        self._brackets: list[bool] = []
        self._depth = 0

    def _error(self) -> ValueError:
        return ValueError(f"the value '{self._text}' is not a number")

    def _peek(self) -> _Token | None:
        return self._tokens[self._place] if self._place < len(self._tokens) else None

    def _next_is(self, *signs: str) -> bool:
        token = self._peek()
        return token is not None and token.kind == "sign" and token.text in signs

    def _take(self) -> _Token:
        token = self._peek()
        if token is None:
            raise self._error()
        self._place += 1
        return token

    def _expect(self, sign: str) -> None:
        if self._take().text != sign:
            raise self._error()

    def end(self) -> None:
        """Nothing may follow."""
        if self._peek() is not None:
            raise self._error()

    def _parts_elements(self) -> bool:
        """Whether the next sign begins a new element, as the minus in `[1 -2]`."""
        token = self._peek()
        inside = bool(self._brackets) and self._brackets[-1]
        return inside and token is not None and token.spaced and token.tight

    def level(self, level: int) -> Tree:
        """Operators from one level of precedence on."""
        if level == len(_LEVELS):
            return self._prefix()
        left = self.level(level + 1)
        while self._next_is(*_LEVELS[level]):
            signed = self._next_is("+", "-")
            if signed and self._parts_elements():
                break
            operator = self._take().text
            right = self.level(level + 1)
            if level == _RANGE:
                return self._span(left, right)
            left = Infix(operator, left, right)
        return left

    def _span(self, first: Tree, second: Tree) -> Tree:
        if not self._next_is(":"):
            return Span(first, Number(1.0), second)
        self._take()
        return Span(first, second, self.level(_RANGE + 1))

    def _prefix(self) -> Tree:
        if self._next_is("+", "-", "~", "!"):
            operator = self._take().text.replace("!", "~")
            self._deeper()
            operand = self._prefix()
            self._depth -= 1
            return Prefix(operator, operand)
        return self._power()

    def _power(self) -> Tree:
        left = self._postfix()
        while self._next_is("^", ".^"):
            operator = self._take().text
            signs = []
            while self._next_is("+", "-"):
                signs.append(self._take().text)
            right = self._postfix()
            for sign in reversed(signs):
                right = Prefix(sign, right)
            left = Infix(operator, left, right)
        return left

    def _postfix(self) -> Tree:
        value = self._primary()
        while self._next_is("'", ".'"):
            self._take()
            value = Prefix("'", value)
        return value

    def _deeper(self) -> None:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ValueError(f"an expression nested more than {_DEEPEST} deep")

    def _primary(self) -> Tree:
        token = self._take()
        if token.kind == "number":
            return Number(float(token.text))
        if token.kind == "name":
            following = self._peek()
            inside = bool(self._brackets) and self._brackets[-1]
            if self._next_is("(") and not (inside and following and following.spaced):
                self._take()
                return Apply(token.text, tuple(self._list(")")))
            return Name(token.text)
        if token.text == "(":
            self._brackets.append(False)
            self._deeper()
            value = self.level(0)
            self._depth -= 1
            self._brackets.pop()
            self._expect(")")
            return value
        if token.text in "[{":
            return self._rows("]" if token.text == "[" else "}")
        raise self._error()

    def _list(self, closing: str) -> Iterator[Tree]:
        self._brackets.append(False)
        self._deeper()
        while not self._next_is(closing):
            if self._next_is(":"):
                self._take()
                yield Name(":")
            else:
                yield self.level(0)
            if not self._next_is(closing):
                self._expect(",")
        self._take()
        self._depth -= 1
        self._brackets.pop()

    def _rows(self, closing: str) -> Tree:
        self._brackets.append(True)
        self._deeper()
        rows: list[tuple[Tree, ...]] = []
        row: list[Tree] = []
        while not self._next_is(closing):
            if self._next_is(";"):
                self._take()
                rows.append(tuple(row))
                row = []
            elif self._next_is(","):
                self._take()
            else:
                row.append(self.level(0))
        self._take()
        self._depth -= 1
        self._brackets.pop()
        rows.append(tuple(row))
        return Rows(tuple(one for one in rows if one))
