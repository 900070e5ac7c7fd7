# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reference pages from results: plant, firmware images, witnesses from real bricks, fuzzing."""

from __future__ import annotations

from typing import Any

from tools.docs.pictures.lcd import lcd_svg

__all__ = ["firmware_pages", "fuzz_page", "plant_page", "witness_page"]

Row = dict[str, Any]

HEAD = """<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->
<!-- SPDX-License-Identifier: Apache-2.0 -->
"""
PLANT_HEAD = """# Plant versus published measurements

Generated from `verification/plant/points.json` by `python -m verification.plant.points`; do not
edit.

The table has all known published measurements of real NXT motors, repeated on the virtual motor.
If the publications agree well enough to define a tolerance band, a value is *in* or *out* of it;
the other values are given for comparison. All values are at the output shaft.

Winding and inertia are those of three published sets and of a fourth: **A** is identified for the
MinSeg robot (MATLAB parameter file); **B** is Watanabe's, for NXTway-GS, with an inertia for a
motor alone; **C** is from the Pybricks firmware (`motor_data.py`, 2026), fitted to Philo's points;
**fitted** is the catalogue's `nxt_fitted`. All four have its friction and bridge. Least squares
fitted the friction, common to A, C and the fourth set, and that set's winding to the points below,
so these points confirm the form of the model rather than foretell. The bridge is that of a data
sheet (Sanyo LB1930MC, ENA2018: 0.25 V at 0.2 A, 0.55 V at 0.5 A); it counts where a brick drove the
motor, not where a voltage was applied to its terminals. Sources: *Philo*, P. Hurbain's pages on
LEGO motors (2006); *students*, a project at Ryerson University with one motor on 8.16 V; *Muntoo*,
a sweep of the power under NXC (2011).
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


def _form(data: Row) -> list[str]:
    points, percent = data["points"], "turns from duty cycle, %"
    loaded, free = "9 V, 0.115 N m, brake mode", "8 V, no load, brake mode"
    linear = [_value(points, loaded, percent, f"{name}, published") for name in "ABC"]
    slow = ("8.16 V, 0.402 N m", "speed, degree/s")
    floating = _value(points, "9 V, 0.115 N m, float mode", percent, "A, published")
    text = f"""## Form of the friction

Philo's motor with 0.115 N m on 9 V did not turn below a duty cycle of about 40 %. With the
published sets it turns from {min(linear):.0f} to {max(linear):.0f} %. A constant friction or drop
raises this value, but holds a motor without load, too, and Muntoo's motor turned from 5 %: set A
then turns from {data["stall_percent_at_most"]:.0f} % at the latest. Friction at rest that grows
with the torque in the gear train agrees with both: {_value(points, loaded, percent, "fitted"):.0f}
and {_value(points, free, percent, "fitted"):.0f} %. Stribeck's curve takes it away at speed, as
Philo's speed and current under load demand, and leaves it near standstill: at 0.402 N m the
students' motor turned with 50 degree/s, set A as published with
{_value(points, *slow, "A, published"):.0f}, and with this friction with
{_value(points, *slow, "A"):.0f}.

In float mode the current decays in each period and A as published turns from {floating:.0f} %; the
mode of the 40 % measurement is not published. The table does not contain Philo's points under
LEGO's power control, which depend on that firmware's regulation, and the drive of a Tribot over a
floor, whose wheels are not published.
"""
    return text.split("\n")


def _points_table(points: list[Row], rich: bool) -> list[str]:
    names = [one["set"] for one in points[0]["measured"] if one["rich"] == rich]
    lines = [_row(["Condition", "Quantity", "Published", "Band", *names, "Source"])]
    lines += ["|---|---|---:|---|" + "---:|" * len(names) + "---|"]
    for point in points:
        limits = point["limits"]
        band = " to ".join(_short(limit) for limit in limits) if limits else ""
        values = [_judged(one) for one in point["measured"] if one["rich"] == rich]
        head = [point["condition"], point["quantity"], _short(point["published"]), band]
        lines.append(_row([*head, *values, point["source"]]))
    return lines


def _within(points: list[Row], rich: bool) -> str:
    chosen = [one for point in points for one in point["measured"] if one["rich"] == rich]
    judged = [one["passes"] for one in chosen if one["passes"] is not None]
    return f"{sum(judged)} of {len(judged)} values are within their band."


def plant_page(data: Row) -> str:
    """The plant's points: published, band, value of each set, in or out; why one is out."""
    points = data["points"]
    lines = [HEAD + PLANT_HEAD, *_points_table(points, True), "", _within(points, True), ""]
    lines += ["## Sets as they are published", ""]
    lines += ["Without the richer friction, with a constant one where the set has it. *A, constant"]
    lines += ["drop* has a static friction of 0.04 N m and a bridge that takes 0.6 V.", ""]
    lines += [*_points_table(points, False), "", _within(points, False), ""]
    lines += ["## Values outside their band", ""]
    lines += [_row(["Set", "Condition", "Quantity", "Reason"]), "|---|---|---|---|"]
    keys = ("set", "condition", "quantity", "reason")
    lines += [_row([miss[key] for key in keys]) for miss in data["missed"]]
    return "\n".join([*lines, "", *_form(data)])


FIRMWARE_HEAD = """# Firmware images on the virtual brick

Generated from `verification/firmware/images.json` by `python -m verification.firmware.images`; do
not
edit. The table has unmodified third-party images, run from power-on (nxtOSEK's from the boot
monitor's RAM). None is part of this project; an environment variable names the folder of each. A
test compares the pictures (`verification/firmware/test_images.py`). Menus, buttons, programs and
hosts of LEGO's firmware are tested in `host/tests/firmware` and
`virtual-brick/crates/virtual-brick/tests/nxt_firmware.rs`.
"""


