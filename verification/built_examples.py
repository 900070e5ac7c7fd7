# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Examples as the command designs and builds them."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Container
from typing import Any

from ravenbrick.errors import ExitCode

from verification.commands import NoResultError
from verification.support.paths import ROOT

__all__ = ["build_example", "ravenbrick"]


def ravenbrick(*arguments: str, accepted: Container[int] = (ExitCode.OK,)) -> dict[str, Any]:
    """What the command answers as JSON. Raises `NoResultError` for an exit code not `accepted`."""
    command = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
    done = subprocess.run(
        [*command, *arguments, "--json"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if done.returncode not in accepted:
        said = (done.stdout + done.stderr).strip()[-2000:]
        raise NoResultError(
            f"ravenbrick {' '.join(arguments)}: exit code {done.returncode}: {said}"
        )
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def build_example(name: str) -> None:
    """Design and build what is not up to date. Raises `NoResultError`."""
    folder = f"examples/{name}"
    if (ROOT / folder / "design.py").is_file():
        ravenbrick("design", folder)
    ravenbrick("build", folder)
