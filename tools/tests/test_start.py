# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The commands of docs/start.md and of the page about the paper, run as a reader would."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tools.docs.lessons import run_text

ROOT = Path(__file__).resolve().parents[2]


def console_commands(page: Path) -> list[str]:
    """Lines of all console blocks, in order."""
    blocks = re.findall(r"```console\n(.*?)```", page.read_text(), flags=re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.strip()]


def test_every_command_of_the_tutorial_succeeds() -> None:
    """The page's commands run in one shell, in order; each ends with 0."""
    commands = console_commands(ROOT / "docs" / "start.md")
    assert commands[0] == "make demo"
    script = "set -euo pipefail\n" + "\n".join(commands)
    result = subprocess.run(
        ["bash", "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=3600
    )
    assert result.returncode == 0, result.stdout[-3000:] + result.stderr[-3000:]
    assert (ROOT / "out" / "vehicle" / "report.html").is_file()


@pytest.mark.long("builds and analyses the paper's program")
def test_every_command_beside_the_paper_succeeds_and_prints_what_the_page_quotes() -> None:
    """The page's commands run in order, in the folder of the clone."""
    page = ROOT / "docs" / "guides" / "the-paper.md"
    transcript = run_text(page.read_text("utf-8"), page.name, ROOT)
    assert "schedulable" in transcript


def test_the_readme_names_the_two_commands_and_no_other() -> None:
    """README's console blocks are `make demo` and `make test`."""
    assert console_commands(ROOT / "README.md") == ["make demo", "make test"]
