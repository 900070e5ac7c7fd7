# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of ports, signs and places in the texts of a model."""

from __future__ import annotations

import re

__all__ = ["count_of", "counts_in"]

# No model has 10,000 ports; a number of 5,000 digits is none that Python reads.
_COUNT = re.compile(r"(?<![0-9])[0-9]{1,4}(?![0-9])")


def count_of(text: str) -> int | None:
    """The number that a text is; none for other texts and larger numbers."""
    return int(text) if _COUNT.fullmatch(text) else None


def counts_in(text: str) -> list[int]:
    """The numbers in a text such as `[2, 1]`."""
    return [int(found) for found in _COUNT.findall(text)]
