# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Loop bounds that Ada sources state themselves.

In a loop, `pragma Annotate (Ravenbrick, Iterations, 47, "why");` says that the statement has no
more iterations for each entry; with a device as one more argument, no more than robot.toml has
ports with it, if these are fewer (but at least one). The compiler does nothing with it (GNAT
Reference Manual, pragma Annotate). Which code is the statement's is decided where the code is
known, so all statements are told, also those that say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elftools.common.exceptions import ELFError

from ravenbrick.errors import ImageFileError, ProjectFileError
from ravenbrick.image.build import manifest_file
from ravenbrick.image.elf import ElfImage
from ravenbrick.image.manifest import BuildManifest, file_digest
from ravenbrick.image.source_texts import named_sources
from ravenbrick.timing.facts.facts import annotations_of

__all__ = ["SourceLoop", "check_age", "loop_statements", "source_facts", "statements_text"]

PRAGMA = "pragma Annotate"
TOKEN = re.compile(r'--[^\n]*|"(?:[^"\n]|"")*"|\'.\'|\w+|=>|[^\s\w]')
FORM = re.compile(
    r"pragma annotate \( ravenbrick , iterations , ([0-9][0-9_]*)"
    r'(?: , ("(?:[^"]|"")*")(?: , "(\w+)")?)? \)\Z',
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
    depth: int = 0
    last: int = 0
    iterations: int | None = None
    reason: str = ""
    device: str | None = None
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
    open_loops[-1].device = found[3]


def loop_statements(path: Path, text: str) -> list[SourceLoop]:
    """The loop statements of an Ada source.

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
            loop = SourceLoop(line if begin is None else begin, len(open_loops))
            if open_loops:
                open_loops[-1].inner.append(loop)
            open_loops.append(loop)
            found.append(loop)
            begin = None
        before = word
    return found


def _source_files(image: ElfImage) -> list[Path]:
    """Ada sources that the image's line tables name and that are there."""
    files = (Path(name) for name in named_sources(image.content) if name.endswith((".adb", ".ads")))
    return sorted(path for path in files if path.is_file())


def statements_text(path: Path, loops: list[SourceLoop], devices: Collection[str] = ()) -> str:
    """Loop statements as TOML for the execution-time analysis; `devices` are those of the ports."""
    rows: list[dict[str, Any]] = []
    for loop in loops:
        row: dict[str, Any] = {"file": path.name, "lines": loop.lines(), "depth": loop.depth}
        if loop.iterations is not None:
            most = loop.iterations
            if loop.device is not None and devices:
                most = min(most, max(1, list(devices).count(loop.device)))
            row |= {"iterations": most, "reason": loop.reason}
        rows.append(row)
    return annotations_of({"statement": rows})


def source_facts(image: ElfImage, devices: Collection[str] = ()) -> list[tuple[str, str]]:
    """What the image's sources say about their loops: names of files and TOML. `devices` are those
    of the robot's ports.

    Raises `ImageFileError` when a source with facts is newer than the image, and
    `ProjectFileError` for a pragma that is not understood.
    """
    try:
        files = _source_files(image)
    except (ELFError, ValueError, KeyError):
        return []
    found = []
    for path in files:
        loops = loop_statements(path, path.read_text("utf-8", errors="replace"))
        if any(loop.iterations is not None for loop in loops):
            check_age(path, image.path)
        found.append((str(path), statements_text(path, loops, devices)))
    return found


def check_age(path: Path, elf: Path) -> None:
    """Lines of a source that has changed are not those of the code; saved anew is not changed.

    Raises `ImageFileError`.
    """
    if path.stat().st_mtime <= elf.stat().st_mtime:
        return
    manifest = BuildManifest.read(manifest_file(elf))
    _, digest = manifest.files.get(str(path), ([], "")) if manifest else ([], "")
    if digest != file_digest(path):
        raise ImageFileError(
            f"{elf}: is older than {path}, whose loop bounds are needed; build it again "
            "with 'ravenbrick build'"
        )
