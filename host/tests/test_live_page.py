# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A page that is served ends with Ctrl-C, whatever is executed at that moment."""

from __future__ import annotations

import signal
import weakref

import pytest

from ravenbrick.live_page import page_figure, serve_figure


class Dropped:
    """Something that others refer to weakly."""


def test_an_interrupt_while_an_object_is_dropped_ends_the_page() -> None:
    """Python prints what is raised in the callback of a weak reference, and goes on."""
    steps: list[object] = []

    def step() -> None:
        steps.append(Dropped())
        reference = weakref.ref(steps[-1], lambda _: signal.raise_signal(signal.SIGINT))
        steps[-1] = reference

    with pytest.raises(KeyboardInterrupt):
        serve_figure(page_figure("page", (2, 2)), 0, print, lambda: len(steps) == 5, step, 10)
    assert len(steps) < 5
