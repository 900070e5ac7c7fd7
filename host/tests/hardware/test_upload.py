# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Loading a real brick: what is on the bus, what the loaders get, and each failure in words.

The bus is a folder like the kernel's; the loaders are small programs that say what libnxt's say.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.elf_files import make_elf

from ravenbrick.cli.app import app
from ravenbrick.errors import ConnectionFailedError, ExitCode, ImageFileError, ToolMissingError
from ravenbrick.hardware.upload import LOADERS, brick_to_load, load
from ravenbrick.hardware.usb_bricks import UDEV_RULE, BrickMode, UsbBrick, find_bricks
from ravenbrick.image.elf import read_image
from ravenbrick.image.raw_binary import flat_flash_file, flat_image

ROOT = Path(__file__).resolve().parents[3]
FIRMWARE = ("0694", "0002")
MONITOR = ("03eb", "6124")


@pytest.fixture
def bus(tmp_path: Path) -> Callable[..., list[UsbBrick]]:
    """From the identities of devices to what is found among them."""

    def plug(*devices: tuple[str, str], usable: bool = True) -> list[UsbBrick]:
        listed, nodes = tmp_path / "devices", tmp_path / "nodes" / "001"
        nodes.mkdir(parents=True)
        for number, (vendor, product) in enumerate(devices, 1):
            folder = listed / f"1-{number}"
            folder.mkdir(parents=True)
            facts = {"idVendor": vendor, "idProduct": product, "busnum": "1"}
            for name, text in (facts | {"devnum": str(number), "serial": "0016"}).items():
                (folder / name).write_text(text + "\n")
            if usable:
                (nodes / f"{number:03d}").touch()
        (listed / "usb1").mkdir(parents=True)
        return find_bricks(listed, nodes.parent)

    return plug


def test_bricks_are_found_among_other_devices(bus: Callable[..., list[UsbBrick]]) -> None:
    """By their identities, with the node that a program must open."""
    bricks = bus(("1d6b", "0002"), FIRMWARE, MONITOR)
    assert [brick.mode for brick in bricks] == [BrickMode.FIRMWARE, BrickMode.BOOT_MONITOR]
    assert bricks[0].node.as_posix().endswith("nodes/001/002")
    assert brick_to_load(bricks) == bricks[1]
    assert find_bricks(Path("/nowhere")) == []


@pytest.mark.parametrize(
    ("devices", "usable", "words"),
    [
        ((), True, "no brick on the USB; plug it in .* press the reset button"),
        ((FIRMWARE,), True, "running LEGO's or another firmware; bring it into its boot monitor"),
        ((MONITOR, MONITOR), True, "2 bricks wait"),
        ((MONITOR,), False, f"may not be opened by this user; install {UDEV_RULE}"),
    ],
)
def test_why_no_brick_can_be_loaded(
    bus: Callable[..., list[UsbBrick]],
    devices: tuple[tuple[str, str], ...],
    usable: bool,
    words: str,
) -> None:
    """Each state of the bus has its sentence and what to do."""
    with pytest.raises(ConnectionFailedError, match=words):
        brick_to_load(bus(*devices, usable=usable))


@pytest.fixture
def loader(tmp_path: Path) -> Callable[[str], Callable[[str], str]]:
    """From a shell script to a way to find it under a loader's name."""

    def write(script: str) -> Callable[[str], str]:
        program = tmp_path / "loader"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        return lambda _name: str(program)

    return write


