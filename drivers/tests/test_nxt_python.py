# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Direct_Commands: the Python package nxt-python at the other end of both links."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import nxt.brick
import nxt.error
import nxt.motor
import nxt.sensor
import nxt.sensor.digital
import nxt.sensor.generic
import pytest
from ravenbrick.brick.links.peers import BluetoothComputer, UsbComputer
from ravenbrick.brick.links.telegrams import BluetoothTelegrams, UsbTelegrams
from ravenbrick.errors import PeerError

from verification.support.bricks.observe import Brick

DEVICE, CONFIGURATION, TEXT = 1, 2, 3
GET_DESCRIPTOR, GET_CONFIGURATION = 6, 8


@dataclass
class Host:
    """nxt-python's brick, the virtual one, and the link between them."""

    remote: nxt.brick.Brick
    brick: Brick
    link: str

    def run(self, ms: float) -> None:
        """Let time pass."""
        self.brick.device.run_until(self.brick.device.cycles + self.brick.cycles(ms))


@pytest.fixture(params=["usb", "bluetooth"])
def host(request: pytest.FixtureRequest, brick: Callable[..., Brick]) -> Host:
    """The client, connected."""
    sensors = {"1": {"kind": "touch"}, "3": {"kind": "sound"}, "4": {"kind": "ultrasonic"}}
    device = brick(f"direct_{request.param}", sensors=sensors)
    device.run(1500)
    socket: Any
    if request.param == "usb":
        socket = UsbTelegrams(UsbComputer(device.device))
    else:
        socket = BluetoothTelegrams(BluetoothComputer(device.device, pin="1234"))
    return Host(nxt.brick.Brick(socket), device, request.param)


def test_the_brick_introduces_itself(host: Host) -> None:
    """Name, address, versions, battery."""
    brick = host.remote
    name, address, _, _ = brick.get_device_info()
    assert name.rstrip("\0") == "Ravenbrick"
    if host.link == "bluetooth":
        assert address == "00:16:53:01:02:03"
    assert brick.get_firmware_version() == ((1, 124), (1, 0))
    assert brick.get_battery_level() == pytest.approx(8000, abs=20)


def test_sensors_are_read(host: Host) -> None:
    """The touch sensor of port 1, free and pressed."""
    brick = host.remote
    touch = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.generic.Touch)
    host.run(20)
    assert touch.get_sample() is False
    host.brick.device.schedule_input(host.brick.device.cycles, "touch.1", 1)
    host.run(50)
    assert touch.get_sample() is True


def test_a_sound_sensor_hears_plainly_or_as_the_ear_does(host: Host) -> None:
    """A hum of 100 Hz, which the ear hears 19 dB weaker."""
    now = host.brick.device.cycles
    host.brick.device.schedule_input(now, "sound.3", 85)
    host.brick.device.schedule_input(now, "sound.3.frequency", 100)
    sensor = host.remote.get_sensor(nxt.sensor.Port.S3, nxt.sensor.generic.Sound, False)
    host.run(50)
    plain = sensor.get_sample()
    sensor.set_adjusted(True)
    host.run(50)
    assert plain + 100 < sensor.get_sample() < 1_000


def test_a_sensor_on_a_bus_is_read(host: Host) -> None:
    """The ultrasonic sensor of port 4: who it is, distances, a command; nobody on port 2."""
    brick = host.remote
    sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic, False)
    host.run(200)
    info = sonar.get_sensor_info()
    assert (info.product_id, info.sensor_type) == ("LEGO", "Sonar")
    for metres in (0.42, 1.25):
        host.brick.device.schedule_input(host.brick.device.cycles, "distance.4", metres + 0.001)
        host.run(100)
        assert sonar.get_distance() == round(100 * metres)
    sonar.write_value("command", (0,))
    host.run(20)
    assert sonar.read_value("command") == (0,)
    nobody = brick.get_sensor(nxt.sensor.Port.S2, nxt.sensor.generic.Ultrasonic, False)
    host.run(100)
    with pytest.raises(nxt.sensor.digital.I2CError):
        nobody.get_distance()


def test_motors_run_and_stop(host: Host) -> None:
    """A motor runs, brakes, and counts degrees from two places; another stops at its limit."""
    brick = host.remote
    motor = brick.get_motor(nxt.motor.Port.B)
    motor.reset_position(False)
    motor.run(70, regulated=False)
    host.run(500)
    turned = motor.get_tacho().rotation_count
    assert turned > 150
    motor.brake()
    host.run(400)
    stands = motor.get_tacho().rotation_count
    host.run(200)
    assert motor.get_tacho().rotation_count == stands
    motor.reset_position(True)
    tacho = motor.get_tacho()
    assert (tacho.block_tacho_count, tacho.rotation_count) == (0, stands)
    on, run = nxt.motor.Mode.ON | nxt.motor.Mode.BRAKE, nxt.motor.RunState.RUNNING
    idle = nxt.motor.RegulationMode.IDLE
    brick.set_output_state(nxt.motor.Port.C, -50, on, idle, 0, run, 90)
    host.run(1500)
    state = brick.get_output_state(nxt.motor.Port.C)
    assert state[5] is nxt.motor.RunState.IDLE
    assert -150 < state[7] <= -90


def test_what_is_unknown_is_refused(host: Host) -> None:
    """Files and programs belong to LEGO's firmware; wrong ports and tones are out of range."""
    brick = host.remote
    with pytest.raises(nxt.error.ProtocolError):
        brick.start_program("x.rxe")
    with pytest.raises(nxt.error.ProtocolError):
        brick.file_find_first("*.*")
    brick.play_tone(440, 100)
    brick.stop_sound_playback()
    assert brick.keep_alive() == 0


def test_usb_descriptors(brick: Callable[..., Brick]) -> None:
    """LEGO's identity, two bulk endpoints, a serial number; other requests stall."""
    device = brick("direct_usb")
    device.run(100)
    computer = UsbComputer(device.device)
    assert computer.enumerate() == (0x0694, 0x0002)

    def ask(request: int, kind: int, index: int = 0, length: int = 255) -> bytes:
        return computer.control(bytes((0x80, request, index, kind, 0, 0, length, 0)))

    whole = ask(GET_DESCRIPTOR, CONFIGURATION)
    assert len(whole) == 32 == int.from_bytes(whole[2:4], "little")
    assert [whole[20], whole[27]] == [0x01, 0x82]
    serial = ask(GET_DESCRIPTOR, TEXT, ask(GET_DESCRIPTOR, DEVICE)[16])
    assert serial[2:].decode("utf-16-le") == "001653000000"
    with pytest.raises(PeerError, match="stalled"):
        ask(GET_DESCRIPTOR, 9)
    assert ask(GET_CONFIGURATION, 0, length=1) == b"\x01"
