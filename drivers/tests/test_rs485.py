# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.RS485 on the virtual brick: looped back within the processor, and with others on the line."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from ravenbrick.brick.links.peers import Rs485Line

from verification.support.bricks.observe import Brick

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


def test_two_bricks_talk_on_one_line(brick: Callable[..., Brick]) -> None:
    """30 messages of 1 to 30 bytes go there and come back, none lost and none wrong."""
    asks, answers = brick("rs485_line"), brick("rs485_line")
    asks.set(0, "touch.1", 1)
    stops = Rs485Line(asks.device, answers.device).run_until(asks.cycles(220))
    assert [stop.reason for stop in stops] == ["reached", "reached"]
    assert (asks.integer("asked"), asks.integer("right")) == (30, 30)
    assert (answers.integer("answered"), answers.integer("heard")) == (30, 30 * 31 // 2)
    assert answers.integer("lost") == 0


def script(device: Brick, at_ms: float, data: bytes, bit_cycles: int = 52) -> None:
    """Bytes of another device on the line."""
    device.device.rs485_send(device.cycles(at_ms), data, bit_cycles)


def test_a_peer_is_heard_and_answered(brick: Callable[..., Brick]) -> None:
    """The answer begins within the period of the task, at the line's rate."""
    device = brick("rs485_line")
    script(device, 150.1, b"\x04abc")
    device.run(160)
    sent = device.device.rs485_sent()
    assert bytes(byte for _, byte in sent) == bytes(0xFF - byte for byte in b"\x04abc")
    assert [b - a for (a, _), (b, _) in itertools.pairwise(sent)] == [520] * 3
    assert sent[0][0] < device.cycles(151.2)


def test_a_wrong_rate_is_told(brick: Callable[..., Brick]) -> None:
    """Stop bits are missed when the bytes come 10 % too slow."""
    device = brick("rs485_line")
    script(device, 150.1, b"\x02x")
    device.run(155)
    assert device.integer("lost") == 0
    script(device, 155.1, b"\x02x", bit_cycles=58)
    device.run(160)
    assert device.integer("lost") == 1


def test_while_it_speaks_it_hears_nothing(brick: Callable[..., Brick]) -> None:
    """What comes into its own answer is lost; after it, bytes are heard again."""
    device = brick("rs485_line")
    script(device, 150.1, bytes([30, *range(29)]))
    device.run(150.7)
    script(device, 150.8, b"\x02y")
    device.run(160)
    assert len(device.device.rs485_sent()) == 30
    assert device.integer("heard") == 30
    script(device, 160.1, b"\x02z")
    device.run(170)
    assert device.integer("heard") == 32
