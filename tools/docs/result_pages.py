# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages that say more than a table: the plant beside published points, firmware, fuzzing."""

from __future__ import annotations

from typing import Any

from tools.docs.lcd_picture import lcd_svg

__all__ = ["firmware_pages", "fuzz_page", "plant_page"]

Row = dict[str, Any]

HEAD = """<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->
<!-- SPDX-License-Identifier: Apache-2.0 -->
"""
PLANT_HEAD = """# The plant beside published measurements

Generated from `verification/plant/points.json` by `python -m verification.plant.points`; do not
edit.

Each measurement of a real NXT motor that was found published, repeated on the virtual motor. A
value is *in* or *out* where the publications agree well enough to give a band; the others are
stated for comparison. All values are at the output shaft.

Sets: **A** identified for the MinSeg robot (MATLAB parameter file); **B** Watanabe's, for
NXTway-GS, with an inertia for a motor alone; **C** of the Pybricks firmware (`motor_data.py`,
2026), fitted to Philo's points; **A, real bridge** is A with 0.6 V lost in the bridge and 0.04 N m
of friction at rest. Sources: *Philo*, P. Hurbain's pages on LEGO motors (2006); *students*, a
project at Ryerson University with one motor on 8.16 V; *Muntoo*, a sweep of the power under NXC
(2011).
"""


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _short(value: float) -> str:
    return f"{value:.3f}" if abs(value) < 1 else f"{value:.4g}"


def _judged(measured: Row) -> str:
    words = {None: "", True: ", in", False: ", **out**"}
    return _short(measured["value"]) + words[measured["passes"]]


def _value(points: list[Row], condition: str, quantity: str, chosen: str) -> float:
    for point in points:
        if (point["condition"], point["quantity"]) == (condition, quantity):
            return float(next(m["value"] for m in point["measured"] if m["set"] == chosen))
    raise KeyError(f"{condition}: {quantity}")


def _contradiction(data: Row) -> list[str]:
    points, percent = data["points"], "turns from duty cycle, %"
    loaded = "9 V, 0.115 N m, brake mode"
    linear = [_value(points, loaded, percent, name) for name in "ABC"]
    real = "A, real bridge"
    free = _value(points, "8 V, no load, brake mode", percent, real)
    speed = _value(points, "9 V, no load", "speed, rpm", real)
    floating = _value(points, "9 V, 0.115 N m, float mode", percent, "A")
    text = f"""## Points that contradict each other

Philo's motor with 0.115 N m on 9 V stood still below about 40 % of the duty cycle. The published
sets turn it from {min(linear):.0f} to {max(linear):.0f} %. Friction at rest and the bridge's drop
raise that, but they also hold back a motor without load, and Muntoo's turned from 5 %: whatever
the share of the two, set A then turns from {data["stall_percent_at_most"]:.0f} % at the latest. No
constant friction and drop meet both measurements.

`A, real bridge` meets Philo's point with {_value(points, loaded, percent, real):.0f} %, turns
without load from {free:.0f} % only, and reaches {speed:.0f} rpm in place of 170, because Philo's
other points were measured at the motor's terminals. In float mode the current dies down in each
period and A turns from {floating:.0f} %; which mode the 40 % were measured in is not published. A
robot's file therefore has `driver_drop` and `static_friction` as parameters with tolerances.

Not in the table: Philo's points under LEGO's power control, which are a property of that
firmware's regulation, and the drive of a Tribot over a floor, whose wheels are not published.
"""
    return text.split("\n")


def plant_page(data: Row) -> str:
    """The plant's points: published, band, value of each set, in or out; why one is out."""
    names = [measured["set"] for measured in data["points"][0]["measured"]]
    lines = [HEAD + PLANT_HEAD]
    lines += [_row(["Condition", "Quantity", "Published", "Band", *names, "Source"])]
    lines += ["|---|---|---:|---|" + "---:|" * len(names) + "---|"]
    for point in data["points"]:
        limits = point["limits"]
        band = " to ".join(_short(limit) for limit in limits) if limits else ""
        values = [_judged(measured) for measured in point["measured"]]
        head = [point["condition"], point["quantity"], _short(point["published"]), band]
        lines.append(_row([*head, *values, point["source"]]))
    lines += ["", "## Values that are out", ""]
    lines += [_row(["Set", "Condition", "Quantity", "Reason"]), "|---|---|---|---|"]
    keys = ("set", "condition", "quantity", "reason")
    lines += [_row([miss[key] for key in keys]) for miss in data["missed"]]
    return "\n".join([*lines, "", *_contradiction(data)])


