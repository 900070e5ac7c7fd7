# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The lab sheets, executed: `python -m tools.docs.lessons [SHEET ...]`; without names, all.

In a sheet, a fence `console` holds commands, one a line, which are run in a folder of the sheet's
own; `console exit=8` expects the last one to end with 8. `LANGUAGE file=PATH` writes its content to
the file; `edit file=PATH` replaces lines of it, written as in a diff. `text seen` after commands
quotes lines that their output must contain, blanks apart. Afterwards the lecturer's page of the
same name is executed in the same folder.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHEETS = ROOT / "docs" / "lessons"
TEACHING = ROOT / "docs" / "teaching"
FENCE = re.compile(r"^```(\w+)(?: (\w+)(?:=(\S+))?)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class SheetError(Exception):
    """A step that does not do what the sheet says; the text names sheet and line."""


@dataclass(frozen=True)
class Step:
    """A fence with what it asks for: `console`, `file`, `edit` or `seen`."""

    line: int
    kind: str
    argument: str
    content: str


def steps(text: str) -> Iterator[Step]:
    """The fences that are to be executed, in order."""
    for match in FENCE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        language, word, value, content = match.groups()
        if language == "console":
            yield Step(line, "console", value or "0", content)
        elif word == "file":
            yield Step(line, "edit" if language == "edit" else "file", value, content)
        elif (language, word) == ("text", "seen"):
            yield Step(line, "seen", "", content)


def files_of(sheet: Path) -> dict[str, str]:
    """What a sheet writes, by path; the first of several."""
    found: dict[str, str] = {}
    for step in steps(sheet.read_text("utf-8")):
        if step.kind == "file":
            found.setdefault(step.argument, step.content)
    return found


def edited(text: str, change: str) -> str:
    """The text after a fence `edit`: lines with `-` go, with `+` come, others are context.

    Places are separated by a line `...`. Raises `SheetError` for old lines that are not there
    exactly once.
    """
    for place in re.split(r"^\.\.\.\n", change, flags=re.MULTILINE):
        rows = [(line[:1] or " ", line[1:] + "\n") for line in place.splitlines()]
        old = "".join(line for sign, line in rows if sign != "+")
        new = "".join(line for sign, line in rows if sign != "-")
        count = len(re.findall(rf"^{re.escape(old)}", text, re.MULTILINE)) if old else 0
        if count != 1:
            raise SheetError(f"these lines are there {count} times, not once:\n{old}")
        begin = ("\n" + text).index("\n" + old)
        text = text[:begin] + new + text[begin + len(old) :]
    return text


def captioned(text: str, caption: str) -> str:
    """A sheet as it is read: fences that write or change a file say which.

    `caption` is how a fence with a caption begins; {language} and {file} stand for themselves.
    The empty line before the fence goes, so a caption of one line leaves the numbers of lines.
    """

    def opening(match: re.Match[str]) -> str:
        language = match[1].replace("edit", "diff")
        return caption.replace("{language}", language).replace("{file}", match[2])

    return re.sub(r"(?:^\n)?^```(\w+) file=(\S+)$", opening, text, flags=re.MULTILINE)


def _plain(text: str) -> str:
    return " ".join(text.split())


def _execute(step: Step, folder: Path) -> str:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {k: v for k, v in os.environ.items() if k != "RAVENBRICK_BUILD"}
    environment |= {"PATH": path, "COLUMNS": "160"}
    commands = [line for line in step.content.splitlines() if line.strip()]
    output = ""
    for number, command in enumerate(commands, 1):
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        output += done.stdout
        wanted = int(step.argument) if number == len(commands) else 0
        if done.returncode != wanted:
            raise SheetError(
                f"'{command}' ended with {done.returncode}, not {wanted}:\n{done.stdout[-2000:]}"
            )
    return output


def run_sheet(sheet: Path, folder: Path) -> str:
    """Execute a sheet in an empty folder; all output. Raises `SheetError`."""
    return run_text(sheet.read_text("utf-8"), sheet.name, folder)


def part(text: str, heading: str) -> str:
    """The part of a page below a heading of the second level, the lines before it left empty."""
    found = re.search(rf"^## {re.escape(heading)}\n.*?(?=^## |\Z)", text, re.M | re.S)
    return "" if found is None else "\n" * text.count("\n", 0, found.start()) + found.group(0)


def teaching_page(sheet: Path) -> Path:
    """The lecturer's page of a sheet."""
    return TEACHING / sheet.name


def solution_of(sheet: Path) -> str:
    """The steps of the lecturer's page that solve the sheet. Raises `SheetError`."""
    page = teaching_page(sheet)
    solution = part(page.read_text("utf-8"), "Solution") if page.is_file() else ""
    if not solution:
        raise SheetError(f"{page.relative_to(ROOT)} has no part 'Solution'")
    return solution


def rubrics_of(sheet: Path) -> list[Path]:
    """The sheet's rubrics, one for each milestone."""
    return sorted((SHEETS / "rubrics").glob(f"lab-{sheet.name[:2]}*.toml"))


def run_solution(sheet: Path, folder: Path) -> str:
    """Execute the solution where the sheet was executed before. Raises `SheetError`."""
    return run_text(solution_of(sheet), f"teaching/{sheet.name}", folder)


def run_teaching_page(sheet: Path, folder: Path) -> str:
    """Execute the solution and the rest of the lecturer's page likewise. Raises `SheetError`."""
    text = teaching_page(sheet).read_text("utf-8")
    return run_text(text, f"teaching/{sheet.name}", folder)


def run_text(text: str, name: str, folder: Path) -> str:
    """Execute the steps of a text."""
    output, transcript = "", ""
    for step in steps(text):
        try:
            if step.kind == "file":
                path = folder / step.argument
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(step.content, encoding="utf-8")
            elif step.kind == "edit":
                path = folder / step.argument
                text_now = path.read_text("utf-8") if path.is_file() else ""
                path.write_text(edited(text_now, step.content), encoding="utf-8")
            elif step.kind == "console":
                output = _execute(step, folder)
                transcript += output
            else:
                seen = _plain(output)
                for line in filter(None, map(_plain, step.content.splitlines())):
                    if line not in seen:
                        raise SheetError(f"'{line}' is not in the output:\n{output[-3000:]}")
        except SheetError as error:
            raise SheetError(f"{name}:{step.line}: {error}") from None
    return transcript


def find(names: list[str]) -> list[Path]:
    """Sheets by the beginning of their file names, all without names."""
    sheets = sorted(SHEETS.glob("[0-9][0-9]-*.md"))
    return [s for s in sheets if not names or any(s.name.startswith(name) for name in names)]


def main() -> int:
    """Run sheets; 1 when one fails."""
    parser = argparse.ArgumentParser(description="Execute lab sheets and compare their output.")
    parser.add_argument("sheets", nargs="*", help="numbers of the sheets: 01, 02, ...")
    parser.add_argument("--show", action="store_true", help="print all output")
    arguments = parser.parse_args()
    failed = 0
    for sheet in find(arguments.sheets):
        with tempfile.TemporaryDirectory() as folder:
            try:
                transcript = run_sheet(sheet, Path(folder))
                transcript += run_teaching_page(sheet, Path(folder))
            except SheetError as error:
                failed += 1
                print(f"FAILED {error}", flush=True)
                continue
        print(f"{sheet.name}: as written", flush=True)
        if arguments.show:
            print(transcript, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
