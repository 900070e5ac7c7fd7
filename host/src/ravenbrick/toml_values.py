# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The values of a TOML text that anybody may have written."""

from __future__ import annotations

import re
import tomllib
from typing import Any

__all__ = ["toml_values"]

PARTS_MAX = 50
# Lengths are bounded, so that a search takes time in proportion to the text.
_PART = r"""(?:[A-Za-z0-9_-]{1,200}|"(?:[^"\\\n]|\\.){0,200}"|'[^'\n]{0,200}')[ \t]*"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{_PART}\.[ \t]*){{{PARTS_MAX}}}")


def toml_values(text: str) -> dict[str, Any]:
    """As `tomllib.loads`, but a key of more than 50 parts is an error.

    The parser takes time and memory by the square of their number: 1.5 GB for a key of 40 KB.
    Raises `tomllib.TOMLDecodeError`, `ValueError` for numbers with too many digits, and
    `RecursionError` for arrays in arrays without end.
    """
    if found := _LONG_KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        column = found.start() - text.rfind("\n", 0, found.start())
        problem = f"a key of more than {PARTS_MAX} parts (at line {line}, column {column})"
        raise tomllib.TOMLDecodeError(problem)
    return tomllib.loads(text)
