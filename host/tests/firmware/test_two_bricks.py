# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Two bricks joined by Bluetooth."""

from __future__ import annotations

from typing import Any

import pytest
from verification.support.bricks.nxt_firmware import firmware_brick

from ravenbrick.brick.links.peers import BluetoothLink
from ravenbrick.errors import PeerError

SECOND_CYCLES = 48_054_858


def two_bricks() -> list[Any]:
    names = (("00:16:53:00:00:01", "one"), ("00:16:53:00:00:02", "two"))
    return [firmware_brick(bluetooth={"address": a, "name": n}) for a, n in names]


def test_the_same_run_of_two_bricks_comes_again() -> None:
    def meet() -> tuple[str, str]:
        bricks = two_bricks()
        BluetoothLink(*bricks).run_until(SECOND_CYCLES)
        return bricks[0].trace_digest(), bricks[1].trace_digest()

    assert meet() == meet()


def test_two_bricks_need_two_addresses() -> None:
    brick = two_bricks()[0]
    with pytest.raises(PeerError, match="both bricks have the Bluetooth address"):
        BluetoothLink(brick, brick)
