# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""OpenOCD with our configuration: the guide's steps on a scripted ARM7TDMI."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from verification.support.jtag import tap
from verification.support.jtag.adapter import run_openocd
from verification.support.jtag.core import DebugCore

from ravenbrick.image.build import build_image
from ravenbrick.image.elf import read_image
from ravenbrick.image.raw_binary import flat_image
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree

CONFIGURATION = tree() / "tools" / "openocd" / "nxt.cfg"
CHIP_IDENTIFIER, IDENTITY_OF_CHIP = 0xFFFF_F240, 0x270B_0941
WATCHDOG, OSCILLATOR, MASTER_CLOCK = 0xFFFF_FD44, 0xFFFF_FC20, 0xFFFF_FC30

pytestmark = pytest.mark.skipif(
    shutil.which("openocd") is None, reason="openocd is not installed (Debian package openocd)"
)


@pytest.fixture
def core() -> DebugCore:
    """A processor whose chip says that it is an AT91SAM7S256."""
    processor = DebugCore()
    processor.memory[CHIP_IDENTIFIER] = IDENTITY_OF_CHIP
    return processor


def test_the_processor_is_found_and_examined(core: DebugCore) -> None:
    """Identity, length of the scan chain, version of EmbeddedICE, breakpoint units."""
    done = run_openocd(CONFIGURATION, ["init", "targets"], core)
    assert done.returncode == 0, done.stderr
    assert "tap/device found: 0x3f0f0f0f" in done.stderr
    assert "Embedded ICE version 1" in done.stderr
    assert "2 breakpoint/watchpoint units" in done.stderr
    assert not core.halted


def test_another_chip_is_named(core: DebugCore, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its identity, and the one that was expected."""
    monkeypatch.setattr(tap, "IDENTITY", 0x4BA00477)
    done = run_openocd(CONFIGURATION, ["init"], core)
    assert "UNEXPECTED: 0x4ba00477" in done.stderr
    assert "expected 1 of 1: 0x3f0f0f0f" in done.stderr


def test_it_halts_and_shows_its_registers(core: DebugCore) -> None:
    """Through instructions in scan chain 1; it goes on where it is told."""
    commands = ["init", "halt", "reg r3", "reg pc", "reg r3 0xcafe", "resume 0x203000"]
    done = run_openocd(CONFIGURATION, commands, core)
    assert "target halted in ARM state due to debug-request" in done.stderr
    assert "r3 (/32): 0x10000003" in done.stderr
    assert "pc (/32): 0x00202000" in done.stderr
    assert (core.halted, core.resumed_at, core.registers[3]) == (False, 0x203000, 0xCAFE)


def test_reset_init_stops_the_watchdog_and_starts_the_crystal(core: DebugCore) -> None:
    """The values of the configuration reach the chip's registers; the flash is recognised."""
    done = run_openocd(CONFIGURATION, ["init", "reset init", "flash probe 0"], core)
    written = [core.memory.get(place) for place in (WATCHDOG, OSCILLATOR, MASTER_CLOCK)]
    assert written == [0x8000, 0x601, 1], done.stderr
    assert core.halted


def test_an_image_is_loaded_into_the_ram(core: DebugCore, tmp_path: Path) -> None:
    """What GDB's 'load' writes: each byte of the image is where the linker put it."""
    project = tree() / "examples" / "blank"
    image = build_image(Workspace.of(project), read_robot(project), "ram").image
    flat = flat_image(read_image(image.path))
    file = tmp_path / "image.bin"
    file.write_bytes(flat.content[:4096])
    load = f"load_image {file} 0x{flat.address:x} bin"
    done = run_openocd(CONFIGURATION, ["init", "halt", load], core)
    words = [core.memory[flat.address + place].to_bytes(4, "little") for place in range(0, 4096, 4)]
    assert b"".join(words) == flat.content[:4096], done.stderr
