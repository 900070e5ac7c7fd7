# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.RS485, looped back within the processor, on the virtual brick."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from drivers.tests.observe import Brick

BITS_PER_BYTE, RATE = 10, 48_054_857 / 52


def test_what_is_sent_is_received_in_order(brick: Callable[..., Brick]) -> None:
    """61 messages of 2 to 120 bytes come back complete, and at the line's rate."""
    device = brick("rs485")
    device.run(400)
    assert device.integer("different") == 0
    assert device.integer("received") == 60 * 61 + 100
    assert device.integer("sent") == 60 * 61 + 100 + 4 * 128
    assert device.integer("span_us") == pytest.approx(100 * BITS_PER_BYTE / RATE * 1e6, abs=100)


def test_a_second_message_is_refused_while_one_is_sent(brick: Callable[..., Brick]) -> None:
    """Each attempt beside a message that goes out is refused, and so is one after the end."""
    device = brick("rs485")
    device.run(400)
    assert device.integer("refused") == 66


def test_bytes_that_nobody_takes_are_lost_and_told(brick: Callable[..., Brick]) -> None:
    """512 bytes without a reader overrun the buffer; before, nothing was lost."""
    device = brick("rs485")
    device.run(400)
    assert (device.integer("lost_early"), device.integer("lost_late")) == (0, 1)
