# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of a processor, which other work on the machine does not lengthen."""

from __future__ import annotations

import resource

__all__ = ["processor_s"]


def processor_s() -> float:
    """User and system time of this process and of its children that have ended."""
    usages = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
