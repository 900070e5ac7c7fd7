# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick compare-brick`: taken on the virtual brick, and through libnxt on its USB."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.bricks import nxt_firmware
from verification.support.bricks.played_usb import build_library, run_with_device

from ravenbrick.brick.links.peers import UsbComputer
from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode

pytestmark = pytest.mark.usefixtures("self_test_runs")

# The command, but for the kernel's list of the bus and pyusb, which see no played device.
COMMAND = """
from pathlib import Path
import ravenbrick.cli.compare_brick as compare_brick
from ravenbrick.cli import main
from ravenbrick.hardware.usb_bricks import BrickMode, UsbBrick
from verification.support.bricks.played_usb import PlayedLink
waiting = UsbBrick(BrickMode.BOOT_MONITOR, Path("/dev/null"), "", True)
compare_brick.find_bricks = lambda: [waiting]
compare_brick.open_link = lambda address: PlayedLink()
main()
"""


def called(*arguments: str) -> tuple[int, str]:
    """Exit code and output."""
    done = CliRunner().invoke(app, ["compare-brick", *arguments])
    return done.exit_code, done.output


def test_an_unaltered_virtual_brick_agrees(tmp_path: Path) -> None:
    """The dry run: the record and its image are saved, every row is shown, exit code 0."""
    file = tmp_path / "brick.jsonl"
    code, output = called(str(file), "--take", "virtual")
    assert code == ExitCode.OK, output
    assert "DIFFERS" not in output and "moved" not in output
    assert "apb_cycles" in output and "touch.pressed" in output
    assert "not seen by the self-test: undefined_internal_cycles" in output
    assert file.is_file() and file.with_suffix(".elf").is_file()


def test_an_altered_one_ends_with_its_own_exit_code(tmp_path: Path) -> None:
    """The first sentence names the parameter and its value; the saved record says the same."""
    file = str(tmp_path / "brick.jsonl")
    code, output = called(file, "--take", "virtual", "--alter", "pdc_steal_cycles=4")
    assert code == ExitCode.BRICK_DIFFERS
    assert "parameters moved: pdc_steal_cycles = 4" in output
    code, output = called(file, "--json")
    answer = json.loads(output)
    assert (code, answer["ok"], answer["timing"]) == (13, False, {"pdc_steal_cycles": 4})
    rows = {row["row"]: row for row in answer["rows"]}
    assert rows["dma.loop_beside_100_transfers"]["explained"]


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["x.jsonl"], ExitCode.BAD_IMAGE, "x.jsonl: cannot be read"),
        (["x.jsonl", "--alter", "apb_cycles=3"], ExitCode.USAGE, "--take virtual"),
        (
            ["x.jsonl", "--take", "virtual", "--alter", "speed=3"],
            ExitCode.USAGE,
            "--alter speed=3: expected NAME=VALUE",
        ),
        (["x.elf", "--take", "virtual"], ExitCode.USAGE, "name the record otherwise"),
    ],
)
def test_what_cannot_be_compared_is_a_sentence(
    tmp_path: Path, arguments: list[str], code: ExitCode, sentence: str
) -> None:
    """The first line names the cause."""
    done = called(str(tmp_path / arguments[0]), *arguments[1:])
    assert done[0] == code
    assert sentence in done[1]


@pytest.mark.skipif(
    shutil.which("fwexec") is None or shutil.which("cc") is None,
    reason="libnxt or the host's C compiler is not installed (Debian packages libnxt, gcc)",
)
def test_the_record_of_a_brick_on_the_usb_is_taken(tmp_path: Path) -> None:
    """libnxt loads the image into a boot monitor; the program appears, measures and answers."""
    brick, file = nxt_firmware.firmware_brick(), tmp_path / "brick.jsonl"
    brick.enter_boot_monitor()
    computer = UsbComputer(brick)
    computer.enumerate()
    command = [sys.executable, "-c", COMMAND, "compare-brick", str(file), "--take", "usb"]
    done = run_with_device(command, computer, build_library(tmp_path))
    assert json.loads(file.read_text().splitlines()[0])["source"] == "usb", done.stdout
    assert '{"finished":"test"}' in done.stdout
    assert "coprocessor_stretch_cycles" in done.stdout
    assert done.returncode == ExitCode.OK, done.stdout
