# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Names of the interrupt sources of the chip."""

from __future__ import annotations

from ravenbrick.catalogue import interrupt_sources

__all__ = ["SOURCES", "source_name"]

SOURCES = interrupt_sources()


def source_name(source: int) -> str:
    """The peripheral's name in the manual, or the number of a source that has none."""
    return SOURCES.get(source, f"source {source}")
