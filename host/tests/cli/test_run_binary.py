# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick run --bin`: a firmware as its bytes in flash, in a project that has no tasks."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import wave
from pathlib import Path
from typing import Any

import pytest
from verification.support.bricks.nxt_firmware import IMAGE

ROOT = Path(__file__).resolve().parents[3]
COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The blank example without its program's tasks and without criteria."""
    if not IMAGE.exists():
        pytest.skip(f"{IMAGE} is absent: install the Debian package nxt-firmware")
    folder = tmp_path / "brick"
    shutil.copytree(ROOT / "examples" / "blank", folder)
    for path in (folder / "robot.toml", folder / "scenarios" / "press.toml"):
        head, *tables = path.read_text().split("\n[")
        kept = [t for t in tables if not t.startswith(("[tasks", "[criteria", "[setpoints"))]
        none = "tasks = []\n" if path.name == "robot.toml" else ""
        path.write_text("\n[".join([head + none, *kept]))
    return folder


def run(*arguments: str) -> dict[str, Any]:
    done = subprocess.run([*COMMAND, "run", *arguments, "--json"], capture_output=True, text=True)
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_firmware_in_flash_runs_and_both_engines_make_the_same_run(project: Path) -> None:
    binary = (str(project), "press", "--bin", str(IMAGE), "--at", "flash")
    answer = run(*binary, "--sound", str(project / "heard.wav"))
    assert answer["ok"], answer
    assert answer["stop"] == "reached"
    assert Path(answer["recording"]).is_file()
    with wave.open(str(project / "heard.wav")) as file:
        length_s = file.getnframes() / file.getframerate()
    assert length_s == pytest.approx(answer["duration"], abs=0.001)
    assert run(*binary, "--engine", "reference")["trace_digest"] == answer["trace_digest"]


def test_bytes_that_do_not_fit_into_ram_are_refused(project: Path) -> None:
    answer = run(str(project), "press", "--bin", str(IMAGE), "--at", "ram")
    assert not answer["ok"]
    assert "262144" in answer["error"] or "memory" in answer["error"]


def test_bytes_for_all_of_the_ram_start_at_its_beginning(project: Path) -> None:
    """As a debug probe loads them, over the boot monitor's part."""
    loop = project / "loop.bin"
    loop.write_bytes(b"\xfe\xff\xff\xea" * 0x4000)
    answer = run(str(project), "press", "--bin", str(loop), "--at", "whole-ram")
    assert "0x00200000" in answer["error"], answer
    loop.write_bytes(loop.read_bytes() + b"\0")
    answer = run(str(project), "press", "--bin", str(loop), "--at", "whole-ram")
    assert "65537 bytes" in answer["error"]
