# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Write the table of timing parameters from the virtual brick's own list.

`python -m tools.docs.timing_table` writes it into docs/reference/timing.md; a test compares.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import virtual_brick
from ravenbrick.self_test.parameters import INSEPARABLE, PARAMETERS, UNSEEN

__all__ = ["PAGE", "settled_by", "with_table"]

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "timing.md"
COLUMNS = ("Parameter", "Meaning", "optimistic", "nominal", "pessimistic", "Source", "Settled by")
CYCLES_PER_US = 336.384 / 7
SHORT_CYCLES = 100


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int) and value > SHORT_CYCLES:
        return f"{value} ({value / CYCLES_PER_US:.0f} us)"
    return f"`{value}`" if isinstance(value, str) else str(value)


def settled_by() -> dict[str, str]:
    """What would settle each value: rows of the self-test, or what it does not see."""
    rows = {p.name: "self-test: " + ", ".join(f"`{row}`" for row in p.rows) for p in PARAMETERS}
    others = {**UNSEEN, **INSEPARABLE}
    return rows | {name: f"not by the self-test: {reason}" for name, reason in others.items()}


def _table() -> str:
    settled = settled_by()
    lines = [f"| {' | '.join(COLUMNS)} |", "|---|---|---:|---:|---:|---|---|"]
    for parameter in json.loads(virtual_brick.timing_parameters()):
        name = parameter["name"]
        values = [_value(parameter[profile]) for profile in COLUMNS[2:5]]
        cells = [f"`{name}`", parameter["meaning"], *values, parameter["source"], settled[name]]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """The page with the table that the virtual brick gives."""
    return re.sub(r"(?m)^\| Parameter \| Meaning \|.*\n(\|.*\n)+", lambda _: _table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text()))
