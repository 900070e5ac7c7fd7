# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The site without a network: `python -m tools.docs.site.offline docs/_build/html`.

Writes the service worker into the root of the whole site, and the list of what it keeps.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.view import page_files
from ravenbrick.packed_files import SCRIPT

__all__ = ["WORKER", "kept_files"]

WORKER, KEPT = "offline.js", "offline.json"
# Copies for the disk, sources of the pages, and what Sphinx writes for itself.
LEFT_OUT = (SCRIPT, WORKER, KEPT, ".buildinfo", "objects.inv")
LEFT_OUT_FOLDERS = ("_sources", ".doctrees", "decisions", "internals")


def kept_files(site: Path) -> dict[str, str]:
    """What a browser keeps after the first load, with digests: pages, pictures, bricks."""
    found = {}
    for file in sorted(path for path in site.rglob("*") if path.is_file()):
        name = file.relative_to(site)
        if file.name not in LEFT_OUT and name.parts[0] not in LEFT_OUT_FOLDERS:
            found[name.as_posix()] = hashlib.sha256(file.read_bytes()).hexdigest()[:16]
    return found


def main(folder: str) -> int:
    """Write both; the worker is that of the page of `ravenbrick view`."""
    site = Path(folder)
    atomic_write(site / KEPT, json.dumps(kept_files(site), indent=1) + "\n")
    atomic_write(site / WORKER, page_files()[WORKER])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
