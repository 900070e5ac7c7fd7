# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A physical constant stands once: in `catalogue/parts.json`, and in no source beside it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
CATALOGUE = ROOT / "catalogue" / "parts.json"
# Fewer significant digits are met by chance.
DIGITS = 4
# Sources that may repeat a constant, by path below the tree, and why.
EXEMPT = {"tools/tests/test_style.py": "numbers that this rule must refuse"}


def _values(node: Any) -> Iterator[Decimal]:
    if isinstance(node, dict):
        if isinstance(node.get("value"), Decimal):
            yield node["value"]
        for inner in node.values():
            yield from _values(inner)


@cache
def _pattern() -> re.Pattern[str]:
    """A number with the significant digits of a constant, in whatever unit it is written."""
    parts = json.loads(CATALOGUE.read_text(), parse_float=Decimal)
    digits = {"".join(map(str, v.normalize().as_tuple().digits)) for v in _values(parts)}
    known = "|".join(r"\.?".join(d) for d in sorted(digits) if len(d) >= DIGITS)
    return re.compile(rf"(?<![\d.])(?=\d*\.\d)0*\.?0*(?:{known})(?!\d)")


def second_copies(path: Path, lines: list[str]) -> Iterator[tuple[Path, int, str]]:
    """Constants of the catalogue that a source or a TOML file repeats."""
    if path.is_relative_to(ROOT) and path.relative_to(ROOT).as_posix() in EXEMPT:
        return
    for number, line in enumerate(lines, 1):
        found = _pattern().search(line)
        if found:
            yield path, number, f"{found[0]} stands in catalogue/parts.json: read it from there"
