# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.AVR_IO: the bytes, checked against the protocol's description and not against the code."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick

STAY_ON, SWITCH_OFF = 0x00, 0x5A
PWM_KHZ = 8
VALID, NOT_SAMPLED, CORRUPT = range(3)


def with_sum(*values: int) -> bytes:
    """A frame with the byte that makes the sum of all bytes 0xFF."""
    data = [value % 256 for value in values]
    return bytes([*data, 0xFF - sum(data) % 256])


@pytest.fixture
def device(brick: Callable[..., Brick]) -> Brick:
    """A brick that has coded and decoded all samples."""
    device = brick("messages")
    device.run(50)
    return device


def test_output_frames_follow_the_protocol(device: Brick) -> None:
    """Duty cycles, brake bits, sensor supplies, power command and sum are where they belong."""
    assert device.bytes("idle_frame") == with_sum(STAY_ON, PWM_KHZ, 0, 0, 0, 0, 0b111, 0)
    supplies = 1 << 1 | 1 << (4 + 3)
    assert device.bytes("busy_frame") == with_sum(
        STAY_ON, PWM_KHZ, 100, -1, -100, 0, 0b101, supplies
    )
    assert device.bytes("off_frame") == with_sum(SWITCH_OFF, PWM_KHZ, 0, 0, 0, 0, 0b111, 0)


def test_the_greeting_is_the_one_expected(device: Brick) -> None:
    """One marker byte and the text that the co-processor compares."""
    text = b"Let's samba nxt arm in arm, (c)LEGO System A/S"
    assert device.bytes("greeting") == b"\xcc" + text


def test_input_frames_are_decoded_or_refused(device: Brick) -> None:
    """A right frame gives its values; a wrong sum and a frame before sampling are refused."""
    assert device.integers("verdicts") == [VALID, CORRUPT, NOT_SAMPLED, VALID]
    assert device.integers("sensor_1") == [180, 1023, 1023, 1023]
    assert device.integers("button") == [4, 0, 0, 1]
    assert device.integers("battery_count") == [528, 0, 0, 1023]
    assert device.integers("pack") == [1, 0, 0, 0]
