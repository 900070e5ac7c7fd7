# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page and picture of the timing parameters that witnesses from real bricks allow."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

__all__ = ["inference_pages"]

Row = dict[str, Any]
HEAD = """<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->
<!-- SPDX-License-Identifier: Apache-2.0 -->
# Timing parameters that witnesses allow

Generated from `verification/firmware/witnesses/inference.json` by
`python -m verification.firmware.witnesses.inference`; do not edit.

No document fixes the [timing parameters](timing.md). Firmware and programs that work on real
bricks bound them: on the virtual brick, too, their frames must reach the co-processor, and their
links must not start again. Each of these constraints was tried with the values below, the other
parameters nominal. The [witnesses](witnesses.md) say where the images were published.
"""
SCORES = """
Kernels whose test suites have published scores from silicon must reach them within 12 %.
"""
PROFILES = """
The optimistic and the pessimistic profile join the ends of single parameters, so that every brick
lies between them. What is allowed one at a time need not be allowed together: a profile that is
refused lies outside of the region, and bounds computed with it are on the safe side. The last row
is the nearest point that every witness allows. The profile holds SCL longer than that, because LEGO
1.29 and leJOS bound it at 48 us only, and the two programs still drive when one frame in fourteen
is lost.
""".strip()
PICTURE = "pictures/timing-region.svg"
CELL_WIDTH, CELL_HEIGHT, LEFT, TOP = 74, 34, 150, 24
FRAME = ' stroke="black" stroke-width="3"'
COLOURS = {0: "#2e7d32", 1: "#f9a825", 2: "#ef6c00", 3: "#c62828"}


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _value(value: object) -> str:
    return f"`{value}`" if isinstance(value, str) else f"{value:,}"


def _grouped(names: list[str]) -> str:
    """Names, with the programs built with GNAT counted."""
    gnat = [name for name in names if name.startswith("GNAT ")]
    others = [name for name in names if not name.startswith("GNAT ")]
    if gnat:
        others.append(gnat[0] if len(gnat) == 1 else f"{len(gnat)} GNAT programs")
    return ", ".join(others)


def _single(rows: list[Row], name: str) -> list[tuple[Any, Mapping[str, str]]]:
    return [(r["settings"][name], r["refused"]) for r in rows if list(r["settings"]) == [name]]


def _side(tried: list[tuple[Any, Mapping[str, str]]], nominal: Any, below: bool) -> str:
    """The nearest refused value on a side of nominal, and who refuses it."""
    side = [(v, refused) for v, refused in tried if v != nominal and (v < nominal) == below]
    refused = [(value, who) for value, who in side if who]
    if not refused:
        return f"none from {_value(side[0 if below else -1][0])}" if side else "not tried"
    value, who = refused[-1] if below else refused[0]
    return f"{_value(value)}: {_grouped(list(who))}"


def _profile(settings: Row) -> str:
    (_, profile), *changes = settings.items()
    changed = ", ".join(f"`{name}` {_value(value)}" for name, value in changes)
    return f"{profile}, but {changed}" if changes else str(profile)


def _parameters(rows: list[Row], known: dict[str, Row]) -> list[str]:
    names = list(dict.fromkeys(next(iter(r["settings"])) for r in rows if len(r["settings"]) == 1))
    lines = ["## One parameter at a time", ""]
    lines += [_row(["Parameter", "Nominal", "Allowed", "Refused below", "Refused above"])]
    lines += ["|---|---:|---|---|---|"]
    for name in (name for name in names if name != "profile"):
        nominal, tried = known[name]["nominal"], _single(rows, name)
        allowed = ", ".join(_value(value) for value, refused in tried if not refused)
        if isinstance(nominal, str):
            refused = "; ".join(f"{_value(v)}: {_grouped(list(w))}" for v, w in tried if w)
            lines.append(_row([f"`{name}`", _value(nominal), allowed, refused or "none", ""]))
            continue
        sides = [_side(tried, nominal, below) for below in (True, False)]
        lines.append(_row([f"`{name}`", _value(nominal), allowed, *sides]))
    lines += ["", "## Profiles", "", _row(["Profile", "Refused by"]), "|---|---|"]
    for row in (row for row in rows if "profile" in row["settings"]):
        who = "; ".join(f"{name}: {why}" for name, why in row["refused"].items())
        lines.append(_row([_profile(row["settings"]), who or "no witness"]))
    lines += ["", PROFILES]
    free = [name for name in known if name not in names]
    lines += ["", "## Guesses that no witness settles", ""]
    lines += [_row(["Parameter", "Experiment that would settle it"]), "|---|---|"]
    unbounded = [n for n in names if n in known and not any(w for _, w in _single(rows, n))]
    lines += [_row([f"`{n}`", known[n]["settled"]]) for n in [*unbounded, *free]]
    return lines


