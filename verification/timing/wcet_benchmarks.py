# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of the TACLe benchmarks against their times on the core.

`python -m verification.timing.wcet_benchmarks FOLDER [--code arm|thumb] [--level O1] [--data own]
[NAME ...]` prints one JSON object. FOLDER is the `bench` folder of github.com/tacle/tacle-bench.
Each program is compiled for the ARM7TDMI; its `<name>_main` is bounded and, after `<name>_init`,
run, with one cycle for each access, in 2 MB of memory.

With `--table FILE`, results are kept in `build/verification` and taken from there as long as
neither the ELF file nor the analysis has changed, so that a campaign can be interrupted.
With `--seconds N`, a program that takes longer counts as one without a bound.

With `--data own`, the bound is for the data that the program brings along: memory begins as the
image says, and nothing else writes to it. No loop bound and no other fact is used. With `--data
any`, it is for any contents of memory. Loop bounds that the analysis does not find are then those
of the program's own `loopbound` pragmas; where none stands at a loop, or the program breaks one,
and for recursive functions, counts of the run are used and reported.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import queue
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from ravenbrick.timing.bounds import Bounds, ExecutionTimeError, execution_times
from ravenbrick.timing.facts.facts import annotations_of

from verification.support.paths import ROOT
from verification.support.rust_examples import rust_example

GROUPS = ("app", "kernel", "sequential", "test")
COMPILER = "arm-none-eabi-gcc"
PRAGMA = re.compile(r'_Pragma\s*\(\s*"loopbound\s+min\s+(\d+)\s+max\s+(\d+)"\s*\)')
MEMORY = ROOT / "runtime" / "arm7tdmi" / "memory.S"
OPTIONS = (
    "-mcpu=arm7tdmi", "-mthumb-interwork", "-g", "-nostartfiles", "-fno-builtin", "-w",
    "-Wl,-Ttext=0x202000", "-Wl,--no-warn-rwx-segments", "-Wl,-e0x202000",
    "-fno-tree-loop-distribute-patterns",
)  # fmt: skip
ROUNDS = 80
STACK_POINTER = 0x3F_FFC0
CRATE = ROOT / "virtual-brick" / "crates" / "wcet"


@dataclass(frozen=True)
class SourceLoop:
    """A loop statement with a pragma: its lines and most iterations."""

    file: str
    begin: int
    end: int
    iterations: int


@dataclass
class Outcome:
    """What became of one program."""

    name: str
    bound: int = 0
    observed: int = 0
    error: str = ""
    from_pragmas: int = 0
    from_runs: list[str] = field(default_factory=list)
    seconds: float = 0.0
    key: str = ""

    @property
    def ratio(self) -> float:
        """Bound over observed."""
        return self.bound / self.observed if self.observed else 0.0


def programs(folder: Path) -> Iterator[Path]:
    """Folders of the sequential programs."""
    for group in GROUPS:
        yield from sorted(path for path in (folder / group).iterdir() if path.is_dir())


def compiled(folder: Path, output: Path, code: str, level: str) -> bytes:
    """The program as an ELF file."""
    sources = sorted(folder.rglob("*.c"))
    command = [COMPILER, *OPTIONS, f"-m{code}", f"-{level}", *map(str, sources), str(MEMORY)]
    subprocess.run(
        [*command, "-o", str(output), "-lm", "-lc", "-lgcc"], check=True, capture_output=True
    )
    return output.read_bytes()


def example(name: str) -> Path:
    """A program of the crate: `observe` runs functions on the core, `search` looks for inputs."""
    return rust_example(name, "-p", "wcet")


