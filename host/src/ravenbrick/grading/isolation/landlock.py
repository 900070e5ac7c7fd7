# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Landlock with a filter of system calls: a border for hosts without namespaces.

Such hosts are containers with their default settings, and distributions whose AppArmor forbids
user namespaces. The rules are set by `confinement.py`. Names, sizes and dates of other files can
be asked for; their content cannot be read.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from ravenbrick.grading.isolation.border import (
    MEGABYTE,
    PATH,
    SYSTEM,
    SYSTEM_FILES,
    SYSTEM_PARTS,
    Bounds,
    Isolation,
    other_user,
)
from ravenbrick.grading.isolation.calls import filter_file

__all__ = ["Landlock"]

CONFINEMENT = Path(__file__).with_name("confinement.py")
BLOCK = 512  # bytes, of st_blocks
READ_BOUNDING_SET = 23
LIBC = ctypes.CDLL(None)


class Landlock(Isolation):
    """Rules of the kernel for one process and its children."""

    name = "Landlock and seccomp"
    path = PATH

    @contextmanager
    def call(
        self,
        command: Sequence[str],
        bounds: Bounds,
        readable: Sequence[Path],
        hidden: Sequence[Path],
    ) -> Iterator[tuple[list[str], Path]]:
        system = [Path("/") / name for name in SYSTEM_PARTS]
        wanted = [Path(SYSTEM), *system, *map(Path, SYSTEM_FILES), *readable]
        paths = {path.resolve() for one in wanted for path in _without(one, hidden)}
        with TemporaryDirectory(prefix="ravenbrick-grade-") as above:
            folder = Path(above) / "submission"
            folder.mkdir()
            if os.geteuid() == 0:
                Path(above).chmod(0o711)
                folder.chmod(0o777)
            words = [sys.executable, "-I", "-S", str(CONFINEMENT)]
            words += [str(filter_file(sets_instants=False)), str(folder)]
            words += [str(path) for path in sorted(paths) if path.exists()]
            words += ["--list", *sorted({str(path.parent) for path in paths if _is_package(path)})]
            yield (
                [*words, "--", *_on_top(bounds).command(), *other_user(_reading()), *command],
                folder,
            )

    def overflows(self, session: int, folder: Path, bounds: Bounds) -> bool:
        """Counts also the files that were deleted and are still open."""
        used = _blocks_below(folder)
        used += sum(_deleted_blocks(process) for process in _processes(session))
        return used * BLOCK > bounds.scratch_mb * MEGABYTE


def _on_top(bounds: Bounds) -> Bounds:
    """For an ordinary user, all of whose processes count, the limit is on top of these."""
    if os.geteuid() == 0 or bounds.processes is None:
        return bounds
    return replace(bounds, processes=bounds.processes + sum(1 for _ in _processes(None)))


def _reading() -> str:
    """The right to pass folders of others, which the other user needs on the way to its paths.

    What it may read and write is decided by the rules all the same. Containers have one of both.
    """
    for name, number in (("dac_read_search", 2), ("dac_override", 1)):
        if LIBC.prctl(READ_BOUNDING_SET, number, 0, 0, 0) == 1:
            return name
    return ""


def _is_package(path: Path) -> bool:
    """Python finds a package by listing the folder in which it lies."""
    return (path / "__init__.py").is_file()


def _without(path: Path, hidden: Sequence[Path]) -> Iterator[Path]:
    """The path, or where something hidden lies in it the parts of it that are not hidden."""
    if path in hidden:
        return
    if not any(other.is_relative_to(path) for other in hidden):
        yield path
        return
    for part in path.iterdir():
        yield from _without(part, hidden)


def _blocks_below(folder: Path) -> int:
    """Of all files; what vanishes meanwhile counts no more."""
    blocks = 0
    with suppress(OSError):
        for entry in os.scandir(folder):
            with suppress(OSError):
                blocks += entry.stat(follow_symlinks=False).st_blocks
                if entry.is_dir(follow_symlinks=False):
                    blocks += _blocks_below(Path(entry))
    return blocks


def _processes(session: int | None) -> Iterator[Path]:
    """Folders below /proc of a session's processes, or of all of this user."""
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if session is None:
                chosen = process.stat().st_uid == os.geteuid()
            else:
                fields = (process / "stat").read_text().rpartition(")")[2].split()
                chosen = int(fields[3]) == session
            if chosen:
                yield process


def _deleted_blocks(process: Path) -> int:
    blocks = 0
    with suppress(OSError):
        for entry in os.scandir(process / "fd"):
            with suppress(OSError):
                found = os.stat(entry)
                blocks += 0 if found.st_nlink else found.st_blocks
    return blocks
