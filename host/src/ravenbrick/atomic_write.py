# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that are written whole or not at all."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

__all__ = ["atomic_write"]


def atomic_write(path: Path, content: bytes | str, mode: int | None = None) -> None:
    """Write a file, text as UTF-8, into a folder that is made where it is missing.

    What was there before stays until the new content is on the disk. With a `mode`, only the
    owner can read the file before it has that mode; without, it is that of a new file. Raises
    `OSError`, which names the file.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    target = path.resolve()
    unfinished = target.with_name(f"{target.name}.{os.getpid()}.part")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not target.is_file():
            target.write_bytes(data)
            return
        if mode is not None:
            unfinished.touch(0o600)
        unfinished.write_bytes(data)
        if mode is not None:
            unfinished.chmod(mode)
        unfinished.replace(target)
    except OSError as error:
        with suppress(OSError):
            unfinished.unlink()
        raise type(error)(error.errno, error.strerror, str(path)) from None
