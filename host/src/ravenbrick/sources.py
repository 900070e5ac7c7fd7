# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Digests of the sources that something was built from: they tell when it is stale.

The set-up runs this file before anything is installed: it needs the standard library only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

__all__ = ["brick_digest", "source_digests"]

BRICK = (
    "catalogue/sensors.json",
    "host/src/ravenbrick/__init__.py",
    "virtual-brick/Cargo.toml",
    "virtual-brick/Cargo.lock",
    "virtual-brick/crates/*/Cargo.toml",
    "virtual-brick/crates/*/src/**/*",
    "virtual-brick/crates/wcet/annotations/*.toml",
    "virtual-brick/bindings/python/Cargo.toml",
    "virtual-brick/bindings/python/src/**/*.rs",
)


def source_digests(root: Path, patterns: Sequence[str]) -> dict[str, str]:
    """SHA-256 of each file below `root` that a pattern matches, by its path there."""
    files = {path for pattern in patterns for path in root.glob(pattern) if path.is_file()}
    return {
        path.relative_to(root).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(files)
    }


def brick_digest(tree: Path) -> str:
    """Digest of the Rust sources of the module `virtual_brick`, as its `SOURCES` has it."""
    digests = source_digests(tree, BRICK)
    return hashlib.sha256(json.dumps(digests).encode()).hexdigest()
