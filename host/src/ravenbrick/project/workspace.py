# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Where things lie: the tree, a project folder, its build products and its results."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ravenbrick.errors import UsageError
from ravenbrick.project.named_files import named_file

__all__ = ["BuildKind", "Workspace", "run_time_folder", "tree"]

# What is built: an image for RAM or flash, or the one for GDB.
BuildKind = Literal["ram", "flash", "debug"]

MARKER = Path("tools") / "ravenbrick.cgpr"
# Of this package: in a checkout the tree is around it, an installed package holds its own copy.
PACKAGE = Path(__file__).resolve().parents[1]
CHECKOUT = Path("host") / "src" / "ravenbrick"


def tree() -> Path:
    """The folder with tools/, runtime/, drivers/ and examples/; raises `UsageError`."""
    named = os.environ.get("RAVENBRICK_HOME")
    places = [Path(named).resolve()] if named else [PACKAGE.parents[2], PACKAGE / "tree"]
    for root in places:
        if (root / MARKER).is_file():
            return root
    raise UsageError(
        f"'{places[0]}' is not a Ravenbrick tree (no {MARKER} in it); set RAVENBRICK_HOME to one"
    )


def run_time_folder(digest: Callable[[], str]) -> Path:
    """Folder of the run-time libraries: build/runtime of a checkout, otherwise of the user's cache.

    `digest` tells one state of the run-time's sources from others in the cache. Raises `UsageError`
    where the compiler cannot take the folder's name.
    """
    root = tree()
    own = root / "build" / "runtime"
    if (root / CHECKOUT).is_dir() and os.access(root, os.W_OK) and ":" not in str(own):
        return own
    named = os.environ.get("XDG_CACHE_HOME", "")
    cache = Path(named) if os.path.isabs(named) else Path.home() / ".cache"
    if ":" in str(cache):
        raise UsageError(
            f"'{cache}': the compiler does not accept ':' in the run-time library's path; "
            "name another folder with XDG_CACHE_HOME"
        )
    return cache / "ravenbrick" / "runtime" / digest()


@dataclass(frozen=True)
class Workspace:
    """A project folder; `root` holds build/ and out/: the tree around it, or the folder itself."""

    project: Path
    root: Path

    @classmethod
    def of(cls, directory: Path) -> Workspace:
        """The workspace of a project folder; raises `UsageError`."""
        if not directory.is_dir():
            raise UsageError(f"'{directory}' is not a folder; name a project folder")
        project = directory.resolve()
        for candidate in (project, *project.parents):
            if (candidate / MARKER).is_file():
                return cls(project, candidate)
        tree()
        return cls(project, project)

    @property
    def results(self) -> Path:
        """Folder of reports, plots and recordings."""
        return self.root / "out" / self.project.name

    @property
    def products(self) -> Path:
        """Folder of what is built; RAVENBRICK_BUILD names another one."""
        return Path(os.environ.get("RAVENBRICK_BUILD") or self.root / "build").resolve()

    @property
    def design_file(self) -> Path:
        """What design.py leaves for the plots."""
        return self.products / self.project.name / "design.json"

    @property
    def design_record(self) -> Path:
        """Contents of the last design's inputs and of the controller that it made."""
        return self.design_file.with_name("designed.json")

    def build(self, kind: BuildKind) -> Path:
        """Folder of the build products of one kind of image."""
        return self.products / self.project.name / kind

    def image(self, kind: BuildKind, name: str) -> Path:
        """File of the image."""
        return self.build(kind) / f"{name}.elf"

    def recording(self, scenario: str, kind: BuildKind = "ram") -> Path:
        """File of the last recording of a scenario with one kind of image."""
        name = scenario if kind == "ram" else f"{scenario}.{kind}"
        return self.results / "recordings" / f"{name}.npz"

    def named_recording(self, name: str | Path) -> Path:
        """File of the recording that a word names, by the rule of `named_file`."""
        kept = self.results / "recordings"
        return named_file(name, self.project, kept, ".npz") or Path(name)
