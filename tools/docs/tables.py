# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Write the Markdown tables of `verification/` and some reference pages from results.

`python -m tools.docs.tables` writes them; `--check` fails when a table is not what its file says.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write

from tools.docs.inference_page import inference_pages
from tools.docs.mutation_page import mutation_page
from tools.docs.result_pages import firmware_pages, fuzz_page, plant_page, witness_page
from verification.table import SUITES, Suite, read_suites

__all__ = [
    "OPTIONAL_KEYS",
    "benchmark_table",
    "merge_rows",
    "read_rows",
    "suites_table",
    "write_rows",
]

ROOT = Path(__file__).resolve().parents[2]
Row = dict[str, Any]
SUITE_KEYS = {
    *("area", "suite", "case_count", "passed", "excluded"),
    *("date", "elapsed_s", "processor_s", "note"),
}
OPTIONAL_KEYS = ("measured",)


def _check_keys(rows: list[Row], keys: set[str], name: str) -> None:
    for number, row in enumerate(rows):
        if set(row) != keys:
            raise SystemExit(f"{name}: row {number} has the keys {sorted(row)}, not {sorted(keys)}")


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _exclusion(exclusion: Row) -> str:
    count, reason = exclusion["count"], exclusion["reason"]
    return f"{count}: {reason}" if count else str(reason)


def _run(row: Row) -> str:
    """When the suite ran, and what was wrong with it or with a later run."""
    note = row["note"].replace("|", "\\|").replace("failed:", "**failed**:")
    kept = ", kept; " if note[:1].isdigit() else ": "
    return f"{row['date']}{kept}{note}" if row["date"] and note else row["date"] or note


def suites_table(rows: list[Row], suites: list[Suite]) -> str:
    """Table of suites: cases, passed, excluded with reasons; what each is compared with. Below it
    what suites measured beside their cases.

    Raises SystemExit for a row that is not a suite's: it was renamed or has left the table.
    """
    cases = [{k: row[k] for k in row if k not in OPTIONAL_KEYS} for row in rows]
    _check_keys(cases, SUITE_KEYS, "suites")
    known = {row["suite"]: row for row in rows}
    if unknown := sorted(set(known) - {suite.name for suite in suites}):
        raise SystemExit(f"results.json: not in suites.toml: {', '.join(unknown)}")
    lines = [
        "# Verification",
        "",
        "Generated from `results.json` by `make conformance`. *Run*: date of the figures, with the",
        "reason if a later run gave none. *Minutes*: elapsed time beside another suite, and in",
        "brackets the time of a processor.",
        "",
    ]
    columns = ["Area", "Suite", "Truth", "Compared with", "Cases", "Passed", "Excluded"]
    lines += [_row([*columns, "Run", "Minutes"])]
    lines += ["|---|---|---|---|---:|---:|---|---|---:|"]
    for suite in suites:
        row = known.get(suite.name)
        head = [suite.area, suite.name, suite.truth, suite.compared_with]
        if row is None:
            lines.append(_row([*head, "", "", "", "not run yet", ""]))
            continue
        excluded = "; ".join(_exclusion(e) for e in row["excluded"]) or "none"
        figures = [str(row["case_count"]), str(row["passed"]), excluded, _run(row)]
        times = [row[key] / 60 for key in ("elapsed_s", "processor_s")]
        lines.append(_row([*head, *figures, "{:.1f} ({:.1f})".format(*times) if times[0] else ""]))
    measured = [
        (s.name, text) for s in suites for text in known.get(s.name, {}).get("measured", ())
    ]
    if measured:
        lines += ["", "## Measured, not judged", ""]
        lines += [f"- *{name}*: {text}." for name, text in measured]
    return "\n".join(lines) + "\n"


def _number(value: float | int | None) -> str:
    if value is None:
        return ""
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def benchmark_table(rows: list[Row]) -> str:
    """Table of figures beside their peers; a ratio is ours divided by the peer's."""
    _check_keys(rows, {"figure", "value", "unit", "peer", "peer_value", "ratio"}, "benchmarks")
    lines = ["# Benchmarks", "", "Generated from `results.json` by `make bench`.", ""]
    lines += [_row(["Figure", "Value", "Unit", "Peer", "Peer's value", "Ratio"])]
    lines += ["|---|---:|---|---|---:|---:|"]
    for row in rows:
        figures = [_number(row["peer_value"]), _number(row["ratio"])]
        head = [row["figure"], _number(row["value"]), row["unit"], row["peer"] or ""]
        lines.append(_row(head + figures))
    return "\n".join(lines) + "\n"


def read_rows(path: Path) -> list[Row]:
    """Rows of a results file; none when there is no file."""
    rows: list[Row] = json.loads(path.read_text()) if path.exists() else []
    return rows


def merge_rows(path: Path, rows: list[Row], key: tuple[str, ...]) -> None:
    """Replace in the results file the rows with the same key, add the others."""
    merged = {tuple(row[k] for k in key): row for row in read_rows(path) + rows}
    write_rows(path, list(merged.values()))


def write_rows(path: Path, rows: list[Row]) -> None:
    """One line of JSON for each row."""
    lines = ",\n".join(json.dumps(row, sort_keys=True) for row in rows)
    atomic_write(path, f"[\n{lines}\n]\n")


VERIFICATION, BENCHMARKS = ROOT / "verification", ROOT / "verification" / "benchmarks"
POINTS = VERIFICATION / "plant" / "points.json"
WITNESSES = VERIFICATION / "firmware" / "witnesses" / "results.json"
MUTATION = VERIFICATION / "mutation"
DOCS = ROOT / "docs"


def _firmware(rows: list[Row]) -> dict[Path, str]:
    return {DOCS / name: text for name, text in firmware_pages(rows).items()}


def _inference(data: Row) -> dict[Path, str]:
    return {DOCS / name: text for name, text in inference_pages(data).items()}


def _suites(rows: list[Row]) -> str:
    return suites_table(rows, read_suites(SUITES))


def _one(target: Path, render: Callable[[Any], str]) -> Callable[[Any], dict[Path, str]]:
    return lambda data: {target: render(data)}


# Results, and what makes the files from them.
PAGES: tuple[tuple[Path, Callable[[Any], dict[Path, str]]], ...] = (
    (VERIFICATION / "results.json", _one(VERIFICATION / "results.md", _suites)),
    (BENCHMARKS / "results.json", _one(BENCHMARKS / "results.md", benchmark_table)),
    (POINTS, _one(DOCS / "reference" / "plant-points.md", plant_page)),
    (VERIFICATION / "firmware" / "images.json", _firmware),
    (WITNESSES.with_name("inference.json"), _inference),
    (WITNESSES, _one(DOCS / "reference" / "witnesses.md", witness_page)),
    (VERIFICATION / "fuzz" / "results.json", _one(DOCS / "reference" / "fuzzing.md", fuzz_page)),
    (MUTATION / "results.json", _one(DOCS / "reference" / "mutants.md", mutation_page)),
)


def main(arguments: list[str]) -> int:
    """Write the files, or with `--check` compare them."""
    stale = 0
    for source, render in PAGES:
        if not source.exists() and "--check" not in arguments:
            continue
        for target, text in render(json.loads(source.read_text())).items():
            if "--check" not in arguments:
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(text)
            elif not target.exists() or target.read_text() != text:
                name = target.relative_to(ROOT)
                print(f"{name}: differs from {source.name}; run 'python -m tools.docs.tables'")
                stale = 1
    return stale


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
