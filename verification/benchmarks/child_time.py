# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Processor time of a command."""

from __future__ import annotations

import resource
import subprocess
from collections.abc import Sequence

__all__ = ["run_timed"]


def _spent() -> float:
    """Processor time in seconds, user and system, of all child processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_timed(command: Sequence[str], most_s: float) -> tuple[float, int]:
    """Processor time of the command in seconds, and its exit code.

    Raises `subprocess.TimeoutExpired` when it runs for longer than `most_s` by the clock.
    """
    before = _spent()
    done = subprocess.run(command, capture_output=True, timeout=most_s)
    return _spent() - before, done.returncode
