# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The one rule by which a word on the command line names a file."""

from __future__ import annotations

from pathlib import Path

__all__ = ["is_file", "named_file"]


def is_file(path: Path) -> bool:
    """Whether there is such a file; none has a name longer than the file system allows."""
    try:
        return path.is_file()
    except OSError:
        return False


def named_file(name: str | Path, project: Path, kept: Path, suffix: str) -> Path | None:
    """The file from where the user stands, else in the project, else in the folder for such files.

    There, in `kept`, the name may lack its suffix. None when no file has this name.
    """
    for path in (Path(name), project / name, kept / name, kept / f"{name}{suffix}"):
        if is_file(path):
            return path
    return None