FIRMWARE_HEAD = """# Firmware images on the virtual brick

Generated from `verification/firmware/images.json` by `python -m verification.firmware.images`; do
not
edit. Images that were not made for this brick, unchanged, from power-on (nxtOSEK's: from the boot
monitor's RAM). None is part of this project: each is looked for where its variable says. A test
compares the picture (`verification/firmware/test_images.py`); menus, buttons, programs and hosts of
LEGO's firmware have tests of their own in `host/tests/firmware` and
`virtual-brick/crates/virtual-brick/tests/nxt_firmware.rs`.
"""


def firmware_pages(rows: list[Row]) -> dict[str, str]:
    """The page and the pictures beside it, by path from docs/."""
    lines = [HEAD + FIRMWARE_HEAD]
    lines += [_row(["Image", "From", "What was seen", "LCD"]), "|---|---|---|---|"]
    files = {}
    for row in rows:
        names = ", ".join(f"`{name}`" for name in row["variables"])
        source = f"{row['source']} ({names})"
        if "absent" in row:
            lines.append(_row([row["name"], source, f"not run: {row['absent']}", ""]))
            continue
        file = row["name"].split(" ")[0].lower().replace("/", "-") + ".svg"
        files[f"pictures/firmware/{file}"] = lcd_svg(row["picture"])
        shown = row["shows"] if row["stop"] == "reached" else row["stop"]
        ran = f"after {row['run_ms'] / 1000:g} s: {shown}"
        image = f"![{row['name']}](../pictures/firmware/{file})<br>`{row['digest']}`"
        known = f"{source}; {row['bytes']:,} bytes, SHA-256 `{row['sha256'][:16]}…`"
        lines.append(_row([row["name"], known, ran, image]))
    return {"reference/firmware-images.md": "\n".join([*lines, ""]), **files}


FUZZ_HEAD = """# Fuzzing

Generated from `verification/fuzz/results.json` by `python -m verification.fuzz.campaign`; do not
edit.

What no honest user gives the virtual brick, each for the same time in every `make conformance`:
first the target's corpus of right content as it is, then content damaged at random. A *finding* is
a panic, an exception without words, a peer that is no longer served, a record that does not play
again, or memory beyond its bound (512 MB of growth a target, 1 GB in the native targets). The peers
talk to a brick that runs LEGO's firmware; after each hostile session an honest host must be served.
"""
FUZZ_TAIL = """A content that is not borne is kept in `build/fuzz/findings`, and `python -m
verification.fuzz.campaign --give FILE` gives it again; a native target names its seed, and `fuzz 1
SEED` runs it first. Corpora: `verification/fuzz/corpus`, a compiled C program with debug
information, random programs, and snapshots that are saved when the campaign begins.

## Found and mended

| Target | What was found | Now |
|---|---|---|
"""
FOUND = (
    (
        "malformed snapshot",
        "a header that is no JSON object, infinite or negative numbers, text without an encoding:"
        " an exception in place of a refusal",
        "whole numbers up to a day and encodable text only",
    ),
    (
        "malformed snapshot",
        "found by reading: a cycle in the far future, to which the brick was run",
        "a day at most, in steps that Ctrl-C can end",
    ),
)


def fuzz_page(rows: list[Row]) -> str:
    """Targets with corpus, time, cases and findings."""
    lines = [HEAD + FUZZ_HEAD]
    lines += [_row(["Target", "Given", "Corpus", "Time, s", "Cases", "Findings"])]
    lines += ["|---|---|---:|---:|---:|---:|"]
    for row in rows:
        counts = [str(row[key]) for key in ("corpus", "seconds", "case_count", "findings")]
        lines.append(_row([row["target"], row["given"], *counts]))
    total = [str(sum(row[key] for row in rows)) for key in ("seconds", "case_count", "findings")]
    lines.append(_row(["**all**", "", "", *total]))
    found = [_row(list(cells)) for cells in FOUND]
    return "\n".join([*lines, "", FUZZ_TAIL.rstrip("\n"), *found, ""])
