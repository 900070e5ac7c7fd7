# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is taken from a submission, which nobody has looked at yet."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from ravenbrick.errors import UsageError
from ravenbrick.grading.answers import ANSWERS_FILE

__all__ = ["Submission", "find_submissions", "read_sources", "refusal"]

SUFFIXES = (".adb", ".ads", ".c", ".h")
LARGEST = 1_000_000
MOST = 500
# Options for host tools have no place in a source file: they could load a plug-in of the linker.
FORBIDDEN = re.compile(
    rb"\bLinker_Options\b|\.incbin\b|\bmachine_attribute\b.*plugin", re.IGNORECASE
)
OUTSIDE = re.compile(rb'^\s*#\s*include\s*["<](/|[^">]*\.\.)', re.MULTILINE)


@dataclass(frozen=True)
class Submission:
    """A folder or a zip archive; `name` tells the student, unique in a campaign."""

    name: str
    path: Path


def find_submissions(paths: list[Path]) -> list[Submission]:
    """Each path is a submission, or a folder of submissions; raises `UsageError`."""
    found: list[Submission] = []
    for path in paths:
        if path.is_file() and path.suffix == ".zip":
            found.append(Submission(path.stem, path))
        elif (path / "src").is_dir() or (path / ANSWERS_FILE).is_file():
            found.append(Submission(path.resolve().name, path))
        elif path.is_dir():
            inner = sorted(p for p in path.iterdir() if p.suffix == ".zip" or p.is_dir())
            found += [Submission(p.stem if p.is_file() else p.name, p) for p in inner]
        else:
            raise UsageError(f"'{path}' is neither a folder nor a .zip file; name a submission")
    names = [submission.name for submission in found]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise UsageError(f"several submissions are called '{doubled[0]}'; rename them")
    if not found:
        raise UsageError("there is no submission; name folders with src/, or .zip files")
    return found


def _members(submission: Submission) -> Iterator[tuple[PurePosixPath, int, bytes]]:
    """Name, size and content of every small file, whatever it is."""
    if submission.path.is_dir():
        for path in sorted(submission.path.rglob("*")):
            if path.is_file() and not path.is_symlink():
                size = path.stat().st_size
                name = PurePosixPath(path.relative_to(submission.path).as_posix())
                yield name, size, path.read_bytes() if size <= LARGEST else b""
        return
    with zipfile.ZipFile(submission.path) as archive:
        for info in sorted(archive.infolist(), key=lambda info: info.filename):
            if not info.is_dir():
                small = info.file_size <= LARGEST
                content = archive.read(info) if small else b""
                yield PurePosixPath(info.filename), info.file_size, content


def read_sources(
    submission: Submission, folders: tuple[str, ...], must_have: bool = True
) -> dict[str, bytes]:
    """Sources by `folder/file`, at any depth of an archive, and answers.toml by its name.

    Raises `UsageError`, also when there are no sources but `must_have` is true.
    """
    sources: dict[str, bytes] = {}
    try:
        for name, size, content in _members(submission):
            if name.name == ANSWERS_FILE and 0 < size <= LARGEST:
                sources.setdefault(ANSWERS_FILE, content)
                continue
            if name.suffix not in SUFFIXES or name.parent.name not in folders:
                continue
            if size > LARGEST or len(sources) >= MOST:
                raise UsageError(f"{submission.name}: '{name}' is too large, or too many files")
            sources[f"{name.parent.name}/{name.name}"] = content
    except (zipfile.BadZipFile, OSError, RuntimeError) as error:
        raise UsageError(f"{submission.name}: cannot be read ({error}); submit it again") from None
    if must_have and not any(name.startswith("src/") for name in sources):
        raise UsageError(f"{submission.name}: has no Ada or C sources below src/")
    return sources


def refusal(sources: dict[str, bytes]) -> str | None:
    """Why sources are not compiled: options for tools of the host, or files outside."""
    for name, content in sorted(sources.items()):
        for pattern in (FORBIDDEN, OUTSIDE):
            match = pattern.search(content)
            if match:
                line = content.count(b"\n", 0, match.start()) + 1
                text = match.group(0).decode("utf-8", "replace").strip()
                return f"{name}:{line}: '{text}' is not allowed in a submission; remove it"
    return None
