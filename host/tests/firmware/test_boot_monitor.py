# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The boot monitor as the tools `fwexec` and `fwflash` use it: their sequences of commands."""

from __future__ import annotations

import struct
from typing import Any

import pytest
from verification.support.bricks.nxt_firmware import (
    FLASH,
    IMAGE,
    MENU_MS,
    brick_at_the_menu,
    firmware_brick,
    picture,
    run_ms,
)

from ravenbrick.brick.links.peers import UsbComputer

USER_RAM = 0x0020_2000
PAGE = 256
# Copies the page at 16#202100# to the flash page whose number is at 16#202300#, programs it,
# waits until the flash is ready and returns. ARM code, written for this test:
#   ldr r0,=16#FFFFFF60# / ldr r1,=16#202100# / ldr r2,[r1,#16#200#] / r3 := 16#100000# + 256 r2
#   64 words copied / command 16#5A000001# or page << 8 / wait for FRDY / bx lr
ROUTINE = struct.pack(
    "<20I",
    0xE59F0040,  # ldr r0, [pc, #64]   flash controller
    0xE59F1040,  # ldr r1, [pc, #64]   the page
    0xE5912200,  # ldr r2, [r1, #512]  its number
    0xE3A03601,  # mov r3, #16#100000#
    0xE0833402,  # add r3, r3, r2, lsl #8
    0xE3A0C040,  # mov r12, #64
    0xE4914004,  # ldr r4, [r1], #4
    0xE4834004,  # str r4, [r3], #4
    0xE25CC001,  # subs r12, r12, #1
    0x1AFFFFFB,  # bne to the ldr
    0xE59F4020,  # ldr r4, [pc, #32]   write page, with the key
    0xE1844402,  # orr r4, r4, r2, lsl #8
    0xE5804004,  # str r4, [r0, #4]
    0xE5904008,  # ldr r4, [r0, #8]
    0xE3140001,  # tst r4, #1
    0x0AFFFFFC,  # beq to the ldr
    0xE12FFF1E,  # bx lr
    0,
    0xFFFFFF60,
    0x00202100,
) + struct.pack("<I", 0x5A000001)


class Monitor:
    """A host that speaks with the monitor."""

    def __init__(self, brick: Any) -> None:
        brick.enter_boot_monitor()
        self._computer = UsbComputer(brick)
        assert self._computer.enumerate() == (0x03EB, 0x6124)
        assert self.ask("N#") == b"\n\r"

    def tell(self, command: str, data: bytes = b"") -> None:
        self._computer.write(1, command.encode())
        if data:
            self._computer.write(1, data)

    def ask(self, command: str) -> bytes:
        self.tell(command)
        return self._computer.read(2, 4096)

    def word(self, address: int) -> int:
        (value,) = struct.unpack("<I", self.ask(f"w{address:08X},4#"))
        return int(value)

    def wait_ready(self) -> None:
        """Ask the flash controller until it is ready."""
        assert any(self.word(0xFFFF_FF68) & 1 for _ in range(20))

    def program(self, page: int, content: bytes) -> None:
        self.tell(f"W{0x0020_2300:08X},{page:08X}#")
        self.tell(f"S{0x0020_2100:08X},{len(content):08X}#", content)
        self.tell(f"G{USER_RAM:08X}#")


@pytest.fixture
def brick() -> Any:
    """A brick with the firmware of Debian's package, just switched on."""
    return firmware_brick()


def test_it_reads_and_writes_memory_and_tells_its_version(brick: Any) -> None:
    monitor = Monitor(brick)
    assert monitor.ask("V#").startswith(b"v1.4 ")
    monitor.tell("W00202010,DEADBEEF#")
    assert monitor.word(0x0020_2010) == 0xDEAD_BEEF
    monitor.tell("H00202010,1234#")
    monitor.tell("O00202013,56#")
    assert monitor.ask("R00202010,00000004#") == bytes.fromhex("3412AD56")
    assert monitor.ask("h00202010,2#") == b"\x34\x12"
    assert monitor.ask("o00202013,1#") == b"\x56"
    assert monitor.word(FLASH) == 0xFFFF_FFFF, "recovery overwrote the start of the flash"
    assert brick.read_memory(FLASH + 0x8000, 64) == IMAGE.read_bytes()[0x8000:0x8040]


def test_load_and_go_runs_an_image_in_ram(brick: Any) -> None:
    monitor = Monitor(brick)
    program = struct.pack("<4I", 0xE59F1008, 0xE3A0002A, 0xE5810000, 0xEAFFFFFE)
    program += struct.pack("<I", 0x0020_3000)
    monitor.tell(f"S{USER_RAM:08X},{len(program):08X}#", program)
    monitor.tell(f"G{USER_RAM:08X}#")
    run_ms(brick, 5)
    assert brick.program_counter == USER_RAM + 12
    assert brick.read_memory(0x0020_3000, 1) == b"\x2a"


def test_flashing_brings_the_firmware_back(brick: Any) -> None:
    monitor = Monitor(brick)
    monitor.tell("WFFFFFC30,00000007#")
    for region in range(16):
        monitor.wait_ready()
        monitor.tell("WFFFFFF60,00050100#")
        monitor.tell(f"WFFFFFF64,{0x5A000004 | region << 14:08X}#")
        monitor.tell("WFFFFFF60,00340100#")
    monitor.tell(f"S{USER_RAM:08X},{len(ROUTINE):08X}#", ROUTINE)
    image = IMAGE.read_bytes()
    pages = range(2 * 64)
    for page in pages:
        monitor.program(page, image[PAGE * page : PAGE * (page + 1)])
    assert monitor.word(FLASH) == int.from_bytes(image[:4], "little")
    assert brick.read_memory(FLASH, len(image)) == image
    monitor.tell(f"G{FLASH:08X}#")
    run_ms(brick, MENU_MS)
    assert not brick.in_boot_monitor, "the firmware took the USB over"
    assert picture(brick)[14:] == picture(brick_at_the_menu())[14:]


def test_the_firmware_asks_for_the_monitor() -> None:
    brick = brick_at_the_menu()
    computer = UsbComputer(brick)
    computer.enumerate()
    computer.write(1, b"\x01\x97Let's dance: SAMBA\x00")
    stop = brick.run_until(brick.cycles + 48_055_000)
    assert (stop.reason, "boot monitor" in stop.message) == ("power_off", True)
    Monitor(brick)