def test_the_loader_gets_image_and_addresses(
    tmp_path: Path, loader: Callable[[str], Callable[[str], str]]
) -> None:
    """RAM images with load and jump address, flash images as a whole; plain bytes in both cases."""
    elf = tmp_path / "image.elf"
    elf.write_bytes(make_elf(base=0x20_2000, text_size=64, data_size=16))
    flat = flat_image(read_image(elf))
    assert (flat.address, len(flat.content)) == (0x20_2000, 80)
    copy = f'cp "$1" {tmp_path}/got; shift; echo "$@"'
    entry = f"0x{read_image(elf).entry:x}"
    assert load(flat, "ram", loader(copy)) == f"0x202000 {entry}"
    assert (tmp_path / "got").read_bytes() == flat.content
    assert load(flat, "flash", loader(copy)) == ""


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("NXT not found. Is it properly plugged in via USB?", "the loader sees no brick"),
        ("NXT found, but not running in reset mode.", "the brick runs its firmware"),
        ("Error while connecting to NXT", "cannot be opened; install tools/udev"),
        ("Error during initial handshake", "boot monitor does not answer"),
        ("Error Sending file", "the transfer broke off"),
        ("Error jumping to C program", "loaded but was not started"),
        ("something new", "'fwexec' failed; what it said is below"),
    ],
)
def test_failures_of_the_loader_are_explained(
    tmp_path: Path, loader: Callable[[str], Callable[[str], str]], said: str, words: str
) -> None:
    """What libnxt prints becomes a sentence with a cure; the print itself is kept."""
    elf = tmp_path / "image.elf"
    elf.write_bytes(make_elf())
    with pytest.raises(ConnectionFailedError, match=re.escape(words)) as caught:
        load(flat_image(read_image(elf)), "ram", loader(f"echo '{said}' >&2; exit 1"))
    assert said in caught.value.detail


def test_a_missing_loader_is_named(tmp_path: Path) -> None:
    """With the package to install."""
    elf = tmp_path / "image.elf"
    elf.write_bytes(make_elf())
    with pytest.raises(ToolMissingError, match=r"run 'apt-get install .*libnxt' as root"):
        load(flat_image(read_image(elf)), "flash", lambda _name: None)


@pytest.mark.skipif(shutil.which("fwexec") is None, reason="libnxt is not installed")
def test_the_real_loaders_say_what_is_expected(tmp_path: Path) -> None:
    """libnxt's own programs, without a brick, print the symptom that is looked for."""
    if brick := find_bricks():
        pytest.skip(f"a brick is plugged in: {brick[0].node}")
    image = tmp_path / "image.bin"
    image.write_bytes(bytes(2048))
    for tool in LOADERS.values():
        done = subprocess.run([tool.program, image], capture_output=True, text=True, check=False)
        assert done.returncode != 0 and "not found" in done.stdout + done.stderr


def test_only_firmware_is_restored(tmp_path: Path) -> None:
    """An ELF, an empty file and one larger than the flash are refused."""
    file = tmp_path / "firmware.bin"
    for content in (make_elf(), b"", bytes(256 * 1024 + 1)):
        file.write_bytes(content)
        with pytest.raises(ImageFileError, match="not the content of a brick's flash"):
            flat_flash_file(file)
    file.write_bytes(bytes(256 * 1024))
    assert len(flat_flash_file(file).content) == 256 * 1024


def test_the_command_without_a_brick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit code 11; with --out the plain image is written instead; a wrong kind is named."""
    elf = tmp_path / "image.elf"
    elf.write_bytes(make_elf())
    monkeypatch.setattr("ravenbrick.cli.upload.find_bricks", list)
    result = CliRunner().invoke(app, ["upload", str(elf)])
    assert result.exit_code == ExitCode.CONNECTION_FAILED
    assert "no brick on the USB" in result.output
    plain = tmp_path / "image.bin"
    assert CliRunner().invoke(app, ["upload", str(elf), "--out", str(plain)]).exit_code == 0
    assert plain.stat().st_size == 80
    result = CliRunner().invoke(app, ["upload", str(elf), "--image", "flash"])
    assert result.exit_code == ExitCode.USAGE and "is a ram image" in result.output


def test_the_udev_rule_knows_both_identities() -> None:
    """The shipped rule lets users open what is looked for."""
    rule = (ROOT / UDEV_RULE).read_text()
    for mode in BrickMode:
        vendor, product = mode.identity.split(":")
        assert re.search(rf'idVendor}}=="{vendor}", ATTR{{idProduct}}=="{product}"', rule)
    assert os.linesep in rule
