# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Any firmware image on the virtual brick, as a test script sees it.

The firmware need not know this project: it is operated by buttons, sensors, USB and Bluetooth, and
judged by its LCD, motors and sound.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from ravenbrick.brick.image_font import find_font
from ravenbrick.brick.links.peers import BluetoothComputer, UsbComputer
from ravenbrick.brick.links.telegrams import BluetoothTelegrams, UsbTelegrams
from ravenbrick.catalogue import part_values
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ImageFileError, RunFaultError
from ravenbrick.installation import brick_module

__all__ = ["COMPUTER", "FirmwareBrick"]

COMPUTER = "00:1A:7D:00:00:01"
STEP_S = 0.05
SAMPLES_PER_S = float(MASTER_CLOCK.hertz) / 1000
font_of = cache(find_font)


def _configuration(changes: Mapping[str, Any]) -> str:
    motor = {"parameters": part_values("motors", "nxt")}
    return json.dumps(
        {
            "battery": {"kind": "aa", "voltage": 8.0},
            "motors": {port: motor for port in "ABC"},
            "sensors": {"1": {"kind": "touch"}},
            "bluetooth": {
                "address": "00:16:53:0A:0B:0C",
                "name": "Rover",
                "known": [{"address": COMPUTER, "name": "computer"}],
            },
            **changes,
        }
    )


class FirmwareBrick:
    """A brick that was just switched on, with an image in flash or RAM.

    It has three NXT motors, a touch sensor on port 1, six fresh cells and a paired computer.
    `changes` replace these fields of the brick's configuration (docs/reference/board.md). A
    method that lets time pass raises `RunFaultError` when the firmware crashes or switches off,
    except under `switched_off`. `device` is the `virtual_brick.VirtualBrick`.
    """

    def __init__(self, image: bytes, address: int, **changes: Any) -> None:
        module = brick_module()
        self._image = image
        try:
            kind = module.VirtualBrick
            self.device = kind.from_binary(_configuration(changes), image, address)
        except module.ImageError as error:
            raise ImageFileError(f"the image cannot be loaded: {error}") from None

    @property
    def seconds(self) -> float:
        """Time since power-on."""
        return MASTER_CLOCK.seconds(self.device.cycles)

    def run(self, seconds: float) -> None:
        """Let time pass. Raises RunFaultError."""
        stop = self.device.run_until(self.device.cycles + MASTER_CLOCK.cycles(seconds))
        if stop.reason != "reached":
            raise RunFaultError(f"at {self.seconds:.3f} s: {stop.reason}: {stop.message}")

    def set(self, name: str, value: float) -> None:
        """Change an input now: `touch.1`, `button.orange`, `battery.voltage`, ..."""
        self.device.schedule_input(self.device.cycles, name, value)

    def press(self, button: str, seconds: float = 0.2, pause: float = 0.4) -> None:
        """Press `orange`, `grey`, `left` or `right`, release it and wait."""
        self.set(f"button.{button}", 1)
        self.run(seconds)
        self.set(f"button.{button}", 0)
        self.run(pause)

    @property
    def lines(self) -> tuple[str, ...]:
        """Text on the LCD. Raises ImageFileError when the image has no font that is understood."""
        font = font_of(self._image)
        if font is None:
            raise ImageFileError(
                "the image has no table of letters of five to eight columns, so text on its LCD "
                "cannot be read; compare pixels ('device.lcd()')"
            )
        return font.lines(self.device.lcd())

    def expect_text(self, text: str, within: float = 5.0) -> None:
        """Wait until a line of the LCD contains a text. Raises AssertionError."""
        end, version = self.seconds + within, None
        while True:
            if version != self.device.lcd_version:
                version = self.device.lcd_version
                if any(text in line for line in self.lines):
                    return
            assert self.seconds < end, (
                f"the LCD does not show '{text}' within {within:g} s, but {list(self.lines)}"
            )
            self.run(STEP_S)

    def encoder(self, port: str) -> int:
        """Edges that a motor's encoder has given: its angle in degrees."""
        return round(self._last(f"motor.{port}.encoder"))

    def duty(self, port: str) -> float:
        """Duty cycle of a motor's bridge, -1 to 1."""
        return self._last(f"motor.{port}.duty")

    def _last(self, signal: str) -> float:
        values = self.device.signals()[signal][1]
        return float(struct.unpack("<d", values[-8:])[0]) if values else 0.0

    def tone(self, since: float = 0.0) -> tuple[float, float]:
        """Length in s and strongest frequency in Hz of the sound since an instant; 0 for none."""
        begin = MASTER_CLOCK.cycles(since)
        samples = np.frombuffer(self.device.sound(begin), "<i2").astype(float)
        sounding = np.flatnonzero(samples)
        if not len(sounding):
            return 0.0, 0.0
        heard = samples[sounding[0] : sounding[-1] + 1]
        spectrum = np.abs(np.fft.rfft(heard - heard.mean()))
        seconds = len(heard) / SAMPLES_PER_S
        return seconds, float(spectrum.argmax()) / seconds

    def usb(self) -> UsbComputer:
        """A USB host with its cable plugged in; `enumerate` it first."""
        return UsbComputer(self.device)

    def bluetooth(self, pin: str | None = None) -> BluetoothComputer:
        """The computer in range; `connect` it first. The brick knows it unless it has a PIN."""
        return BluetoothComputer(self.device, COMPUTER if pin is None else COMPUTER[:-1] + "9",
                                 pin=pin)  # fmt: skip

    def usb_telegrams(self) -> UsbTelegrams:
        """For `nxt.brick.Brick` of nxt-python, over the cable."""
        return UsbTelegrams(self.usb())

    def bluetooth_telegrams(self, pin: str | None = None) -> BluetoothTelegrams:
        """For `nxt.brick.Brick` of nxt-python, over the air."""
        return BluetoothTelegrams(self.bluetooth(pin))

    @contextmanager
    def switched_off(self) -> Iterator[None]:
        """Expect that the firmware switches the brick off meanwhile. Raises AssertionError."""
        try:
            yield
        except RunFaultError:
            if self.device.run_until(self.device.cycles).reason == "power_off":
                return
            raise
        raise AssertionError(f"the brick is still on at {self.seconds:.3f} s")