def _svg(rows: list[Row], known: dict[str, Row]) -> str:
    pairs = [r for r in rows if len(r["settings"]) == 2 and "profile" not in r["settings"]]
    x_name, y_name = pairs[0]["settings"]
    xs = sorted({row["settings"][x_name] for row in pairs})
    ys = sorted({row["settings"][y_name] for row in pairs}, reverse=True)
    width, height = LEFT + CELL_WIDTH * len(xs) + 10, TOP + CELL_HEIGHT * len(ys) + 60
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        'font-family="sans-serif" font-size="12">',
        "<title>Witnesses that refuse each pair of values</title>",
        f'<text x="4" y="14">{escape(y_name)}</text>',
    ]
    for row in pairs:
        column, line = xs.index(row["settings"][x_name]), ys.index(row["settings"][y_name])
        count = len(row["refused"])
        colour = COLOURS[0 if count == 0 else 1 if count == 1 else 2 if count < 5 else 3]
        nominal = all(known[name]["nominal"] == v for name, v in row["settings"].items())
        x, y = LEFT + CELL_WIDTH * column, TOP + CELL_HEIGHT * line
        who = escape(_grouped(list(row["refused"])) or "allowed")
        out.append(
            f'<rect x="{x}" y="{y}" width="{CELL_WIDTH - 2}" height="{CELL_HEIGHT - 2}" '
            f'fill="{colour}"{FRAME if nominal else ""}><title>{who}</title></rect>'
            f'<text x="{x + CELL_WIDTH // 2}" y="{y + 21}" text-anchor="middle" fill="white">'
            f"{count or 'allowed'}</text>"
        )
    for line, value in enumerate(ys):
        y = TOP + CELL_HEIGHT * line + 21
        out.append(f'<text x="{LEFT - 8}" y="{y}" text-anchor="end">{value}</text>')
    bottom = TOP + CELL_HEIGHT * len(ys) + 18
    for column, value in enumerate(xs):
        x = LEFT + CELL_WIDTH * column + CELL_WIDTH // 2
        out.append(
            f'<text x="{x}" y="{bottom}" text-anchor="middle">{value}</text>'
            f'<text x="{x}" y="{bottom + 16}" text-anchor="middle">{value / 48.05:.0f} µs</text>'
        )
    out.append(f'<text x="{LEFT}" y="{bottom + 36}">{escape(x_name)}</text></svg>')
    return "\n".join(out) + "\n"


def inference_pages(data: Row) -> dict[str, str]:
    """The page and its picture, by path from docs/."""
    head, rows = data["head"], data["rows"]
    absent = sorted({name for row in rows for name in row["absent"]})
    names = [name for name in head["constraints"] if name not in absent]
    scores = SCORES if any(name.startswith("ChibiOS") for name in names) else ""
    lines = [HEAD + scores + f"\nRun: {head['date']}. Constraints: {_grouped(names)}."]
    if absent:
        lines.append(f"Absent then: {_grouped(absent)}.")
    lines += ["", *_parameters(rows, head["parameters"]), "", "## Two parameters together", ""]
    lines += ["The number of witnesses that refuse a pair; move the pointer over a cell for their"]
    lines += ["names. The frame is the nominal pair.", "", f"![Feasible region](../{PICTURE})", ""]
    return {
        "reference/timing-inference.md": "\n".join(lines),
        PICTURE: _svg(rows, head["parameters"]),
    }
