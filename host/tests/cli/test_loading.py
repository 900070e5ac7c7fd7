# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands are loaded when they are asked for."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import ravenbrick.cli
from ravenbrick.cli.app import COMMANDS, ELSEWHERE

FOLDER = Path(ravenbrick.cli.__file__).parent
SLOW = ("scipy", "control", "matplotlib")


def test_every_command_of_a_module_is_listed() -> None:
    """And each stands in the module that is loaded for it."""
    found = {
        name: file.stem
        for file in FOLDER.glob("*.py")
        for name in re.findall(r"^@command\(.*\)\ndef (\w+)_command\(", file.read_text(), re.M)
    }
    assert found == {name: ELSEWHERE.get(name, name) for name in COMMANDS}


@pytest.mark.parametrize("name", ["home", "new", "run", "build", "grade"])
def test_a_command_that_does_not_compute_loads_no_numerical_library(name: str) -> None:
    """They take two seconds of processor time."""
    program = f"""
import sys
sys.argv = ["ravenbrick", "{name}", "--help"]
from ravenbrick.cli import main
try:
    main()
except SystemExit:
    print([name for name in {SLOW} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]", done.stdout + done.stderr