def firmware_pages(rows: list[Row]) -> dict[str, str]:
    """The page and the pictures beside it, by path from docs/."""
    lines = [HEAD + FIRMWARE_HEAD]
    lines += [_row(["Image", "Source", "Observation", "LCD"]), "|---|---|---|---|"]
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


WITNESS_HEAD = """# Witnesses from real bricks

Generated from `verification/firmware/witnesses/results.json` by
`python -m verification.firmware.witnesses.campaign`; do not edit.

Each witness is a program or firmware that others wrote and that is known from real bricks. Its
functions are tried on the virtual brick, with unmodified images. None of them is part of this
project: `verification/firmware/witnesses/images.toml` says where each was published, and
`RAVENBRICK_FIRMWARE` names the folder of files called by their SHA-256 digest. A row keeps the date
of its last run; an absent image does not change it.

*yes*: the function works; **no**: it does not, and the second table says what was seen.
"""


def witness_page(rows: list[Row]) -> str:
    """Witness x function, then what was seen of each."""
    names = list(dict.fromkeys(row["witness"] for row in rows))
    functions = sorted({row["function"] for row in rows})
    found = {(row["witness"], row["function"]): row for row in rows}
    words = {"passed": "yes", "failed": "**no**"}
    lines = [HEAD + WITNESS_HEAD, _row(["Witness", *functions]), "|---|" + "---|" * len(functions)]
    for name in names:
        cells = [found.get((name, function)) for function in functions]
        lines.append(_row([name, *(words[cell["outcome"]] if cell else "" for cell in cells)]))
    lines += ["", "## Observations", "", _row(["Witness", "Function", "Seen", "Date"])]
    lines += ["|---|---|---|---|"]
    for row in rows:
        bad = "**no**: " if row["outcome"] == "failed" else ""
        seen = bad + row["seen"].replace("|", "\\|")
        lines.append(_row([row["witness"], row["function"], seen, row["date"]]))
    return "\n".join([*lines, ""])


FUZZ_HEAD = """# Fuzzing

Generated from `verification/fuzz/results.json` by `python -m verification.fuzz.campaign`; do not
edit.

Every `make conformance` gives invalid input to the virtual brick, to every reader of a file that a
person can be handed, and to the telemetry session with its window and pictures, for the same time
to each target: first the target's corpus of valid input unchanged, then input mutated at random. A
*finding* is a panic, an exception without a message, a peer that is no longer served, a record that
cannot be replayed, more than 10 s for a file, or memory beyond its bound (512 MB of growth for each
target, 1 GB in the Rust targets). The peers communicate with a brick that runs LEGO's firmware;
after each hostile session a regular host must be served. Times are seconds of a processor, so a
campaign may run beside other work (`chrt --idle 0`). Times and cases are those of all campaigns
since the target's last finding; of a campaign that is stopped, those of the targets that ended.
"""
FUZZ_TAIL = """An input with a finding is kept in `build/fuzz/findings`, and
`python -m verification.fuzz.campaign --repeat FILE` repeats it; a Rust target prints its seed, and
`fuzz 1 SEED` runs it first. The corpora are `verification/fuzz/corpus`, a compiled C program with
debug information, random programs, and snapshots saved at the beginning of the campaign.

## Corrected defects

| Target | Finding | Correction |
|---|---|---|
"""
FOUND = (
    (
        "Simulink archives",
        "the number of a port with 5,000 digits: a traceback; 999,999,999 ports or signs: memory"
        " for each (found by review beside it)",
        "numbers of more than four digits are none of a port, a sign or a mask's place",
    ),
    (
        "reader of JSON and TOML files",
        "5,000 digits, 2,000 brackets, infinite instants, a name longer than any file's: a"
        " traceback",
        "a sentence with the file",
    ),
    (
        "telemetry of a brick",
        "limits or values that are no numbers, instants beyond 2**63 us, names that look like"
        " formulas: a traceback of the monitor, its page or its pictures",
        "such instants are unknown messages, sliders need finite limits, names are shown as they"
        " are",
    ),
    (
        "headers of generated C",
        "an array without a name, a length of 5,000 digits: a traceback",
        "a sentence, or no such variable",
    ),
    (
        "headers of generated C",
        "a structure that holds itself: a traceback; 40 levels of two each: no end (found by review"
        " beside it)",
        "at most 100 levels and 10,000 fields",
    ),
    (
        "malformed snapshot",
        "a header that is not a JSON object, infinite or negative numbers, text without an"
        " encoding: an exception instead of an error message",
        "only integers up to a day and encodable text are accepted",
    ),
    (
        "malformed snapshot",
        "found by review: the brick was run to a cycle in the far future",
        "at most a day, in steps that Ctrl-C can interrupt",
    ),
)


def fuzz_page(rows: list[Row]) -> str:
    """Targets with corpus, time, cases and findings."""
    lines = [HEAD + FUZZ_HEAD]
    lines += [_row(["Target", "Input", "Corpus", "Processor, s", "Cases", "Findings"])]
    lines += ["|---|---|---:|---:|---:|---:|"]
    for row in rows:
        counts = [str(row[key]) for key in ("corpus", "seconds", "case_count", "findings")]
        lines.append(_row([row["target"], row["input"], *counts]))
    total = [str(sum(row[key] for row in rows)) for key in ("seconds", "case_count", "findings")]
    lines.append(_row(["**all**", "", "", *total]))
    found = [_row(list(cells)) for cells in FOUND]
    return "\n".join([*lines, "", FUZZ_TAIL.rstrip("\n"), *found, ""])
