# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Files for a page that is opened from the disk: there a browser reads nothing but scripts.

The script `files.js` of a folder holds its files by name, each packed with gzip and written in
base64; `web/src/files.ts` reads it.
"""

from __future__ import annotations

import gzip
import json
from base64 import b64encode
from collections.abc import Mapping

__all__ = ["SCRIPT", "script_of", "with_scripts"]

SCRIPT = "files.js"
READ_BY_THE_BROWSER = (".html", ".svg", ".css")


def script_of(files: Mapping[str, bytes]) -> bytes:
    """The script of a folder with these files; the same files give the same script."""
    packed = {
        name: b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")
        for name, content in sorted(files.items())
        if not name.endswith(READ_BY_THE_BROWSER)
    }
    return f"globalThis.packedFiles = {json.dumps(packed)};\n".encode()


def with_scripts(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files and the script of each of their folders. Names have `/` between folders."""
    folders: dict[str, dict[str, bytes]] = {}
    for name, content in files.items():
        folder, slash, own = name.rpartition("/")
        folders.setdefault(folder + slash, {})[own] = content
    return dict(files) | {f"{at}{SCRIPT}": script_of(own) for at, own in folders.items()}
