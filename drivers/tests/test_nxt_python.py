# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""NXT.Direct_Commands: the Python package nxt-python at the other end of both links."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from drivers.tests.air import Peer
from drivers.tests.observe import Brick

nxt_brick = pytest.importorskip("nxt.brick", reason="the Python package nxt-python is missing")
import nxt.error  # noqa: E402
import nxt.motor  # noqa: E402
import nxt.sensor  # noqa: E402
import nxt.sensor.generic  # noqa: E402

USB_BULK_OUT, USB_BULK_IN = 1, 2
PATIENCE_MS = 500
DEVICE, CONFIGURATION, TEXT = 1, 2, 3


class Cable:
    """A USB host that has configured the brick; packets for nxt-python."""

    type = "usb"
    bsize = 60

    def __init__(self, brick: Brick) -> None:
        self.brick = brick
        self.now_ms = 0.0
        self._number = 0
        brick.set(0, "usb.plugged", 1)

    def run(self, ms: float) -> None:
        """Let time pass."""
        self.now_ms += ms
        self.brick.run(self.now_ms)

    def transfer(self, kind: str, **wishes: Any) -> bytes:
        """One transfer to its end."""
        self._number += 1
        at = max(self.brick.cycles(self.now_ms), self.brick.device.cycles)
        patience = self.brick.cycles(PATIENCE_MS)
        self.brick.device.usb_transfer(at, self._number, patience, kind, **wishes)
        for _ in range(2 * PATIENCE_MS):
            self.run(1)
            for _, number, data, failure in self.brick.device.usb_completed():
                assert number == self._number
                if failure is not None:
                    raise OSError(failure)
                return bytes(data)
        raise OSError("no end")

    def control(self, request: int, value: int, length: int = 0, to_host: bool = False) -> bytes:
        """A standard request to the device."""
        kind = 0x80 if to_host else 0
        fields = (kind, request, value & 0xFF, value >> 8, 0, 0, length & 0xFF, length >> 8)
        return self.transfer("control", data=bytes(fields))

    def enumerate(self) -> None:
        """What every host does with a new device."""
        self.transfer("reset")
        self.control(5, 9)
        self.control(9, 1)

    def send(self, data: bytes) -> None:
        """A telegram for the brick."""
        self.transfer("out", endpoint=USB_BULK_OUT, data=data)

    def recv(self) -> bytes:
        """A telegram from the brick."""
        return self.transfer("in", endpoint=USB_BULK_IN, length=64)

    def close(self) -> None:
        """Nothing to let go of."""


class Air:
    """A Bluetooth connection; each telegram with its length before it."""

    type = "bluetooth"
    bsize = 60

    def __init__(self, brick: Brick) -> None:
        self.peer = Peer(brick)
        self.run = self.peer.run

    def send(self, data: bytes) -> None:
        """A telegram for the brick."""
        self.peer.send(len(data).to_bytes(2, "little") + data)

    def recv(self) -> bytes:
        """A telegram from the brick."""

        def whole() -> bool:
            stream = self.peer.stream
            return len(stream) >= 2 and len(stream) >= 2 + int.from_bytes(stream[:2], "little")

        assert self.peer.run(PATIENCE_MS, whole), "no answer"
        return self.peer.take()[2:]

    def close(self) -> None:
        """Nothing to let go of."""


@pytest.fixture(params=["usb", "bluetooth"])
def host(request: pytest.FixtureRequest, brick: Callable[..., Brick]) -> Any:
    """The link, connected, and nxt-python's brick on it."""
    device = brick(f"direct_{request.param}")
    link: Any = Cable(device) if request.param == "usb" else Air(device)
    link.run(1500)
    if request.param == "usb":
        link.enumerate()
    else:
        assert link.peer.connect()
        link.run(50)
    return link, nxt_brick.Brick(link)


def test_the_brick_introduces_itself(host: Any) -> None:
    """Name, address, versions, battery."""
    link, brick = host
    name, address, _, _ = brick.get_device_info()
    assert name.rstrip("\0") == "Ravenbrick"
    if link.type == "bluetooth":
        assert address == "00:16:53:01:02:03"
    assert brick.get_firmware_version() == ((1, 124), (1, 0))
    assert brick.get_battery_level() == pytest.approx(8000, abs=20)


def test_sensors_are_read(host: Any) -> None:
    """The touch sensor of port 1, free and pressed."""
    link, brick = host
    touch = brick.get_sensor(nxt.sensor.Port.S1, nxt.sensor.generic.Touch)
    link.run(20)
    assert touch.get_sample() is False
    device = link.brick if link.type == "usb" else link.peer.brick
    now = link.now_ms if link.type == "usb" else link.peer.now_ms
    device.set(now + 5, "touch.1", 1)
    link.run(50)
    assert touch.get_sample() is True


def test_motors_run_and_stop(host: Any) -> None:
    """A motor runs at a power, counts degrees, and brakes; another stops at its limit."""
    link, brick = host
    motor = brick.get_motor(nxt.motor.Port.B)
    motor.reset_position(False)
    motor.run(70, regulated=False)
    link.run(500)
    turned = motor.get_tacho().rotation_count
    assert turned > 150
    motor.brake()
    link.run(200)
    stands = motor.get_tacho().rotation_count
    link.run(200)
    assert motor.get_tacho().rotation_count == stands
    on, run = nxt.motor.Mode.ON | nxt.motor.Mode.BRAKE, nxt.motor.RunState.RUNNING
    idle = nxt.motor.RegulationMode.IDLE
    brick.set_output_state(nxt.motor.Port.C, -50, on, idle, 0, run, 90)
    link.run(1500)
    state = brick.get_output_state(nxt.motor.Port.C)
    assert state[5] is nxt.motor.RunState.IDLE
    assert -150 < state[7] <= -90


def test_what_is_unknown_is_refused(host: Any) -> None:
    """Files and programs belong to LEGO's firmware; wrong ports and tones are out of range."""
    _, brick = host
    with pytest.raises(nxt.error.ProtocolError):
        brick.start_program("x.rxe")
    with pytest.raises(nxt.error.ProtocolError):
        brick.file_find_first("*.*")
    brick.play_tone(440, 100)
    brick.stop_sound_playback()
    assert brick.keep_alive() == 0


def test_usb_descriptors(brick: Callable[..., Brick]) -> None:
    """LEGO's identity, two bulk endpoints, a serial number; other requests stall."""
    link = Cable(brick("direct_usb"))
    link.run(100)
    link.enumerate()
    device = link.control(6, DEVICE << 8, 18, to_host=True)
    assert device[8:12] == bytes((0x94, 0x06, 0x02, 0x00)) and len(device) == 18
    whole = link.control(6, CONFIGURATION << 8, 255, to_host=True)
    assert len(whole) == 32 == int.from_bytes(whole[2:4], "little")
    assert [whole[20], whole[27]] == [0x01, 0x82]
    serial = link.control(6, TEXT << 8 | device[16], 255, to_host=True)
    assert serial[2:].decode("utf-16-le") == "001653000000"
    with pytest.raises(OSError, match="stalled"):
        link.control(6, 9 << 8, 8, to_host=True)
    assert link.control(8, 0, 1, to_host=True) == b"\x01"
