# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Loop bounds that Ada sources state themselves.

In a loop, `pragma Annotate (Ravenbrick, Iterations, 47, "why");` says that no loop of the code that
comes from the lines of this statement, inner loop statements aside, has more iterations for each
entry. The compiler does nothing with it (GNAT Reference Manual, pragma Annotate).
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile

from ravenbrick.errors import ImageFileError, ProjectFileError
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.timing.facts import annotations_of

__all__ = ["SourceFacts", "SourceLoop", "annotated_loops", "source_facts"]

PRAGMA = "pragma Annotate"
TOKEN = re.compile(r'--[^\n]*|"(?:[^"\n]|"")*"|\'.\'|\w+|=>|[^\s\w]')
FORM = re.compile(
    r'pragma annotate \( ravenbrick , iterations , ([0-9][0-9_]*)(?: , ("(?:[^"]|"")*"))? \)\Z',
    re.IGNORECASE,
)
OURS = re.compile(r"pragma annotate \( ravenbrick\b", re.IGNORECASE)
EXPECTED = (
    "is not understood; expected, in a loop, "
    'pragma Annotate (Ravenbrick, Iterations, 47, "why it has no more iterations");'
)


@dataclass
class SourceLoop:
    """A loop statement: its lines, those of inner ones, and what it says about itself."""

    first: int
    last: int = 0
    iterations: int | None = None
    reason: str = ""
    inner: list[SourceLoop] = field(default_factory=list)

    def lines(self) -> list[int]:
        """Its lines without those of inner loop statements."""
        others = {line for loop in self.inner for line in range(loop.first, loop.last + 1)}
        return [line for line in range(self.first, self.last + 1) if line not in others]


def _tokens(text: str) -> Iterator[tuple[str, int]]:
    line, position = 1, 0
    for found in TOKEN.finditer(text):
        line += text.count("\n", position, found.start())
        position = found.start()
        if not found.group().startswith("--"):
            yield found.group(), line


def _note(path: Path, line: int, words: list[str], open_loops: list[SourceLoop]) -> None:
    """Take in a pragma, which is over."""
    statement = " ".join(words)
    if OURS.match(statement) is None:
        return
    found = FORM.match(statement)
    if found is None or not open_loops:
        raise ProjectFileError(path, line, PRAGMA, EXPECTED)
    open_loops[-1].iterations = int(found[1].replace("_", ""))
    open_loops[-1].reason = (found[2] or '""')[1:-1].replace('""', '"')


def annotated_loops(path: Path, text: str) -> list[SourceLoop]:
    """The loop statements of an Ada source that say how often they are repeated.

    Raises `ProjectFileError` for a pragma that is not understood.
    """
    found: list[SourceLoop] = []
    open_loops: list[SourceLoop] = []
    begin: int | None = None
    pragma: tuple[int, list[str]] | None = None
    before = ""
    for token, line in _tokens(text):
        word = token.lower()
        if pragma is not None:
            if word == ";":
                _note(path, *pragma, open_loops)
                pragma = None
            else:
                pragma[1].append(token)
        elif word == "pragma":
            pragma = line, [token]
        elif word in ("for", "while"):
            begin = line
        elif word in (";", "=>"):
            begin = None
        elif word == "loop" and before == "end":
            if open_loops:
                open_loops.pop().last = line
        elif word == "loop":
            loop = SourceLoop(line if begin is None else begin)
            if open_loops:
                open_loops[-1].inner.append(loop)
            open_loops.append(loop)
            found.append(loop)
            begin = None
        before = word
    return [loop for loop in found if loop.iterations is not None]


def _source_files(image: ElfImage) -> list[Path]:
    """Ada sources that the image's line tables name and that are there."""
    elf = ELFFile(io.BytesIO(image.content))
    if not elf.has_dwarf_info():
        return []
    dwarf = elf.get_dwarf_info()
    found: set[Path] = set()
    for unit in dwarf.iter_CUs():
        program = dwarf.line_program_for_CU(unit)
        if program is None:
            continue
        folder = unit.get_top_DIE().attributes.get("DW_AT_comp_dir")
        home = Path("" if folder is None else folder.value.decode())
        folders = _folders(program.header, home)
        for entry in program.header["file_entry"]:
            name = entry.name.decode()
            if name.endswith((".adb", ".ads")) and entry.dir_index < len(folders):
                found.add(folders[entry.dir_index] / name)
    return sorted(path for path in found if path.is_file())


def _folders(header: Any, home: Path) -> list[Path]:
    """By index in the line table (DWARF 5, section 6.2.4; before, 0 is the compiler's folder)."""
    named = [home / name.decode() for name in header["include_directory"]]
    return named if header["version"] >= 5 else [home, *named]


@dataclass(frozen=True)
class SourceFacts:
    """The loop statements of an image's sources that say how often they are repeated."""

    loops: tuple[tuple[Path, SourceLoop], ...]

    @property
    def annotations(self) -> list[tuple[str, str]]:
        """Facts for each line of a loop: name and TOML."""
        rows = [
            _row(loop, file=path.name, line=line)
            for path, loop in self.loops
            for line in loop.lines()
        ]
        return [("sources", annotations_of({"loop": rows}))]

    def answers(self, missing: Sequence[dict[str, Any]]) -> str:
        """For loops that begin with an inlined call: the statement with most of their lines."""
        rows = []
        for asked in missing:
            own = {(file.rpartition("/")[2], line) for file, line in asked["lines"]}
            shares = [
                (sum((path.name, line) in own for line in loop.lines()), loop)
                for path, loop in self.loops
            ]
            most = max((share for share, _ in shares), default=0)
            found = [loop for share, loop in shares if share == most]
            if most and len(found) == 1:
                rows.append(_row(found[0], symbol=asked["symbol"], index=asked["index"]))
        return annotations_of({"loop": rows})


def _row(loop: SourceLoop, **place: str | int) -> dict[str, Any]:
    return {**place, "iterations": loop.iterations, "reason": loop.reason}


def source_facts(image: ElfImage) -> SourceFacts:
    """What the image's sources say.

    Raises `ImageFileError` when a source with facts is newer than the image, and
    `ProjectFileError` for a pragma that is not understood.
    """
    try:
        files = _source_files(image)
    except (ELFError, ValueError, KeyError):
        return SourceFacts(())
    found: list[tuple[Path, SourceLoop]] = []
    for path in files:
        loops = annotated_loops(path, path.read_text("utf-8", errors="replace"))
        if loops:
            _check_age(path, image)
        found += [(path, loop) for loop in loops]
    return SourceFacts(tuple(found))


def _check_age(path: Path, image: ElfImage) -> None:
    """Lines of a source that has changed are not those of the code."""
    if path.stat().st_mtime > image.path.stat().st_mtime:
        raise ImageFileError(
            f"{image.path}: is older than {path}, whose loop bounds are needed; build it again "
            "with 'ravenbrick build'"
        )
