# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is taken from a submission, which nobody has looked at yet."""

from __future__ import annotations

import os
import re
import stat
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from ravenbrick.errors import UsageError, printable
from ravenbrick.grading.answers import ANSWERS_FILE

__all__ = [
    "DESIGN",
    "Submission",
    "SubmissionError",
    "accepted_source",
    "find_submissions",
    "read_files",
    "states",
]

DESIGN = "design.py"
# None that a tool takes for an option, a hidden file or what the binder makes.
SOURCE_NAME = re.compile(r"(?!b__)\w[\w.~+-]*\.(adb|ads|c|h)", re.ASCII)
OTHER_ARCHIVES = (".7z", ".bz2", ".gz", ".rar", ".tar", ".tgz", ".xz")
FILE_MAX = 1_000_000
TOTAL_MAX = 8_000_000
FILES_MAX = 500
ARCHIVE_MAX = 20_000_000
ENTRIES_MAX = 10_000
DEPTH_MAX = 16
ENCRYPTED = 1  # ZIP file format specification (APPNOTE) 4.4.4
# Bytes: a result's file has the name and some endings.
NAME_MAX = 200
SAID = 100


class SubmissionError(Exception):
    """What is wrong with a submission, for the student."""


@dataclass(frozen=True)
class Submission:
    """A folder or a zip archive; `name` tells the student, unique in a campaign."""

    name: str
    path: Path


def _readable(name: str) -> str:
    """A name that any terminal and file shows: the file system's may be any bytes."""
    text = os.fsencode(name).decode("utf-8", "backslashreplace")
    shown = printable(text).replace("\n", "?").replace("/", "?")
    return shown.encode()[:NAME_MAX].decode("utf-8", "ignore") or "?"


def _is_archive(path: Path) -> bool:
    return path.suffix.lower() in (".zip", *OTHER_ARCHIVES)


def _named(path: Path) -> Submission:
    name = path.name
    return Submission(_readable(name[:-4] if name.lower().endswith(".zip") else name), path)


def find_submissions(paths: list[Path]) -> list[Submission]:
    """Each path is a submission, or a folder of submissions; raises `UsageError`."""
    found: list[Submission] = []
    for path in paths:
        if _is_archive(path) and not path.is_dir():
            found.append(_named(path.resolve()))
        elif (path / "src").is_dir() or (path / ANSWERS_FILE).is_file():
            found.append(_named(path.resolve()))
        elif path.is_dir():
            inner = sorted(p for p in path.iterdir() if _is_archive(p) or p.is_dir())
            found += _distinct([_named(p) for p in inner])
        else:
            raise UsageError(f"'{path}' is neither a folder nor a .zip file; name a submission")
    doubled = sorted(n for n, count in Counter(s.name for s in found).items() if count > 1)
    if doubled:
        raise UsageError(f"several submissions are called '{doubled[0]}'; rename them")
    if not found:
        raise UsageError("there is no submission; name folders with src/, or .zip files")
    return found


def _distinct(found: list[Submission]) -> list[Submission]:
    """Of one folder: a folder and an archive of one name are told apart by their whole names."""
    counts = Counter(s.name for s in found)
    whole = [
        s if counts[s.name] == 1 else Submission(_readable(s.path.name), s.path) for s in found
    ]
    seen: Counter[str] = Counter()
    for place, submission in enumerate(whole):
        seen[submission.name] += 1
        if seen[submission.name] > 1:
            name = f"{submission.name}-{seen[submission.name]}"
            whole[place] = Submission(name, submission.path)
    return whole


@dataclass(frozen=True)
class _Found:
    """A regular file below a submission's folder; `place` is its open folder, while it is found."""

    inside: PurePosixPath
    place: int
    state: os.stat_result

    def read(self) -> bytes:
        """Its beginning; raises `OSError` for what has become a link meanwhile."""
        flags = os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW
        with os.fdopen(os.open(self.inside.name, flags, dir_fd=self.place), "rb") as stream:
            return stream.read(FILE_MAX + 1)


