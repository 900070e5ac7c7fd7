# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the checks of all witnesses and write the table of witnesses and functions.

`python -m verification.firmware.witnesses.campaign [WORD ...]` runs those whose witness or function
contains a word, writes `results.json` and from it docs/reference/witnesses.md. An absent image
keeps its last row; a failing check is a row too and ends nothing.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from ravenbrick.errors import RavenbrickError

from tools.docs import tables
from tools.docs.tables import merge_rows, read_rows, write_rows
from verification.firmware.witnesses import chibios, lego, others
from verification.firmware.witnesses.library import CHECKS, Check, ImageAbsentError
from verification.firmware.witnesses.pybricks import CompilerAbsentError

__all__ = ["outcome"]

RESULTS = Path(__file__).with_name("results.json")
FAMILIES = (lego, others, chibios)  # importing them registers their checks
ABSENT = (ImageAbsentError, CompilerAbsentError, pytest.skip.Exception)
Row = dict[str, Any]


def outcome(check: Check) -> Row:
    """A row: `passed`, `failed` or `absent`, with what was seen or the reason."""
    row: Row = {"witness": check.witness, "function": check.function}
    try:
        seen = check.run()
    except ABSENT as error:
        return {**row, "outcome": "absent", "seen": str(error)}
    except (AssertionError, RavenbrickError) as error:
        return {**row, "outcome": "failed", "seen": f"{error} ".splitlines()[0].strip() or "no"}
    except Exception as error:  # a client that others wrote may raise anything
        return {**row, "outcome": "failed", "seen": f"{type(error).__name__}: {error}"}
    return {**row, "outcome": "passed", "seen": seen}


def run(checks: Sequence[Check], tell: Callable[[str], None] = print) -> list[Row]:
    """The rows of the checks, each told when it is there; those of absent images are not kept."""
    rows = []
    for check in checks:
        row = {**outcome(check), "date": time.strftime("%Y-%m-%d", time.gmtime())}
        tell(f"{row['outcome']}: {row['witness']}, {row['function']}: {row['seen']}")
        rows.append(row)
    merge_rows(RESULTS, [r for r in rows if r["outcome"] != "absent"], ("witness", "function"))
    known = {(check.witness, check.function) for check in CHECKS}
    kept = [row for row in read_rows(RESULTS) if (row["witness"], row["function"]) in known]
    write_rows(RESULTS, kept)
    return rows


def main(words: list[str]) -> int:
    """Run the checks that match; 1 when one failed."""
    chosen = [
        one
        for one in CHECKS
        if not words or any(word in f"{one.witness}, {one.function}" for word in words)
    ]
    rows = run(chosen)
    tables.main([])
    return int(any(row["outcome"] == "failed" for row in rows))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
