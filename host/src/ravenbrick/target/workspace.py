# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Where things lie: the project folder, its build products and its results."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from ravenbrick.errors import UsageError
from ravenbrick.target.elf_image import ImageKind

__all__ = ["Workspace", "tree"]

MARKER = Path("tools") / "ravenbrick.cgpr"


def tree() -> Path:
    """The Ravenbrick tree that this package belongs to; raises `UsageError`."""
    named = os.environ.get("RAVENBRICK_HOME")
    root = Path(named).resolve() if named else Path(__file__).resolve().parents[4]
    if (root / MARKER).is_file():
        return root
    raise UsageError(
        f"'{root}' is not a Ravenbrick tree (no {MARKER} in it); set RAVENBRICK_HOME to one"
    )


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
    def design_file(self) -> Path:
        """What design.py leaves for the plots."""
        return self.root / "build" / self.project.name / "design.json"

    def build(self, kind: ImageKind) -> Path:
        """Folder of the build products of one kind of image."""
        return self.root / "build" / self.project.name / kind

    def image(self, kind: ImageKind, name: str) -> Path:
        """File of the image."""
        return self.build(kind) / f"{name}.elf"

    def recording(self, scenario: str, kind: ImageKind = "ram") -> Path:
        """File of the last recording of a scenario with one kind of image."""
        name = scenario if kind == "ram" else f"{scenario}.{kind}"
        return self.results / "recordings" / f"{name}.npz"
