# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""nxt-python, a client that nobody here wrote, speaks with the brick's own firmware."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import nxt.brick
import nxt.motor
import pytest
from verification.support.bricks.nxt_firmware import (
    COMPUTER,
    brick_at_the_menu,
    compile_nxc,
    encoder,
    run_ms,
)

from ravenbrick.brick.links.peers import BluetoothComputer, UsbComputer
from ravenbrick.brick.links.telegrams import BluetoothTelegrams, UsbTelegrams

PROGRAM = "task main() { OnFwd(OUT_B, 50); Wait(400); Off(OUT_B); Wait(5000); }"


@pytest.fixture(params=[BluetoothTelegrams, UsbTelegrams])
def client(request: pytest.FixtureRequest) -> Iterator[tuple[nxt.brick.Brick, Any]]:
    """The client connected with a brick, and that brick."""
    brick = brick_at_the_menu()
    computers = {
        BluetoothTelegrams: BluetoothComputer(brick, COMPUTER),
        UsbTelegrams: UsbComputer(brick),
    }
    with nxt.brick.Brick(request.param(computers[request.param])) as connected:
        yield connected, brick


def test_it_reads_name_address_version_and_battery(client: tuple[nxt.brick.Brick, Any]) -> None:
    remote, _ = client
    name, address, _, free_flash = remote.get_device_info()
    assert (name, address) == ("Rover", "00:16:53:0A:0B:0C")
    assert free_flash > 50_000
    assert remote.get_firmware_version() == ((1, 124), (1, 29))
    assert abs(remote.get_battery_level() - 8000) < 50


def test_it_runs_a_motor_and_reads_its_tacho(client: tuple[nxt.brick.Brick, Any]) -> None:
    remote, brick = client
    motor = remote.get_motor(nxt.motor.Port.A)
    motor.run(60)
    run_ms(brick, 1000)
    motor.brake()
    run_ms(brick, 1500)
    tacho = motor.get_tacho().tacho_count
    assert 300 < tacho < 900
    assert tacho == encoder(brick, "A")


def test_it_uploads_and_starts_a_program(client: tuple[nxt.brick.Brick, Any]) -> None:
    remote, brick = client
    program = compile_nxc(PROGRAM)
    with remote.open_file("drive.rxe", "wb", len(program)) as file:
        file.write(program)
    assert ("drive.rxe", len(program)) in list(remote.find_files("*.rxe"))
    with remote.open_file("drive.rxe", "rb") as file:
        assert file.read() == program
    remote.start_program("drive.rxe")
    run_ms(brick, 100)
    assert remote.get_current_program_name() == "drive.rxe"
    run_ms(brick, 1000)
    assert 100 < encoder(brick, "B") < 500
    remote.stop_program()


def test_a_computer_the_brick_does_not_know_is_asked_for_a_pin_code() -> None:
    brick = brick_at_the_menu()
    stranger = BluetoothComputer(brick, "00:1A:7D:00:00:99", "stranger", pin="1234")
    brick.bluetooth_send(brick.cycles, stranger.address, "page", name="stranger", pin="1234")
    run_ms(brick, 3000)
    assert stranger.collect() == [], "the question stands on the LCD"
    for _ in range(3):
        for pressed in (1, 0):
            brick.schedule_input(brick.cycles, "button.orange", pressed)
            run_ms(brick, 300 if pressed == 0 else 150)
        run_ms(brick, 1500)
        stranger.collect()
        if stranger.connected:
            break
    assert stranger.connected
    stranger.write(b"\x02\x00\x01\x9b")
    assert stranger.read(5)[2:] == b"\x02\x9b\x00"
