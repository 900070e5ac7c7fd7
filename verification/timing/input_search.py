# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Inputs of the TACLe benchmarks: searched for long runs, and bounded for any data.

`python -m verification.timing.input_search FOLDER [--code arm|thumb] [--level O1] [--table FILE]
[NAME ...]` prints one JSON object. `tacle_inputs.toml` says what the inputs are and in which range.
Four numbers of each program: the time with the given data and its bound, the longest time that a
search finds (hill climbing with restarts, always the same), and the bound for any data in range.
Loops without a bound of their own take the program's pragmas, unless the file says more.
"""

from __future__ import annotations

import hashlib
import json
import struct
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from ravenbrick.timing.bounds import ExecutionTimeError

from verification.timing.wcet_benchmarks import (
    STACK_POINTER,
    Facts,
    Outcome,
    analysis_digest,
    answered,
    campaign_parser,
    closed_bound,
    compiled,
    example,
    kept_columns,
    programs,
    source_loops,
    within,
    write_columns,
)

INPUTS = Path(__file__).with_name("tacle_inputs.toml")
BUDGET_CYCLES = 1_000_000_000
# Of the range of an input that is a single number.
PARTS = 16
SIZES = {"8": 1, "16": 2, "32": 4, "64": 4}


@dataclass
class Searched(Outcome):
    """`bound` is for any data in the range, `observed` the longest run that was found."""

    given_bound: int = 0
    given_observed: int = 0
    runs: int = 0
    restarts: int = 0
    none: str = ""


@cache
def declared() -> dict[str, dict[str, Any]]:
    """What the file says, by program."""
    return tomllib.loads(INPUTS.read_text())


def searched(elf: Path, name: str, inputs: Sequence[str], outcome: Searched) -> None:
    """The longest run that is found."""
    command = [str(example("search")), str(elf), f"{name}_init", f"{name}_main", str(BUDGET_CYCLES)]
    done = subprocess.run([*command, *inputs], capture_output=True, text=True, check=True)
    outcome.given_observed, outcome.observed, outcome.runs, outcome.restarts = (
        int(word) for word in done.stdout.split()
    )


def open_input(text: str) -> dict[str, Any]:
    """An input as the analysis takes it: a range of words without sign, where it is one."""
    symbol, offset, count, kind, low, high = text.split(":")
    element = SIZES[kind[1:]]
    total = int(count) * int(kind[1:]) // 8
    found: dict[str, Any] = {
        "symbol": symbol,
        "offset_bytes": int(offset),
        "size_bytes": total,
        "element_bytes": element,
    }
    if kind[0] != "f" and int(low) >= 0:
        found["range"] = (int(low), int(high))
    elif kind == "f32" and float(low) >= 0:
        # Floats without sign are ordered like their bits.
        bits = struct.unpack("<II", struct.pack("<ff", float(low), float(high)))
        found["range"] = bits
    return found


def cases(inputs: Sequence[str]) -> Iterator[tuple[dict[str, Any], ...]]:
    """The inputs, each single number limited to a part of its range, in every combination: a
    number that is known more narrowly leaves fewer ways together in one bound.
    """

    def parts(one: dict[str, Any]) -> list[dict[str, Any]]:
        if one["size_bytes"] > one["element_bytes"] or "range" not in one:
            return [one]
        low, high = one["range"]
        width = high - low + 1
        count = min(PARTS, width)
        begins = [low + width * part // count for part in range(count + 1)]
        return [{**one, "range": (begin, end - 1)} for begin, end in pairwise(begins)]

    return product(*(parts(open_input(text)) for text in inputs))


def bound_for_any(elf: bytes, name: str, facts: Facts, inputs: Sequence[str]) -> int:
    """Bound for all values of the inputs."""
    return max(_bound_of_case(elf, name, facts, case) for case in cases(inputs))


def _bound_of_case(elf: bytes, name: str, facts: Facts, case: Sequence[dict[str, Any]]) -> int:
    calls = (f"{name}_init", f"{name}_main")
    found = answered(elf, name, facts, known_memory=(calls, STACK_POINTER), inputs=case)
    return found.known_memory_cycles or 0


def _judge(folder: Path, elf: Path, content: bytes, outcome: Searched) -> None:
    name, said = folder.name, declared()[folder.name]
    begin = time.monotonic()
    try:
        searched(elf, name, said["inputs"], outcome)
        outcome.given_bound = closed_bound(content, name) + 2
        facts = Facts(elf, name, source_loops(folder), outcome)
        for symbol, iterations in said.get("iterations", {}).items():
            facts.say(symbol, iterations)
        outcome.bound = bound_for_any(content, name, facts, said["inputs"]) + 2
    except subprocess.CalledProcessError as error:
        outcome.error = str(error.stderr)[-300:]
    except ExecutionTimeError as error:
        outcome.error = f"{error.sentence}; {error.detail}"[:300]
    outcome.seconds = round(time.monotonic() - begin, 1)


def judge(
    folder: Path, code: str, level: str, kept: dict[str, Any], seconds: float | None
) -> Searched:
    """One program, unless its result is kept."""
    outcome = Searched(folder.name)
    if "none" in declared()[folder.name]:
        outcome.none = declared()[folder.name]["none"]
        return outcome
    with tempfile.TemporaryDirectory() as temporary:
        elf = Path(temporary) / "program.elf"
        try:
            content = compiled(folder, elf, code, level)
        except subprocess.CalledProcessError as error:
            outcome.error = f"not compiled: {error.stderr.decode()[-300:]}"
            return outcome
        plain = content.replace(temporary.encode(), b"")
        said = json.dumps(declared()[folder.name]) + str(BUDGET_CYCLES) + analysis_digest()
        outcome.key = hashlib.sha256(plain + said.encode()).hexdigest()[:16]
        known = kept.get(folder.name, {})
        if known.get("key") == outcome.key and known.get("bound"):
            return Searched(**known)
        example("search")
        return within(seconds, lambda o: _judge(folder, elf, content, o), outcome)


def _row(row: dict[str, Any]) -> list[str]:
    if row["none"]:
        return ["-"] * 7
    numbers = [row["given_observed"], row["observed"], row["given_bound"], row["bound"]]
    ratios = [
        row["bound"] / row["observed"] if row["observed"] and row["bound"] else 0,
        row["bound"] / row["given_observed"] if row["given_observed"] and row["bound"] else 0,
    ]
    shown = [f"{ratio:.3f}" if ratio else "-" for ratio in ratios]
    return [*(str(number or "-") for number in numbers), *shown, str(row["runs"] or "-")]


def write_table(path: Path, columns: dict[str, dict[str, Any]]) -> None:
    """The page."""
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# TACLe benchmarks: inputs searched, bounds for any data",
        "",
        "Generated by `python -m verification.timing.input_search FOLDER --table FILE`. Cycles of",
        "`<name>_main` with one cycle for each access. *Given*: the data that `<name>_init` sets.",
        "*Searched*: the longest run that hill climbing over the inputs found. *Any data*: the",
        "bound for all values in the ranges of `tacle_inputs.toml`, the rest of memory as it is;",
        f"the largest of those for {PARTS} parts of the range of each input that is one number.",
    ]
    for key, column in sorted(columns.items()):
        lines += ["", f"## {key}", ""]
        lines += [
            "| program | observed, given data | observed, searched | bound, given data | bound, "
            "any data | any / searched | any / given | runs |",
            "| --- |" + " ---: |" * 7,
        ]
        open_rows = {name: row for name, row in sorted(column.items()) if not row["none"]}
        lines += [f"| {name} | " + " | ".join(_row(row)) + " |" for name, row in open_rows.items()]
        ratios = sorted(r["bound"] / r["observed"] for r in open_rows.values() if r["bound"])
        if ratios:
            mean, middle = sum(ratios) / len(ratios), ratios[len(ratios) // 2]
            lines += [
                "",
                f"{len(ratios)} of {len(open_rows)} programs with inputs bounded for any data: "
                f"bound over longest run: mean {mean:.3f}, median {middle:.3f}, largest "
                f"{ratios[-1]:.3f}.",
            ]
        failed = [f"{n} ({r['error']})" for n, r in open_rows.items() if not r["bound"]]
        lines += ["", f"Without a bound: {'; '.join(failed)}."] if failed else []
    lines += ["", "## Programs without a search", "", "| program | reason |", "| --- | --- |"]
    said = declared().items()
    lines += [f"| {name} | {row['none']} |" for name, row in said if "none" in row]
    path.write_text("\n".join(lines) + "\n")


def campaign(
    folder: Path,
    choice: tuple[str, str],
    names: Sequence[str],
    table: Path | None,
    seconds: float | None,
) -> dict[str, Any]:
    """All programs of one code and level."""
    column = f"{choice[0]} -{choice[1]}"
    columns = kept_columns(table)
    kept = columns.setdefault(column, {})
    outcomes = []
    for path in [path for path in programs(folder) if not names or path.name in names]:
        outcome = judge(path, *choice, kept, seconds)
        outcomes.append(outcome)
        kept[outcome.name] = vars(outcome)
        if table is not None:
            write_columns(table, columns)
        told = outcome.none or f"{outcome.ratio:.3f} {outcome.error}"
        print(f"{outcome.name}: {told}", file=sys.stderr, flush=True)
    if table is not None:
        write_table(table, columns)
    tried = [outcome for outcome in outcomes if not outcome.none]
    return {
        "column": column,
        "programs": len(outcomes),
        "searched": len(tried),
        "bounded": sum(outcome.bound > 0 for outcome in tried),
        "exceeded": [o.name for o in tried if o.bound and o.bound < o.observed],
        "longer_than_given": [o.name for o in tried if o.observed > o.given_observed],
        "outcomes": [vars(outcome) for outcome in outcomes],
    }


def main() -> int:
    """Print the result; 1 when a program with inputs has no bound or exceeds it."""
    options = campaign_parser(__doc__).parse_args()
    choice = (options.code, options.level)
    result = campaign(options.folder, choice, options.names, options.table, options.seconds)
    print(json.dumps(result, indent=1))
    return 1 if result["exceeded"] or result["bounded"] < result["searched"] else 0


if __name__ == "__main__":
    sys.exit(main())
