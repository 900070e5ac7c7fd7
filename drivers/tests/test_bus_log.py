# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The two-wire bus of sensor ports against a scripted peripheral: scenario in, exact log out.

S and P are start and stop, each byte is followed by a or n, acknowledged or not. A tick is half a
bit.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick

LOGS = {
    "write": "S 02a 41a 02a P done ticks 058",
    "read": "S 02a 42a S 03a 5Aa 5Bn P done 5A 5B ticks 097",
    "LEGO read": "S 02a 42a P S 03a 5Aa 5Bn done 5A 5B ticks 108",
    "nobody": "S 02n P failed ticks 022",
    "NACK of a register": "S 02a 42n P failed ticks 040",
    "NACK of the read": "S 02a 42a S 03n P failed ticks 061",
    "unplugged in the data": "S 02a 42a S 03a FFn P done FF ticks 079",
    "stretched": "S 02a 41a P done ticks 059",
    "stuck": "S 02a failed ticks 128",
}


@pytest.mark.parametrize("scenario", LOGS)
def test_the_bus_carries_exactly_this(brick: Callable[..., Brick], scenario: str) -> None:
    """Conditions, bytes, acknowledges, the result and how long it took."""
    device = brick("bus_log", sensors={})
    device.run(400)
    log = device.bytes("bus_log").rstrip(b"\0").decode()
    lines = dict(line.split(": ", 1) for line in log.splitlines())
    assert list(lines) == list(LOGS)
    assert lines[scenario] == LOGS[scenario]
