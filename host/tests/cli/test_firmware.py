# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick firmware`: images under test scripts, and what is said when something fails."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from verification.support.bricks.nxt_firmware import IMAGE

COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()", "firmware"]


@pytest.fixture
def firmware() -> Path:
    """LEGO's firmware."""
    if not IMAGE.exists():
        pytest.skip(f"{IMAGE} is absent: install the Debian package nxt-firmware")
    return IMAGE


def run(*words: str | Path) -> tuple[int, dict[str, Any]]:
    command = [*COMMAND, *map(str, words), "--json"]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, json.loads(done.stdout)


def test_each_test_continues_where_the_firmware_had_booted(firmware: Path, tmp_path: Path) -> None:
    path = tmp_path / "menu.py"
    path.write_text(
        "def boot(brick):\n    brick.expect_text('My Files', within=8)\n"
        "def test_right(brick):\n    brick.press('right')\n    brick.expect_text('NXT Program')\n"
        "def test_left(brick):\n    brick.press('left')\n    brick.expect_text('Try Me')\n"
    )
    code, answer = run(firmware, path)
    assert (code, answer["ok"]) == (0, True), answer
    assert [test["name"] for test in answer["tests"]] == ["test_right", "test_left"]
    again = run(firmware, path, "--only", "left")[1]["tests"]
    assert again == answer["tests"][1:], "a run is a function of image and script"


def test_a_failure_names_its_line_and_what_the_lcd_shows(firmware: Path, tmp_path: Path) -> None:
    path = tmp_path / "wrong.py"
    path.write_text("def test_menu(brick):\n    brick.expect_text('Hello', within=6)\n")
    code, answer = run(firmware, path)
    assert code == 8
    assert "wrong.py:2: the LCD does not show 'Hello' within 6 s" in answer["error"]
    assert "My Files" in answer["tests"][0]["lcd"]


def test_a_brick_that_switches_off_is_a_failure(firmware: Path, tmp_path: Path) -> None:
    path = tmp_path / "off.py"
    path.write_text(
        "def test_off(brick):\n    brick.run(5)\n    brick.press('grey')\n    brick.run(1)\n"
        "    brick.press('orange')\n    brick.run(4)\n"
    )
    code, answer = run(firmware, path)
    assert (code, "power_off" in answer["error"]) == (8, True)


@pytest.mark.parametrize(
    ("content", "cause"),
    [
        (None, "there is no such script"),
        ("x = 1\n", "has no function whose name begins with 'test_'"),
        ("def test_a(brick):\n  1 +\n", "script.py:2: SyntaxError"),
        ("import no_such_module\n", "script.py:1: ModuleNotFoundError"),
    ],
)
def test_a_script_that_cannot_be_used_is_refused(
    content: str | None, cause: str, tmp_path: Path
) -> None:
    image, path = tmp_path / "image.bin", tmp_path / "script.py"
    image.write_bytes(bytes(256))
    if content is not None:
        path.write_text(content)
    code, answer = run(image, path)
    assert code == 2
    assert cause in answer["error"]


def test_a_crash_of_the_firmware_is_told_with_its_instant(tmp_path: Path) -> None:
    image, path = tmp_path / "image.bin", tmp_path / "script.py"
    load_from_an_address_without_device = "00109fe5 000091e5 0080faff"
    image.write_bytes(bytes.fromhex(load_from_an_address_without_device))
    path.write_text("def test_it_runs(brick):\n    brick.run(1)\n")
    code, answer = run(image, path)
    assert code == 8
    assert re.search(r"script.py:2: at 0\.\d+ s: ", answer["error"]), answer
