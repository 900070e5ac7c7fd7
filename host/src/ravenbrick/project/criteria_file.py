# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Expectations from the command line: one sentence, or a file of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ravenbrick.errors import ProjectFileError, UsageError
from ravenbrick.project.criteria import Expectation, ExpectationSyntaxError, parse_expectation
from ravenbrick.schemas.located_toml import KeyPath, read_toml

__all__ = ["read_expectations_of"]

SUFFIXES = (".toml", ".txt", ".expect")


def _lines(path: Path) -> Iterator[Expectation]:
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise ProjectFileError(path, 1, "", "not UTF-8 text; save the file as UTF-8") from None
    for line, content in enumerate(text.splitlines(), 1):
        if content.strip() and not content.lstrip().startswith("#"):
            try:
                yield parse_expectation(content, f"{path}:{line}")
            except ExpectationSyntaxError as error:
                raise ProjectFileError(path, line, "", str(error)) from None


def _toml(path: Path) -> Iterator[Expectation]:
    document = read_toml(path, missing="name a file of expectations")
    tables = document.values.get("criteria")
    if set(document.values) - {"criteria"} or not isinstance(tables, list) or not tables:
        raise document.error((), "expected [[criteria]] tables with 'expect' and nothing else")
    for index, table in enumerate(tables):
        path_of: KeyPath = ("criteria", index, "expect")
        if not isinstance(table, dict) or set(table) != {"expect"}:
            raise document.error(("criteria", index), "expected the one field 'expect'")
        if not isinstance(table["expect"], str):
            raise document.error(path_of, "expected a text in quotes")
        try:
            yield parse_expectation(table["expect"], f"{path}:{document.line_of(path_of)}")
        except ExpectationSyntaxError as error:
            raise document.error(path_of, str(error)) from None


def read_expectations_of(text: str) -> tuple[Expectation, ...]:
    """The expectations of `--expect`: a file that exists, or else one sentence.

    Raises `ProjectFileError` with the line in a file, `UsageError` for a sentence or for the name
    of a file that is not there.
    """
    path = Path(text)
    if path.suffix in SUFFIXES and " " not in path.suffix:
        if not path.is_file():
            raise UsageError(f"--expect {text}: there is no such file; correct its name")
        found = tuple(_toml(path) if path.suffix == ".toml" else _lines(path))
        if not found:
            raise ProjectFileError(path, 1, "", "has no expectation; write one per line")
        return found
    try:
        return (parse_expectation(text, "--expect"),)
    except ExpectationSyntaxError as error:
        raise UsageError(f"--expect: {error}") from None
