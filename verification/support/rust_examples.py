# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs among the examples of the crates, built once in a process."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path

from verification.support.paths import ROOT

__all__ = ["rust_example"]


@cache
def rust_example(name: str, *options: str) -> Path:
    """The program of an example; `options` of Cargo choose packages and features.

    Raises:
        subprocess.CalledProcessError: It could not be built.
    """
    crates = ROOT / "virtual-brick"
    command = ["cargo", "build", "--locked", "--quiet", "--release", "--example", name, *options]
    subprocess.run(command, cwd=crates, check=True)
    return crates / "target" / "release" / "examples" / name
