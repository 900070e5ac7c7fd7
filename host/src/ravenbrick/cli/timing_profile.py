# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The option `--timing-profile` (docs/reference/timing.md)."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

import typer

__all__ = ["TimingProfile", "TimingProfileOption"]


class TimingProfile(StrEnum):
    """A column of the table of parameters."""

    NOMINAL = "nominal"
    OPTIMISTIC = "optimistic"
    PESSIMISTIC = "pessimistic"

    @property
    def settings(self) -> dict[str, Any]:
        """Of the virtual brick."""
        return {"timing": {"profile": self.value}}


TimingProfileOption = Annotated[
    TimingProfile, typer.Option(help="Corner for timing parameters that no document specifies.")
]