def run(elf: Path, name: str, recursive: Sequence[str] = ()) -> list[str]:
    """Lines of the observer."""
    options = [word for function in recursive for word in ("--recursive", function)]
    command = [str(example("observe")), str(elf), f"{name}_init", f"{name}_main", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.strip().split("\n")


def _blanked(text: str) -> str:
    """The text without comments, on the same lines."""
    pattern = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
    return pattern.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def _matching(text: str, position: int) -> int:
    """Position of the bracket that closes the one at `position`."""
    pairs = {"(": ")", "{": "}"}
    opening, closing, depth = text[position], pairs[text[position]], 0
    for at in range(position, len(text)):
        depth += (text[at] == opening) - (text[at] == closing)
        if depth == 0:
            return at
    return len(text) - 1


def _statement_end(text: str, position: int) -> int:
    """End of the statement that begins at `position`."""
    rest = re.compile(r"\s*(?:_Pragma\s*\([^)]*\)\s*)*").match(text, position)
    position = rest.end() if rest else position
    if text.startswith("{", position):
        return _matching(text, position)
    word = re.compile(r"(for|while|if|switch|do|else)\b").match(text, position)
    if word is None:
        return text.find(";", position)
    if word.group() in ("do", "else"):
        end = _statement_end(text, word.end())
    else:
        end = _statement_end(text, _matching(text, text.index("(", position)) + 1)
    if word.group() == "do":
        return text.find(";", end)
    following = re.compile(r"\s*else\b").match(text, end + 1)
    return _statement_end(text, following.end()) if following else end


def source_loops(folder: Path) -> list[SourceLoop]:
    """All loops with pragmas of a program."""
    found = []
    for path in sorted([*folder.rglob("*.c"), *folder.rglob("*.h")]):
        text = _blanked(path.read_text(errors="replace"))
        for pragma in PRAGMA.finditer(text):
            rest = text[pragma.end() :]
            begin = pragma.end() + len(rest) - len(rest.lstrip())
            end = _statement_end(text, begin)
            lines = text.count("\n", 0, begin) + 1, text.count("\n", 0, end) + 1
            found.append(SourceLoop(path.name, *lines, int(pragma[2])))
    return found


def pragma_for(loop: dict[str, Any], known: Sequence[SourceLoop]) -> SourceLoop | None:
    """The smallest source loop with most of the loop's own lines."""
    lines = [(file.rpartition("/")[2], line) for file, line in loop["lines"]]

    def share(source: SourceLoop) -> int:
        return sum(
            file == source.file and source.begin <= line <= source.end for file, line in lines
        )

    inside = [source for source in known if share(source)]
    return max(inside, key=lambda one: (share(one), one.begin - one.end), default=None)


def _recursive(error: str) -> list[str]:
    """Names of the functions that call each other."""
    return sorted(set(re.findall(r" in ([^\s+]+)\+0x", error)))


class Facts:
    """Facts about one program, gathered from what the analysis asks for."""

    def __init__(self, elf: Path, name: str, known: list[SourceLoop], outcome: Outcome) -> None:
        self._elf, self._name, self._known, self._outcome = elf, name, known, outcome
        self._loops: list[dict[str, Any]] = []
        self._recursions: list[dict[str, Any]] = []

    def say(self, symbol: str, iterations: Sequence[int]) -> None:
        """Facts about the loops of a function."""
        self._loops += [
            {"symbol": symbol, "index": index, "iterations": count}
            for index, count in enumerate(iterations)
        ]

    def text(self) -> str:
        """As TOML."""
        return annotations_of({"loop": self._loops, "recursion": self._recursions})

    def learn(self, error: ExecutionTimeError) -> bool:
        """Answer a question; False when it cannot be answered."""
        if "recursion" in error.sentence:
            return self._count(_recursive(error.detail))
        missing = error.data.get("missing", [])
        return bool(missing) and all([self._bound(loop) for loop in missing])

    def _count(self, names: list[str]) -> bool:
        new = [n for n in names if all(r["symbol"] != n for r in self._recursions)]
        for line in run(self._elf, self._name, new)[1:]:
            symbol, calls, depth = line.split()
            row = {"symbol": symbol, "calls": max(int(calls), 1), "depth": max(int(depth), 1)}
            self._recursions.append(row)
            self._outcome.from_runs.append(f"{symbol}: {calls} calls, {depth} deep")
        return bool(new)

    def _bound(self, loop: dict[str, Any]) -> bool:
        source = pragma_for(loop, self._known)
        place = {"symbol": loop["symbol"], "index": loop["index"]}
        if source is None or any(place.items() <= row.items() for row in self._loops):
            return False
        self._loops.append({**place, "iterations": source.iterations})
        self._outcome.from_pragmas += 1
        return True


def answered(elf: bytes, name: str, facts: Facts, **wanted: Any) -> Bounds:
    """Bounds of what is `wanted`, with facts for all that the analysis asks for."""
    for _ in range(ROUNDS):
        try:
            annotations = [("pragmas", facts.text())]
            return execution_times(elf, annotations=annotations, timing="plain", **wanted)
        except ExecutionTimeError as error:
            if not facts.learn(error):
                raise
    raise ExecutionTimeError(f"{name}: too many questions")


def closed_bound(elf: bytes, name: str) -> int:
    """Bound for the program's own data."""
    calls = (f"{name}_init", f"{name}_main")
    found = execution_times(elf, known_memory=(calls, STACK_POINTER), timing="plain")
    return found.known_memory_cycles or 0


@cache
def analysis_digest() -> str:
    """Changes with the sources of the analysis."""
    found = hashlib.sha256()
    for path in sorted([*(CRATE / "src").glob("*.rs"), *(CRATE / "annotations").glob("*.toml")]):
        found.update(path.read_bytes())
    return found.hexdigest()


def _judge(folder: Path, elf: Path, content: bytes, data: str, outcome: Outcome) -> None:
    begin = time.monotonic()
    try:
        outcome.observed = int(run(elf, folder.name)[0].split()[0])
        if data == "own":
            cycles = closed_bound(content, folder.name)
        else:
            facts = Facts(elf, folder.name, source_loops(folder), outcome)
            found = answered(content, folder.name, facts, functions=[f"{folder.name}_main"])
            cycles = found.functions[0].cycles
        # The run's return fills the pipeline at its caller: two fetches of one cycle.
        outcome.bound = cycles + 2
    except subprocess.CalledProcessError as error:
        outcome.error = (error.stderr or b"").__str__()[-300:]
    except ExecutionTimeError as error:
        outcome.error = f"{error.sentence}; {error.detail}"[:300]
    outcome.seconds = round(time.monotonic() - begin, 1)


Kind = TypeVar("Kind", bound=Outcome)


def within(seconds: float | None, work: Callable[[Kind], None], outcome: Kind) -> Kind:
    """The outcome of work in a process of its own that is ended after some time."""
    context = multiprocessing.get_context("fork")
    answers: multiprocessing.Queue[Kind] = context.Queue()

    def task() -> None:
        work(outcome)
        answers.put(outcome)

    process = context.Process(target=task)
    process.start()
    try:
        return answers.get(timeout=seconds)
    except queue.Empty:
        outcome.error = f"given up after {seconds:g} s"
        return outcome
    finally:
        process.kill()
        process.join()


def judge(
    folder: Path, choice: tuple[str, str, str], kept: dict[str, Any], seconds: float | None
) -> Outcome:
    """Compile, run and bound one program, unless its result is kept; `choice` is code, level and
    data."""
    code, level, data = choice
    outcome = Outcome(folder.name)
    with tempfile.TemporaryDirectory() as temporary:
        elf = Path(temporary) / "program.elf"
        try:
            content = compiled(folder, elf, code, level)
        except subprocess.CalledProcessError as error:
            outcome.error = f"not compiled: {error.stderr.decode()[-300:]}"
            return outcome
        plain = content.replace(temporary.encode(), b"")
        outcome.key = hashlib.sha256(plain + analysis_digest().encode()).hexdigest()[:16]
        known = kept.get(folder.name, {})
        if known.get("key") == outcome.key and known.get("bound"):
            return Outcome(**known)
        example("observe")
        return within(seconds, lambda o: _judge(folder, elf, content, data, o), outcome)


def campaign(
    folder: Path,
    choice: tuple[str, str, str],
    names: Sequence[str],
    table: Path | None,
    seconds: float | None,
) -> dict[str, Any]:
    """All programs; ratios only of those with a bound."""
    column = f"{choice[0]} -{choice[1]}, {choice[2]} data"
    kept = kept_columns(table).get(column, {})
    outcomes = []
    for path in [path for path in programs(folder) if not names or path.name in names]:
        outcome = judge(path, choice, kept, seconds)
        outcomes.append(outcome)
        if table is not None:
            kept[outcome.name] = vars(outcome)
            write_columns(table, {**kept_columns(table), column: kept})
        print(f"{outcome.name}: {outcome.ratio:.3f} {outcome.error}", file=sys.stderr, flush=True)
    if table is not None:
        write_table(table)
    bounded = [outcome for outcome in outcomes if outcome.bound]
    ratios = [outcome.ratio for outcome in bounded]
    return {
        "column": column,
        "programs": len(outcomes),
        "analysed": len(bounded),
        "below_observed": [o.name for o in bounded if o.bound < o.observed],
        "mean_ratio": sum(ratios) / len(ratios) if ratios else None,
        "median_ratio": sorted(ratios)[len(ratios) // 2] if ratios else None,
        "outcomes": [{**vars(o), "ratio": o.ratio} for o in outcomes],
    }


def kept_columns(table: Path | None) -> dict[str, dict[str, Any]]:
    """What the JSON file of a table holds."""
    path = None if table is None else _kept_file(table)
    if path is None or not path.is_file():
        return {}
    loaded: dict[str, dict[str, Any]] = json.loads(path.read_text())
    return loaded


def _kept_file(table: Path) -> Path:
    return ROOT / "build" / "verification" / f"{table.stem}.json"


def write_columns(table: Path, columns: dict[str, dict[str, Any]]) -> None:
    """Keep the results of a table in the build folder."""
    path = _kept_file(table)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(columns, indent=1, sort_keys=True) + "\n")


def write_table(path: Path) -> None:
    """The page of all kept columns."""
    columns = kept_columns(path)
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Bounds of the TACLe benchmarks",
        "",
        "Generated by `python -m verification.timing.wcet_benchmarks FOLDER --table FILE`. Cycles",
        "of `<name>_main` with one cycle for each access: bound, observed, ratio. *Own data*:",
        "memory as the image and `<name>_init` leave it, no facts. *Any data*: any contents of",
        "memory, loop bounds of the programs' pragmas.",
        "",
        "| program | "
        + " | ".join(f"{key}: bound | seen | ratio | loops given" for key in sorted(columns))
        + " |",
        "| --- |" + " ---: |" * (4 * len(columns)),
    ]
    for program in sorted({program for column in columns.values() for program in column}):
        cells = [program]
        for _, column in sorted(columns.items()):
            cells += _cells(column.get(program, {}))
        lines.append("| " + " | ".join(cells) + " |")
    for key, column in sorted(columns.items()):
        bounded = {name: row for name, row in column.items() if row["bound"]}
        ratios = sorted(row["bound"] / row["observed"] for row in bounded.values())
        if ratios:
            mean = sum(ratios) / len(ratios)
            lines += [
                "",
                f"{key}: {len(ratios)} of {len(column)} bounded, mean ratio {mean:.4f}, median "
                f"{ratios[len(ratios) // 2]:.4f}, largest {ratios[-1]:.4f}.",
            ]
        without = [f"{n} ({row['error']})" for n, row in sorted(column.items()) if not row["bound"]]
        lines += ["", f"Without a bound: {'; '.join(without)}."] if without else []
    path.write_text("\n".join(lines) + "\n")


def _cells(row: dict[str, Any]) -> list[str]:
    bound, seen = row.get("bound", 0), row.get("observed", 0)
    ratio = f"{bound / seen:.4f}" if bound and seen else "-"
    return [str(bound or "-"), str(seen or "-"), ratio, str(row.get("from_pragmas", "-"))]


def campaign_parser(description: str | None) -> argparse.ArgumentParser:
    """The options of a campaign over the programs."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--code", choices=("arm", "thumb"), default="arm")
    parser.add_argument("--level", default="O1")
    parser.add_argument("--table", type=Path, help="file for the table")
    parser.add_argument("--seconds", type=float, help="time limit for each program")
    return parser


def main() -> int:
    """Print the result; 1 when a program has no bound or exceeds it."""
    parser = campaign_parser(__doc__)
    parser.add_argument("--data", choices=("own", "any"), default="own")
    options = parser.parse_args()
    choice = (options.code, options.level, options.data)
    result = campaign(options.folder, choice, options.names, options.table, options.seconds)
    print(json.dumps(result, indent=1))
    return 1 if result["below_observed"] or result["analysed"] < result["programs"] else 0


if __name__ == "__main__":
    sys.exit(main())
