# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The built pages, each in one file, for those who cannot build them: `page.zip`, `studio.zip`.

Both lie in the host's package. A file `.json` beside each lists what the page was built from and
with, and its files, with digests. `tools/page` calls this: `pack` writes both, `compare` prints how
build/page and build/studio differ from them.
"""

from __future__ import annotations

import io
import json
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.sources import source_digests

ROOT = Path(__file__).resolve().parent.parent
SHIPPED = ROOT / "host" / "src" / "ravenbrick"
CRATES = ("arm7tdmi", "at91sam7s", "image", "measures", "nxt", "plant", "trace", "virtual-brick")
COMMON = ("tools/page", "web/package*.json", "web/tsconfig.json")
BRICK_SOURCES = (
    *COMMON,
    "catalogue/*.json",
    "web/*.html",
    "web/vite.config.ts",
    "web/src/**/*",
    "web/public/**/*",
    "virtual-brick/Cargo.*",
    "virtual-brick/bindings/wasm*/Cargo.toml",
    "virtual-brick/bindings/wasm*/src/**/*",
    *(f"virtual-brick/crates/{crate}/Cargo.toml" for crate in CRATES),
    *(f"virtual-brick/crates/{crate}/src/**/*" for crate in CRATES),
)
STUDIO_SOURCES = (
    *COMMON, "web/vite.studio.config.ts", "web/studio/**/*", "web/src/dom.ts",
    "web/src/style/base.css",
)  # fmt: skip
# What all files of an archive have, so that equal pages are equal archives.
DATE = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class Package:
    """A page: its folder in build/, patterns of its sources, its archive and the list beside it."""

    built: Path
    sources: tuple[str, ...]
    packed: Path
    root: Path = ROOT

    @property
    def listed(self) -> Path:
        """What the archive was made from and with, and its files."""
        return self.packed.with_suffix(".json")

    def manifest(self, tools: list[str]) -> dict[str, Any]:
        """Everything that the built page was made from and with, and its files."""
        return {
            "sources": source_digests(self.root, self.sources),
            "tools": tools,
            "files": source_digests(self.built, ["**/*"]),
        }

    def stale(self) -> list[str]:
        """Sources that changed since the page was packed."""
        packed = json.loads(self.listed.read_text())["sources"]
        return changes(packed, source_digests(self.root, self.sources))

    def pack(self, tools: list[str]) -> None:
        """Write archive and list."""
        content = io.BytesIO()
        described = self.manifest(tools)
        with zipfile.ZipFile(content, "w") as archive:
            for name in described["files"]:
                entry = zipfile.ZipInfo(name, DATE)
                archive.writestr(entry, (self.built / name).read_bytes(), zipfile.ZIP_DEFLATED, 9)
        atomic_write(self.packed, content.getvalue())
        atomic_write(self.listed, json.dumps(described, indent=1) + "\n")
        print(f"{self.packed.relative_to(self.root)}: {len(content.getvalue())} bytes")

    def different(self) -> list[str]:
        """Files of the built page that are not those of the packed page."""
        packed = json.loads(self.listed.read_text())["files"]
        return changes(packed, source_digests(self.built, ["**/*"]))


PACKAGES = (
    Package(ROOT / "build" / "page", BRICK_SOURCES, SHIPPED / "page.zip"),
    Package(ROOT / "build" / "studio", STUDIO_SOURCES, SHIPPED / "studio.zip"),
)


def changes(old: dict[str, str], new: dict[str, str]) -> list[str]:
    """Names whose digests differ, or that only one of both has."""
    return sorted(name for name in {*old, *new} if old.get(name) != new.get(name))


def main() -> int:
    """Do what the first word asks for; 1 when there is a difference."""
    if sys.argv[1] == "pack":
        for package in PACKAGES:
            package.pack(sys.argv[2:])
        return 0
    found = [(package, name) for package in PACKAGES for name in package.different()]
    for package, name in found:
        print(f"{name}: not as in {package.packed.name}; run 'make page'", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
