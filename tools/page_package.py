# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The built page in one file, for those who cannot build it: `page.zip` of the host's package.

`page.json` beside it lists what the page was built from and with, and its files, with digests.
`tools/page` calls this: `pack` writes both, `compare` prints how build/page differs from them.
"""

from __future__ import annotations

import io
import json
import sys
import zipfile
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.sources import source_digests

ROOT = Path(__file__).resolve().parent.parent
BUILT = ROOT / "build" / "page"
PACKED = ROOT / "host" / "src" / "ravenbrick" / "page.zip"
MANIFEST = PACKED.with_suffix(".json")
CRATES = ("arm7tdmi", "at91sam7s", "image", "measures", "nxt", "plant", "trace", "virtual-brick")
SOURCES = (
    "tools/page",
    "catalogue/*.json",
    "web/*.html",
    "web/package*.json",
    "web/tsconfig.json",
    "web/vite.config.ts",
    "web/src/**/*",
    "web/public/**/*",
    "virtual-brick/Cargo.*",
    "virtual-brick/bindings/wasm*/Cargo.toml",
    "virtual-brick/bindings/wasm*/src/**/*",
    *(f"virtual-brick/crates/{crate}/Cargo.toml" for crate in CRATES),
    *(f"virtual-brick/crates/{crate}/src/**/*" for crate in CRATES),
)
# What all files of the archive have, so that equal pages are equal archives.
DATE = (1980, 1, 1, 0, 0, 0)


def manifest(tools: list[str]) -> dict[str, Any]:
    """Everything that the page in build/page was made from and with, and its files."""
    return {
        "sources": source_digests(ROOT, SOURCES),
        "tools": tools,
        "files": source_digests(BUILT, ["**/*"]),
    }


def changes(old: dict[str, str], new: dict[str, str]) -> list[str]:
    """Names whose digests differ, or that only one of both has."""
    return sorted(name for name in {*old, *new} if old.get(name) != new.get(name))


def stale() -> list[str]:
    """Sources that changed since the page was packed."""
    return changes(json.loads(MANIFEST.read_text())["sources"], source_digests(ROOT, SOURCES))


def pack(tools: list[str]) -> None:
    """Write archive and manifest."""
    content = io.BytesIO()
    described = manifest(tools)
    with zipfile.ZipFile(content, "w") as archive:
        for name in described["files"]:
            entry = zipfile.ZipInfo(name, DATE)
            archive.writestr(entry, (BUILT / name).read_bytes(), zipfile.ZIP_DEFLATED, 9)
    atomic_write(PACKED, content.getvalue())
    atomic_write(MANIFEST, json.dumps(described, indent=1) + "\n")
    print(f"{PACKED.relative_to(ROOT)}: {len(content.getvalue())} bytes")


def different() -> list[str]:
    """Files of build/page that are not those of the packed page."""
    return changes(json.loads(MANIFEST.read_text())["files"], source_digests(BUILT, ["**/*"]))


def main() -> int:
    """Do what the first word asks for; 1 when there is a difference."""
    if sys.argv[1] == "pack":
        pack(sys.argv[2:])
        return 0
    for name in different():
        print(f"{name}: not as in {PACKED.name}; run 'make page'", file=sys.stderr)
    return 1 if different() else 0


if __name__ == "__main__":
    sys.exit(main())