def _walk(top: Path) -> Iterator[_Found]:
    """Regular files below a folder, never through a link; raises `SubmissionError`."""

    def refuse(error: OSError) -> None:
        raise error

    count = 0
    for folder, inner, names, place in os.fwalk(top, onerror=refuse):
        inside = PurePosixPath(folder).relative_to(top)
        if len(inside.parts) > DEPTH_MAX:
            raise SubmissionError(f"has folders more than {DEPTH_MAX} deep; submit src/ alone")
        count += len(inner) + len(names)
        if count > ENTRIES_MAX:
            raise SubmissionError(f"has more than {ENTRIES_MAX} files; submit src/ alone")
        inner.sort()
        for name in sorted(names):
            state = os.stat(name, dir_fd=place, follow_symlinks=False)
            if stat.S_ISREG(state.st_mode):
                yield _Found(inside / name, place, state)


def _in_folder(top: Path, folders: tuple[str, ...]) -> Iterator[tuple[PurePosixPath, int, bytes]]:
    for found in _walk(top):
        if _is_wanted(found.inside, folders):
            content = found.read()
            yield found.inside, len(content), content


def _in_archive(path: Path, folders: tuple[str, ...]) -> Iterator[tuple[PurePosixPath, int, bytes]]:
    if path.suffix.lower() != ".zip":
        raise SubmissionError(f"is a {path.suffix} file; submit a .zip file")
    file = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
    with os.fdopen(file, "rb") as stream:
        state = os.fstat(file)
        if not stat.S_ISREG(state.st_mode):
            raise SubmissionError("is not a file; submit a .zip file")
        if state.st_size > ARCHIVE_MAX:
            raise SubmissionError(
                f"is larger than {ARCHIVE_MAX // 1_000_000} MB; submit src/ alone"
            )
        with zipfile.ZipFile(stream) as archive:
            if len(archive.infolist()) > ENTRIES_MAX:
                raise SubmissionError(f"has more than {ENTRIES_MAX} files; submit src/ alone")
            for info in sorted(archive.infolist(), key=lambda info: info.filename):
                name = PurePosixPath(info.filename.replace("\\", "/"))
                if not info.is_dir() and _is_wanted(name, folders):
                    if info.flag_bits & ENCRYPTED:
                        raise SubmissionError("has a password; submit it without one")
                    small = info.file_size <= FILE_MAX
                    yield name, info.file_size, archive.read(info) if small else b""


def accepted_source(name: str, folders: tuple[str, ...]) -> bool:
    """Whether a name, its last two parts, is that of an Ada or C file in one of the folders."""
    path = PurePosixPath(name)
    return path.parent.name in folders and SOURCE_NAME.fullmatch(path.name) is not None


def _is_wanted(name: PurePosixPath, folders: tuple[str, ...]) -> bool:
    return name.name in (ANSWERS_FILE, DESIGN) or accepted_source(str(name), folders)


def read_files(
    submission: Submission, folders: tuple[str, ...], must_have: bool = True
) -> dict[str, bytes]:
    """Sources by `folder/file`, at any depth, answers.toml and design.py by their names.

    Raises `SubmissionError`, also when there are no sources but `must_have` is true.
    """
    files: dict[str, bytes] = {}
    path, read = submission.path, 0
    inside = _in_folder if path.is_dir() else _in_archive
    try:
        if path.is_symlink():
            raise SubmissionError("is a link to another place; submit the files themselves")
        for name, size, content in inside(path, folders):
            if size > FILE_MAX or len(files) >= FILES_MAX:
                raise SubmissionError(f"has too many files, or '{name}' is too large")
            alone = name.name in (ANSWERS_FILE, DESIGN)
            files.setdefault(name.name if alone else f"{name.parent.name}/{name.name}", content)
            read += len(content)
            if read > TOTAL_MAX:
                raise SubmissionError(f"has more than {TOTAL_MAX // 1_000_000} MB of sources")
    except SubmissionError:
        raise
    except Exception as error:
        # Readers of archives raise whatever their parts do: a student's file must not end a class.
        said = " ".join(str(error).split())[:SAID] or type(error).__name__
        raise SubmissionError(f"cannot be read ({said}); submit it again") from None
    if must_have and not any(name.startswith("src/") for name in files):
        raise SubmissionError("has no Ada or C sources below src/")
    return files


def states(submission: Submission) -> Iterable[str]:
    """Changes with any file of the submission; a folder that cannot be read has its own state."""
    path = submission.path
    try:
        if path.is_symlink() or not path.is_dir():
            return [_state(path.lstat(), path.name)]
        return [_state(found.state, str(found.inside)) for found in _walk(path)]
    except (OSError, SubmissionError) as error:
        return [str(error)]


def _state(found: os.stat_result, name: str) -> str:
    return f"{name!r} {found.st_size} {found.st_mtime_ns} {found.st_ctime_ns}"
