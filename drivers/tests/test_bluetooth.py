# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Bluetooth as server and client, and what links that end leave behind."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import pytest
from ravenbrick.brick.links.peers import BluetoothComputer, BluetoothLink, UsbComputer
from ravenbrick.errors import PeerError

from verification.support.bricks.observe import Brick

OTHER = "00:16:53:0A:0B:0C"
NAME_FIRST, NAME_LENGTH = 7, 16
DEVICE_LENGTH = NAME_FIRST + NAME_LENGTH + 4
LEGO_BRICK = (0x0694, 0x0002)
BATTERY_LEVEL = b"\x00\x0b"


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
    assert client.bytes("known")[:DEVICE_LENGTH] == client.bytes("found")[:DEVICE_LENGTH]
    assert server.integer("connections") == 2
    assert link.lost == []


def test_a_lone_brick_looks_for_others_as_long_as_it_was_told(brick: Callable[..., Brick]) -> None:
    """For 5 s, in whole units of 1.28 s, from 1 s after the module has started."""
    client = brick("bluetooth_client")
    client.run(5_000)
    assert client.integer("devices_found") == -1
    client.run(7_000)
    assert client.integer("devices_found") == 0


def doubled(computer: BluetoothComputer, number: int) -> int:
    """What the server answers to a number."""
    message = (4).to_bytes(2, "little") + number.to_bytes(4, "little")
    computer.write(message)
    answer = computer.read(6, timeout_ms=500)
    assert answer[:2] == message[:2]
    return int.from_bytes(answer[2:], "little")


@pytest.mark.parametrize("sent", [0, 1, 3, 5])
def test_a_drop_in_mid_message_leaves_nothing(brick: Callable[..., Brick], sent: int) -> None:
    """The connection ends after part of a message; the next one begins with a whole one."""
    server = brick("bluetooth_server")
    server.run(1_000)
    computer = BluetoothComputer(server.device, pin="0815")
    computer.connect()
    assert doubled(computer, 21) == 42
    computer.write(bytes(range(4, 4 + sent)))
    server.device.run_until(server.device.cycles + server.cycles(20))
    computer.close()
    server.device.run_until(server.device.cycles + server.cycles(200))
    assert server.integer("connections") == 1
    again = BluetoothComputer(server.device, pin="0815")
    again.connect()
    assert doubled(again, 300) == 600
    assert server.integer("connections") == 2


@pytest.mark.parametrize("after_us", [10, 90, 170, 1_000])
def test_a_usb_cable_that_is_pulled_out_is_put_in_again(
    brick: Callable[..., Brick], after_us: int
) -> None:
    """In any part of a transfer: it fails or is through, and a new host finds the brick."""
    device = brick("direct_usb")
    device.run(100)
    computer = UsbComputer(device.device)
    assert computer.enumerate() == LEGO_BRICK
    now = device.device.cycles
    device.device.schedule_input(now + 48 * after_us, "usb.plugged", 0)
    with contextlib.suppress(PeerError):
        computer.write(1, BATTERY_LEVEL)
        computer.read(2)
    device.device.run_until(device.device.cycles + device.cycles(50))
    again = UsbComputer(device.device)
    assert again.enumerate() == LEGO_BRICK
    again.write(1, BATTERY_LEVEL)
    answer = again.read(2)
    assert answer[:3] == b"\x02\x0b\x00"
    assert int.from_bytes(answer[3:5], "little") == pytest.approx(8000, abs=20)
