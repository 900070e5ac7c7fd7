# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The images of `images.toml`, which a person supplies, and the checks of their functions.

The environment variable `RAVENBRICK_FIRMWARE` names a folder whose files are called by their
SHA-256 digest. `python -m verification.firmware.witnesses.library FOLDER` copies what it finds in a
folder of any names, and says what is still absent and where it was published.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import sys
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ravenbrick.brick.firmware import FirmwareBrick

from verification.firmware.images import FLASH, USER_RAM

__all__ = [
    "CHECKS", "FUNCTIONS", "Check", "Image", "ImageAbsentError", "check", "images",
    "switched_on", "timing",
]  # fmt: skip

TABLE = Path(__file__).with_name("images.toml")
VARIABLE = "RAVENBRICK_FIRMWARE"
FUNCTIONS = (
    "starts", "LCD", "buttons", "motor", "sensor", "sound", "files", "USB", "Bluetooth",
    "link", "switches off", "scores",
)  # fmt: skip
PLACES = {"flash": FLASH, "ram": USER_RAM, "file": 0}


class ImageAbsentError(Exception):
    """No file with the digest; the text says what to get and from where."""


@dataclass(frozen=True)
class Image:
    """An image or a program for one: where it was published, and where it is loaded."""

    name: str
    sha256: str
    published: str
    at: str = "file"
    installed: str = ""

    @property
    def content(self) -> bytes:
        """The bytes. Raises ImageAbsentError."""
        folder = os.environ.get(VARIABLE)
        places = [Path(self.installed)] if self.installed else []
        places += [Path(folder) / self.sha256] if folder else []
        for path in places:
            if path.is_file():
                data = path.read_bytes()
                if hashlib.sha256(data).hexdigest() == self.sha256:
                    return data
        raise ImageAbsentError(
            f"{self.name} is absent: {self.published}; name the file {self.sha256[:12]}… (its"
            f" SHA-256) and let {VARIABLE} name its folder"
        )

    def brick(self, **changes: Any) -> FirmwareBrick:
        """A brick with the image. Raises ImageAbsentError."""
        return switched_on(self.content, PLACES[self.at], **changes)


_TIMING: ContextVar[dict[str, Any] | None] = ContextVar("timing", default=None)


@contextmanager
def timing(settings: dict[str, Any]) -> Iterator[None]:
    """Let the bricks have these timing parameters meanwhile (docs/reference/timing.md)."""
    token = _TIMING.set(settings)
    try:
        yield
    finally:
        _TIMING.reset(token)


def switched_on(content: bytes, address: int, **changes: Any) -> FirmwareBrick:
    """A brick with these bytes and the timing that holds now."""
    settings = _TIMING.get()
    return FirmwareBrick(content, address, **({"timing": settings} if settings else {}), **changes)


@cache
def images() -> dict[str, Image]:
    """The entries of the table by name."""
    entries = tomllib.loads(TABLE.read_text(encoding="utf-8"))["image"]
    return {entry["name"]: Image(**entry) for entry in entries}


@dataclass(frozen=True)
class Check:
    """A function of a witness: `run` returns what was seen, or raises AssertionError."""

    witness: str
    function: str
    run: Callable[[], str]


CHECKS: list[Check] = []


def check(witness: str, function: str) -> Callable[[Callable[[], str]], Callable[[], str]]:
    """Register a check."""
    assert function in FUNCTIONS, function

    def register(run: Callable[[], str]) -> Callable[[], str]:
        CHECKS.append(Check(witness, function, run))
        return run

    return register


def main(arguments: list[str]) -> int:
    """Copy known files of a folder to that of the variable; 2 when there is no such folder."""
    target = os.environ.get(VARIABLE)
    if len(arguments) != 1 or not Path(arguments[0]).is_dir() or not target:
        print(f"expected a folder to search, and {VARIABLE} set to one to fill", file=sys.stderr)
        return 2
    Path(target).mkdir(parents=True, exist_ok=True)
    known = {image.sha256: image for image in images().values()}
    for path in sorted(p for p in Path(arguments[0]).rglob("*") if p.is_file()):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest in known and not (Path(target) / digest).exists():
            shutil.copyfile(path, Path(target) / digest)
            print(f"{known[digest].name}: {path}")
    for image in images().values():
        try:
            _ = image.content
        except ImageAbsentError as error:
            print(error)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
