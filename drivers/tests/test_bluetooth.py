# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Bluetooth as server and client: two bricks find each other, connect, and talk."""

from __future__ import annotations

from collections.abc import Callable

from ravenbrick.target.peers import BluetoothLink

from drivers.tests.observe import Brick

OTHER = "00:16:53:0A:0B:0C"
NAME_FIRST, NAME_LENGTH = 7, 16


def test_two_bricks_find_connect_and_talk(brick: Callable[..., Brick]) -> None:
    """Inquiry, a wrong code, the right one, messages both ways, parting, and again without code."""
    server = brick("bluetooth_server", bluetooth={"address": OTHER})
    client = brick("bluetooth_client")
    link = BluetoothLink(server.device, client.device)
    for second in range(1, 41):
        link.run_until(client.cycles(1000 * second))
        if client.integer("peers_listed") >= 0:
            break
    assert client.integer("devices_found") == 1
    name = client.bytes("found")[NAME_FIRST : NAME_FIRST + NAME_LENGTH]
    assert name.rstrip(b"\0") == b"doubling brick "
    assert client.integer("wrong_code") == 0
    assert client.integers("answers") == [200, 400, 600, 800]
    assert client.integer("peers_listed") == 1
    assert server.integer("connections") == 2
    assert link.lost == []
