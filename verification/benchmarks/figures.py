# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One measured figure, and the commands that several parts of the benchmarks need."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass, field
from typing import Any

from verification.commands import NoResultError
from verification.support.paths import ROOT

__all__ = ["REPEATS", "VEHICLE", "Figure", "ravenbrick"]

VEHICLE = ROOT / "examples" / "vehicle"
REPEATS = 5


@dataclass(frozen=True)
class Figure:
    """A value beside that of a peer; the ratio is ours divided by the peer's."""

    figure: str
    value: float
    unit: str
    peer: str | None = None
    peer_value: float | None = None
    ratio: float | None = field(init=False)

    def __post_init__(self) -> None:
        ratio = None if self.peer_value is None else self.value / self.peer_value
        object.__setattr__(self, "ratio", ratio)


def ravenbrick(*arguments: str) -> dict[str, Any]:
    """The JSON answer of a command."""
    command = [str(ROOT / ".venv" / "bin" / "ravenbrick"), *arguments, "--json"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if result.returncode != 0:
        raise NoResultError(f"{' '.join(command)}: {result.stdout}{result.stderr}")
    answer: dict[str, Any] = json.loads(result.stdout)
    return answer
