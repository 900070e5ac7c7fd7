# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutants of a source text: a table of replacements for each language, applied to its code only.

One text tool serves Rust, Ada, Python and TypeScript. It relies on each formatter's spaces around
operators; a mutant that the compiler refuses is left out by the campaign.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["LANGUAGES", "Mutant", "code_of", "mutants_of", "ranked"]

# What is no code: comments, strings, attributes, contracts that no product checks.
NO_CODE = {
    "rust": r"#\[cfg\(test\)\]\s+(?:#\[[^\n]*\]\s+)*mod \w+ \{.*|\bd?e?b?u?g?_?assert\w*!\(.*?\);"
    r'|//[^\n]*|/\*.*?\*/|b?r?"(?:\\.|[^"\\])*"|\'(?:\\[^\']+|[^\'\\\n])\'|#!?\[[^\n]*\]',
    "ada": r'--[^\n]*|"(?:""|[^"\n])*"|\'[^\n]\'|\bpragma\b[^;]*;|\b(?:Pre|Post)\s*=>[^;]*',
    "python": r'#[^\n]*|[rbf]{0,2}(?:"""(?:\\.|.)*?"""|"(?:\\.|[^"\\\n])*")|\bassert [^\n]*'
    r"|\b(?:strict|frozen)=True",
    "typescript": r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'"
    r"|`(?:\\.|[^`\\])*`",
}
LANGUAGES = {".rs": "rust", ".adb": "ada", ".py": "python", ".ts": "typescript"}

# Operators between spaces.
ARITHMETIC = {
    **{"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+="},
    **{"<": "<=", "<=": "<", ">": ">=", ">=": ">"},
}
C_LIKE = {
    **{"==": "!=", "!=": "==", "&&": "||", "||": "&&", "&": "|", "^": "|", "%": "*"},
    **{"<<": ">>", ">>": "<<", "|=": "&=", "&=": "|="},
}
OPERATORS = {
    "rust": ARITHMETIC | C_LIKE,
    "typescript": ARITHMETIC | C_LIKE | {"===": "!==", "!==": "==="},
    "python": ARITHMETIC
    | {"==": "!=", "!=": "==", "and": "or", "or": "and", "&": "|", "//": "*", "%": "*"}
    | {"<<": ">>", ">>": "<<", "is not": "is", "not in": "in"},
    "ada": ARITHMETIC
    | {"=": "/=", "/=": "=", "and then": "or else", "or else": "and then", "mod": "*"},
}
WORDS = {"true": "false", "false": "true", "True": "False", "False": "True"} | {
    "min": "max", "max": "min", "Min": "Max", "Max": "Min", "floor": "ceil", "ceil": "floor",
}  # fmt: skip

# A condition on one line, which is negated, and statements on one line, which are removed.
CONDITIONS = {
    "rust": (r"\bif (?!let\b)([^{}\n]+?)(?= \{| =>)", "!({})"),
    "typescript": (r"\bif \(([^\n]+)\)(?= (?:\{|return|continue|break|throw))", "!({})"),
    "python": (r"\bif ([^\n]+)(?=:\n)", "not ({})"),
    "ada": (r"\b(?:if|elsif|exit when) ([^\n;]+?)(?= then\b|;)", "not ({})"),
}
CALL_OR_ASSIGNMENT = r"^ +([\w.]+\([^\n]*\)\??;|[\w.\[\]*]+ [-+|&]?= [^\n]+;)$"
STATEMENTS = {
    "rust": (CALL_OR_ASSIGNMENT, "();"),
    "typescript": (CALL_OR_ASSIGNMENT, ";"),
    "python": (r"^ +([\w.]+\([^\n]*\)|[\w]+[.\[][\w.\[\]]* [-+*/|]?= [^\n]+)$", "pass"),
    "ada": (r"^ +([A-Z][\w.]*(?: \([^\n]*\))?(?: := [^\n]+)?;)$", "null;"),
}
SUFFIX = r"(?=(?:_?[iu](?:8|16|32|64|128|size))?(?![\w#]|\.\d))"
INTEGER = re.compile(rf"(?<![\w.#'])(0x[0-9A-Fa-f_]+|\d[\d_]*){SUFFIX}")
FLOAT = re.compile(r"(?<![\w.#])(\d[\d_]*\.\d[\d_]*(?:[eE][-+]?\d+)?)(?![\w#.])")


@dataclass(frozen=True)
class Mutant:
    """A replacement in a file, named by its line before and after, so that it may move."""

    file: str
    line: int
    start: int
    end: int
    text: str
    key: str

    def applied(self, source: str) -> str:
        """The source with the replacement."""
        return source[: self.start] + self.text + source[self.end :]


def _blank(found: re.Match[str]) -> str:
    return re.sub(r"[^\n]", "\x01", found.group())


def _between(words: dict[str, str]) -> str:
    longest_first = sorted(words, key=len, reverse=True)
    return "|".join(re.escape(word) for word in longest_first)


def _next_integer(text: str) -> str:
    digits = text.replace("_", "")
    return hex(int(digits, 16) + 1) if digits.startswith("0x") else str(int(digits) + 1)


def _places(code: str, language: str) -> Iterator[tuple[int, int, str]]:
    """Start, end and new text of each replacement; `code` has no comments or strings."""
    operators = OPERATORS[language]
    for found in re.finditer(rf"(?<=\s)(?:{_between(operators)})(?=\s)", code):
        yield (*found.span(), operators[found.group()])
    for found in re.finditer(rf"(?<![\w:])(?:{_between(WORDS)})\b", code):
        yield (*found.span(), WORDS[found.group()])
    for found in INTEGER.finditer(code):
        yield (*found.span(), _next_integer(found.group()))
    for found in FLOAT.finditer(code):
        value = float(found.group().replace("_", ""))
        yield (*found.span(), f"(1.25 * {found.group()})" if value else "1.0")
    for pattern, text in (CONDITIONS[language], STATEMENTS[language]):
        for found in re.finditer(pattern, code, re.MULTILINE):
            if found[1].count("(") == found[1].count(")"):
                yield (*found.span(1), text)


def code_of(file: str, source: str) -> str:
    """A source text without comments, strings and unit tests: blanks in their place."""
    return re.sub(NO_CODE[LANGUAGES[Path(file).suffix]], _blank, source, flags=re.DOTALL)


def mutants_of(file: str, source: str) -> list[Mutant]:
    """All mutants of a file; of those that look the same, line for line, the first."""
    language = LANGUAGES[Path(file).suffix]
    code = code_of(file, source)
    found: dict[str, Mutant] = {}
    for start, end, template in sorted(_places(code, language)):
        text = template.replace("{}", source[start:end])
        first = source.rfind("\n", 0, start) + 1
        last = source.find("\n", end)
        before = source[first:last].strip()
        after = (source[first:start] + text + source[end:last]).strip()
        key = f"{file}: {before} => {after}"
        found.setdefault(key, Mutant(file, source.count("\n", 0, start) + 1, start, end, text, key))
    return list(found.values())


def ranked(mutants: list[Mutant], seed: int) -> list[Mutant]:
    """In an order drawn by the seed, in which a change elsewhere moves no mutant."""
    return sorted(mutants, key=lambda m: hashlib.sha256(f"{seed} {m.key}".encode()).digest())
