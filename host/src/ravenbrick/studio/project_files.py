# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The files of a project that the studio reads and writes: named kinds, inside its folder only."""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePath, PurePosixPath
from stat import S_IMODE
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.image.controller_origin import read_origin

__all__ = ["LARGEST_BYTES", "FileError", "ProjectFiles"]

# Languages by the end of a name; other files are neither listed nor opened.
LANGUAGES = {
    ".py": "python", ".adb": "ada", ".ads": "ada", ".gpr": "ada", ".c": "c", ".h": "c",
    ".toml": "toml", ".csv": "text", ".md": "text",
}  # fmt: skip
LEFT_OUT = {"build", "out", "__pycache__"}
GENERATED = "generated"
LARGEST_BYTES = 1_000_000
MOST_FILES = 500


class FileError(Exception):
    """Why a file is not read or written: a status of HTTP, a sentence, and the file on disk."""

    def __init__(self, status: int, sentence: str, **data: Any) -> None:
        super().__init__(sentence)
        self.status = status
        self.data = data


@dataclass(frozen=True)
class _Content:
    text: str
    version: str

    @classmethod
    def of(cls, name: str, data: bytes) -> _Content:
        try:
            return cls(data.decode("utf-8"), hashlib.sha256(data).hexdigest())
        except UnicodeDecodeError as error:
            raise FileError(
                415, f"{name}: is not UTF-8 at byte {error.start}; convert it, then open it again"
            ) from None


class ProjectFiles:
    """The files below a project folder.

    A link that leads out of the folder is taken for what it leads to, which is refused.
    """

    def __init__(self, project: Path, shown: str) -> None:
        self._project = project.resolve()
        self._shown = shown
        self._writing = threading.Lock()

    def listed(self) -> list[dict[str, Any]]:
        """Each file: path below the project, language, and why it is read-only, if it is."""
        return [
            {"path": name, "language": LANGUAGES[path.suffix], "read_only": self._reason(name)}
            for name, path in self._found()
        ]

    def scenarios(self) -> list[str]:
        """Names of the scenarios."""
        return sorted(path.stem for path in (self._project / "scenarios").glob("*.toml"))

    def state(self) -> dict[str, tuple[int, int]]:
        """Time of change and size of each file, to see which were changed."""
        found = {}
        for name, path in self._found():
            status = path.stat()
            found[name] = (status.st_mtime_ns, status.st_size)
        return found

    def read(self, name: str) -> dict[str, Any]:
        """Text and version of a file; raises `FileError`."""
        content = self._content(name, self._path(name))
        if content is None:
            raise FileError(404, f"{name}: there is no such file in the project")
        return {
            "path": name, "text": content.text, "version": content.version,
            "language": LANGUAGES[PurePosixPath(name).suffix], "read_only": self._reason(name),
        }  # fmt: skip

    def write(self, name: str, text: str, version: str | None) -> dict[str, Any]:
        """Replace the file of this version, or make a file that is not there (None).

        Raises `FileError`: with status 409 and the file as it is, when it is another version.
        """
        path = self._path(name)
        if reason := self._reason(name):
            raise FileError(403, f"{name}: {reason}")
        data = text.encode("utf-8")
        if len(data) > LARGEST_BYTES:
            raise FileError(413, f"{name}: has more than {LARGEST_BYTES} bytes; split it")
        with self._writing:
            before = self._content(name, path)
            if (before.version if before else None) != version:
                raise _conflict(name, before)
            if before is None and not path.parent.is_dir():
                raise FileError(404, f"{name}: there is no such folder in the project; make it")
            if before is not None and not os.access(path, os.W_OK):
                raise FileError(403, f"{name}: you may not write this file; change its mode")
            if before is None or before.text != text:
                atomic_write(path, data, mode=S_IMODE(path.stat().st_mode) if before else None)
        return {"path": name, "version": hashlib.sha256(data).hexdigest()}

    def inside(self, file: Path) -> str | None:
        """The name below the project of a file that the studio can open; None for others."""
        try:
            name = file.resolve().relative_to(self._project).as_posix()
            return name if self._path(name).is_file() else None
        except (ValueError, FileError):
            return None

    def _path(self, name: str) -> Path:
        named = PurePosixPath(name)
        if not name or "\0" in name or "\\" in name or named.is_absolute() or ".." in named.parts:
            raise FileError(403, f"'{name}': expected a path below the project folder")
        path = (self._project / named).resolve()
        if not path.is_relative_to(self._project):
            raise FileError(403, f"{name}: leads out of the project folder; the studio stays in it")
        if not (_known(named) and _known(path.relative_to(self._project))):
            kinds = " ".join(LANGUAGES)
            raise FileError(403, f"{name}: the studio opens sources and data only: {kinds}")
        try:
            ordinary = path.is_file() or not path.exists()
        except OSError as error:
            raise FileError(403, f"{name}: is no name of a file ({error.strerror})") from None
        if not ordinary:
            raise FileError(403, f"{name}: is no ordinary file")
        return path

    def _content(self, name: str, path: Path) -> _Content | None:
        try:
            with path.open("rb") as file:
                data = file.read(LARGEST_BYTES + 1)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise FileError(403, f"{name}: cannot be read ({error.strerror})") from None
        if len(data) > LARGEST_BYTES:
            raise FileError(413, f"{name}: has more than {LARGEST_BYTES} bytes; edit it elsewhere")
        return _Content.of(name, data)

    def _reason(self, name: str) -> str:
        """Why a file is not for editing; "" for others."""
        if PurePosixPath(name).parts[0] != GENERATED:
            return ""
        origin = read_origin(self._project / GENERATED)
        if origin is not None:
            return f"is {origin.sentence}; change the model and call the command again"
        return f"is generated by 'ravenbrick design {self._shown}'; change design.py"

    def _found(self) -> Iterator[tuple[str, Path]]:
        count = 0
        for folder, below, names in os.walk(self._project):
            here = Path(folder)
            below[:] = sorted(n for n in below if n not in LEFT_OUT and not n.startswith("."))
            for file in sorted(names):
                name = (here / file).relative_to(self._project).as_posix()
                try:
                    path = self._path(name)
                except FileError:
                    continue
                if path.is_file() and count < MOST_FILES:
                    count += 1
                    yield name, path


def _known(name: PurePath) -> bool:
    hidden = any(part in LEFT_OUT or part.startswith(".") for part in name.parts)
    return name.suffix in LANGUAGES and not hidden


def _conflict(name: str, before: _Content | None) -> FileError:
    if before is None:
        return FileError(409, f"{name}: was removed by another program", version=None, text="")
    sentence = f"{name}: was changed by another program since it was opened"
    return FileError(409, sentence, version=before.version, text=before.text)
