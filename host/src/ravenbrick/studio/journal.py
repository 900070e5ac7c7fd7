# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What happened, in order, for every page that listens."""

from __future__ import annotations

import threading
from collections import deque
from itertools import count
from typing import Any

__all__ = ["Journal"]

KEPT = 400


class Journal:
    """Events with numbers from 1; the last ones are kept for a page that comes later."""

    def __init__(self) -> None:
        self._events: deque[tuple[int, dict[str, Any]]] = deque(maxlen=KEPT)
        self._numbers = count(1)
        self._changed = threading.Condition()

    def add(self, kind: str, **data: Any) -> None:
        """Tell all who listen."""
        with self._changed:
            self._events.append((next(self._numbers), {"kind": kind, **data}))
            self._changed.notify_all()

    def after(self, number: int, timeout_s: float) -> list[tuple[int, dict[str, Any]]]:
        """The events behind one; waits for the first, and returns none when the time is over."""
        with self._changed:
            self._changed.wait_for(lambda: self._events and self._events[-1][0] > number, timeout_s)
            return [event for event in self._events if event[0] > number]
