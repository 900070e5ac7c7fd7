# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One command at a time in a folder of build products."""

from __future__ import annotations

import fcntl
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ravenbrick.errors import UsageError, shown_path

__all__ = ["locked"]


@contextmanager
def locked(folder: Path, busy: str) -> Iterator[int]:
    """Hold the lock of a folder, which is made where it is missing; wait where another has it.

    Yields the lock's file descriptor: a program that inherits it keeps the lock when this one is
    killed. `busy` is what the other does, for the user. Raises `UsageError` where the folder
    cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / ".lock").open("a")
    except OSError as error:
        raise UsageError(
            f"{shown_path(folder)}: cannot be written ({error.strerror}); allow writing there, or "
            "name another folder with RAVENBRICK_BUILD"
        ) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"waiting for another ravenbrick command {busy}", file=sys.stderr, flush=True)
            fcntl.flock(file, fcntl.LOCK_EX)
        yield file.fileno()
