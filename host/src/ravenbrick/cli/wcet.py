# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick wcet`: the longest execution time and the deepest stack of one function."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from elftools.elf.elffile import ELFFile

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import built_file
from ravenbrick.errors import RavenbrickError, UsageError
from ravenbrick.report.page import page
from ravenbrick.schemas.located_toml import utf8_text
from ravenbrick.timing.bounds import Bounds, ExecutionTimeError, execution_times, recursion_words
from ravenbrick.timing.dispatch.dispatching_calls import DispatchingCalls
from ravenbrick.timing.facts.unmatched_facts import check_annotation_file
from ravenbrick.timing.results.worst_path import expensive_lines, path_table, source_lines

__all__ = ["wcet_command"]

# The end of the RAM.
STACK_POINTER = 0x0021_0000
Timing = Literal["plain", "optimistic", "nominal", "pessimistic"]


def _bounded(
    elf: Path, content: bytes, annotations: Sequence[tuple[str, str]], options: dict[str, Any]
) -> Bounds:
    """Bounds, and only if these leave a question, with the targets of dispatching calls."""

    named = annotations or [("an annotation file", "")]  # the first is where questions want answers

    def ask(more: Sequence[tuple[str, str]]) -> Bounds:
        return execution_times(content, annotations=[*named, *more], **options)

    try:
        return ask([])
    except ExecutionTimeError:
        return DispatchingCalls(elf, content).answer(ask)


def _lines(report: dict[str, Any]) -> list[list[str]]:
    """The longest path by source line: executions of its first block there."""
    counts: dict[str, int] = {}
    for function in report["functions"]:
        for block in function["path"]:
            line = block["at"]["line"]
            if line is not None:
                times = block["count"] * function["calls"]
                counts[line] = max(counts.get(line, 0), times)

    def place(item: tuple[str, int]) -> tuple[str, int]:
        file, _, number = item[0].rpartition(":")
        return file, int(number)

    return [[line, str(count)] for line, count in sorted(counts.items(), key=place)]


def _print(reporter: Reporter, result: dict[str, Any]) -> None:
    stack = result["stack_bytes"]
    reporter.print(
        f"{result['symbol']}: at most {result['cycles']} cycles ({result['timing']}), stack "
        + ("not bounded" if stack is None else f"{stack} bytes")
    )
    rows = [[f["symbol"], str(f["calls"]), str(f["cycles"])] for f in result["report"]["functions"]]
    reporter.table(("on the longest path", "calls", "cycles each"), rows)
    reporter.table(("source line", "executions"), _lines(result["report"]))
    for line in recursion_words(result["report"]):
        reporter.print(f"  {line}; --own-data follows a recursion")


def _own_data(
    content: bytes, calls: list[str], inputs: list[str], options: dict[str, Any]
) -> dict[str, Any]:
    """Bound of the last function, with the memory that the image and the calls before it leave."""
    known = (calls, STACK_POINTER)
    found = execution_times(content, known_memory=known, inputs=inputs, **options)
    return {
        "symbol": calls[-1],
        "timing": found.timing,
        "cycles": (found.known_memory_cycles or 0) + found.return_cycles,
        "lines": [{"line": line, "executions": count} for line, count in found.known_memory_lines],
    }


def _print_own_data(reporter: Reporter, result: dict[str, Any]) -> None:
    reporter.print(
        f"{result['symbol']}, own data: at most {result['cycles']} cycles ({result['timing']})"
    )
    rows = [[row["line"], str(row["executions"])] for row in result["lines"]]
    reporter.table(("source line", "executions"), rows)


def _write_html(file: Path, elf: Path, found: Bounds) -> None:
    """The worst path on the source lines."""
    bound = found.functions[0]
    function = path_table(bound.path or {}, source_lines(elf.read_bytes()))
    text = page(
        "worst_path.html",
        title=f"{bound.symbol}: worst path",
        bound_cycles=bound.cycles + found.return_cycles,
        return_cycles=found.return_cycles,
        timing=found.timing,
        function=function,
        expensive=expensive_lines(function),
    )
    atomic_write(file, text)


def _with_names(error: RavenbrickError, elf: Path, calls: list[str]) -> RavenbrickError:
    """The error, or the one that names a function which the file does not have."""
    with elf.open("rb") as file:
        table: Any = ELFFile(file).get_section_by_name(".symtab")
        symbols = [] if table is None else list(table.iter_symbols())
    known = [symbol.name for symbol in symbols if symbol["st_info"]["type"] == "STT_FUNC"]
    for name in calls:
        if name not in known:
            close = difflib.get_close_matches(name, known, 3)
            advice = f"did you mean {' or '.join(close)}?" if close else f"'nm {elf}' lists them"
            return UsageError(f"{elf}: there is no function '{name}'; {advice}")
    return error


@command("ravenbrick wcet build/vehicle/ram/vehicle.elf functional_step_instance")
def wcet_command(
    elf: Annotated[Path, typer.Argument(help="ELF file for the ARM7TDMI.")],
    symbol: Annotated[str, typer.Argument(help="Name of the function.")],
    annotations: Annotated[
        list[Path] | None, typer.Option(help="TOML file with flow facts, such as loop bounds.")
    ] = None,
    timing: Annotated[Timing, typer.Option(help="Memory timing profile.")] = "nominal",
    wait_states: Annotated[int, typer.Option(min=0, max=3, help="Flash wait states.")] = 1,
    own_data: Annotated[
        bool,
        typer.Option(
            "--own-data", help="Bound for the memory contents that image and --after leave."
        ),
    ] = False,
    after: Annotated[
        list[str] | None,
        typer.Option(help="Function called first; with --own-data; may be repeated."),
    ] = None,
    any_content: Annotated[
        list[str] | None,
        typer.Option(help="Variable with unknown content; with --own-data; may be repeated."),
    ] = None,
    html: Annotated[
        Path | None, typer.Option(help="HTML file for the worst path on the source lines.")
    ] = None,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    reporter = Reporter(json_output)
    if not built_file(elf, reporter).is_file():
        raise UsageError(f"{elf}: there is no such file; name an ELF file")
    if not own_data and (after or any_content):
        raise UsageError("--after and --any-content need --own-data; add it")
    if own_data and html is not None:
        raise UsageError("--html shows the worst path for any data; omit --own-data")
    files = [(str(path), utf8_text(path)) for path in annotations or []]
    content = elf.read_bytes()
    options: dict[str, Any] = {"timing": timing, "wait_states": wait_states, "name": str(elf)}
    calls = [*(after or []), symbol]
    try:
        for path, (_, text) in zip(annotations or [], files, strict=True):
            check_annotation_file(path, text, content, str(elf))
        if own_data:
            options["annotations"] = files
            result = _own_data(content, calls, any_content or [], options)
            _print_own_data(reporter, result)
            return result
        options |= {"functions": [symbol], "paths": html is not None}
        found = _bounded(elf, content, files, options)
    except ExecutionTimeError as error:
        raise _with_names(error, elf, calls) from None
    bound = found.functions[0]
    result = {
        "symbol": symbol,
        "timing": found.timing,
        "cycles": bound.cycles + found.return_cycles,
        "stack_bytes": bound.stack_bytes,
        "report": bound.report,
    }
    _print(reporter, result)
    if html is not None:
        _write_html(html, elf, found)
        reporter.print(f"  {html}")
    return result
