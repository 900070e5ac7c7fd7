# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick upload` with libnxt's own programs on the virtual brick's USB and boot monitor."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.bricks import nxt_firmware
from verification.support.bricks.played_usb import build_library, run_with_device

from ravenbrick.brick.lcd_text import FONT_SIZE, FONT_SYMBOL, lcd_text
from ravenbrick.brick.links.peers import UsbComputer
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ExitCode
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ImageKind, read_image
from ravenbrick.image.raw_binary import flat_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree

BLANK = tree() / "examples" / "blank"
START_MS, PRESS_MS, PULLED_MS = 1_500, 200, 20
# The command, but for the kernel's list of the bus, on which nothing is played.
COMMAND = """
from pathlib import Path
import ravenbrick.cli.upload as upload
from ravenbrick.cli import main
from ravenbrick.hardware.usb_bricks import BrickMode, UsbBrick
upload.find_bricks = lambda: [UsbBrick(BrickMode.BOOT_MONITOR, Path("/dev/null"), "", True)]
main()
"""
LONG = pytest.mark.long("whole flash memories")
Upload = Callable[..., subprocess.CompletedProcess[str]]

pytestmark = pytest.mark.skipif(
    shutil.which("fwexec") is None or shutil.which("cc") is None,
    reason="libnxt or the host's C compiler is not installed (Debian packages libnxt, gcc)",
)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What libnxt's programs take for libusb."""
    return build_library(tmp_path_factory.mktemp("usb"))


@pytest.fixture
def upload(library: Path) -> Upload:
    """From a brick and arguments to the command that has ended."""

    def run(brick: Any, *arguments: str) -> subprocess.CompletedProcess[str]:
        brick.enter_boot_monitor()
        computer = UsbComputer(brick)
        assert computer.enumerate() == (0x03EB, 0x6124)
        command = [sys.executable, "-c", COMMAND, "upload", *arguments]
        return run_with_device(command, computer, library)

    return run


def image_file(kind: ImageKind) -> Path:
    """The example's image of this kind, built."""
    return build_image(Workspace.of(BLANK), read_robot(BLANK), kind).image.path


def display(brick: Any, file: Path) -> list[str]:
    """The text on the display, by the letters of the image."""
    font = brick.read_memory(read_image(file).symbols[FONT_SYMBOL].address, FONT_SIZE)
    pixels = np.array(list(brick.lcd()), dtype=np.bool_).reshape(64, 100)
    return list(lcd_text(pixels, font))


def test_a_ram_image_is_loaded_and_runs(upload: Upload) -> None:
    """fwexec brings it to its place and jumps: the program counts a press of the sensor."""
    file, brick = image_file("ram"), nxt_firmware.firmware_brick()
    done = upload(brick, str(file))
    assert done.returncode == 0 and "the program runs" in done.stdout, done.stdout
    nxt_firmware.run_ms(brick, START_MS)
    assert "presses 0" in display(brick, file)
    for value in (1, 0):
        brick.schedule_input(brick.cycles, "touch.1", value)
        nxt_firmware.run_ms(brick, PRESS_MS)
    nxt_firmware.run_ms(brick, START_MS)
    assert "presses 1" in display(brick, file)


@LONG
def test_a_flash_image_is_written_and_starts(upload: Upload) -> None:
    """fwflash's own routine runs on the virtual processor; every byte is in the flash then."""
    file, brick = image_file("flash"), nxt_firmware.firmware_brick()
    done = upload(brick, str(file), "--image", "flash")
    assert done.returncode == 0 and "written and started" in done.stdout, done.stdout
    flat = flat_image(read_image(file))
    assert (flat.address, brick.read_memory(nxt_firmware.FLASH, len(flat.content))) == (
        nxt_firmware.FLASH,
        flat.content,
    )
    nxt_firmware.run_ms(brick, START_MS)
    assert "presses 0" in display(brick, file)


@LONG
def test_the_firmware_is_restored(upload: Upload) -> None:
    """After the monitor took its first pages, LEGO's firmware is back and shows its menu."""
    brick, firmware = nxt_firmware.firmware_brick(), nxt_firmware.IMAGE.read_bytes()
    done = upload(brick, str(nxt_firmware.IMAGE), "--restore")
    assert done.returncode == 0, done.stdout
    assert brick.read_memory(nxt_firmware.FLASH, len(firmware)) == firmware
    nxt_firmware.run_ms(brick, nxt_firmware.MENU_MS)
    assert (
        nxt_firmware.picture(brick)[14:]
        == nxt_firmware.picture(nxt_firmware.brick_at_the_menu())[14:]
    )


def test_a_brick_with_its_firmware_is_told_how_to_be_loaded(library: Path) -> None:
    """libnxt finds it by its identity, and its words become what to do."""
    computer = UsbComputer(nxt_firmware.brick_at_the_menu())
    computer.enumerate()
    command = [sys.executable, "-c", COMMAND, "upload", str(nxt_firmware.IMAGE), "--restore"]
    done = run_with_device(command, computer, library)
    assert done.returncode == ExitCode.CONNECTION_FAILED
    assert "the brick runs its firmware" in done.stdout


@LONG
def test_a_cable_that_is_pulled_is_told(library: Path) -> None:
    """In the middle of the image: exit code 11 and what to try."""
    brick = nxt_firmware.firmware_brick()
    brick.enter_boot_monitor()
    computer = UsbComputer(brick)
    computer.enumerate()
    brick.schedule_input(brick.cycles + MASTER_CLOCK.cycles_of_ms(PULLED_MS), "usb.plugged", 0)
    command = [sys.executable, "-c", COMMAND, "upload", str(image_file("ram"))]
    done = run_with_device(command, computer, library)
    assert done.returncode == ExitCode.CONNECTION_FAILED
    assert "the transfer broke off" in done.stdout
