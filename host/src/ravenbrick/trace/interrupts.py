# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Names of the interrupt sources (AT91SAM7S256 datasheet, table of peripheral identifiers)."""

from __future__ import annotations

__all__ = ["SOURCES", "source_name"]

SOURCES = {
    0: "FIQ",
    1: "system",
    2: "PIOA",
    4: "ADC",
    5: "SPI",
    6: "USART 0",
    7: "USART 1",
    8: "SSC",
    9: "TWI",
    10: "PWMC",
    11: "UDP",
    12: "TC0",
    13: "TC1",
    14: "TC2",
    30: "IRQ0",
    31: "IRQ1",
}


def source_name(source: int) -> str:
    """The peripheral's name in the manual, or the number of a source that has none."""
    return SOURCES.get(source, f"source {source}")
