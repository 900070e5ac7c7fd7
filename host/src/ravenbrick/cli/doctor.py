# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick doctor`: is everything there that the other commands need?"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from dataclasses import asdict, dataclass
from typing import Any

from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import ToolMissingError
from ravenbrick.target.build import TOOLS, Tool, find_tool

__all__ = ["Check", "doctor_command"]

MODULES = ("numpy", "scipy", "control", "matplotlib", "elftools", "jsonschema", "virtual_brick")


@dataclass(frozen=True)
class Check:
    """One thing that was looked for; `found` is its version or place."""

    name: str
    ok: bool
    found: str


def _tool(tool: Tool) -> Check:
    program = find_tool(tool)
    if program is None:
        return Check(
            tool.program, False, f"missing ({tool.purpose}); Debian package {tool.package}"
        )
    try:
        done = subprocess.run(
            [program, "--version"], capture_output=True, text=True, timeout=20, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return Check(tool.program, False, f"{program} does not start ({type(error).__name__})")
    first = (done.stdout or done.stderr).strip().split("\n")[0]
    return Check(tool.program, done.returncode == 0, first or program)


def _module(name: str) -> Check:
    present = importlib.util.find_spec(name) is not None
    return Check(f"Python module {name}", present, "present" if present else "missing")


def _checks() -> list[Check]:
    python = Check("Python", sys.version_info >= (3, 11), sys.version.split()[0])
    return [python, *(_tool(tool) for tool in TOOLS), *(_module(name) for name in MODULES)]


@command("ravenbrick doctor")
def doctor_command(json_output: JsonOption = False) -> dict[str, Any]:
    """Look for the toolchain and the Python modules, and say what is missing."""
    reporter = Reporter(json_output)
    checks = _checks()
    reporter.table(
        ("what", "state", "found"),
        [[check.name, "ok" if check.ok else "MISSING", check.found] for check in checks],
        left=("state", "found"),
    )
    missing = [check.name for check in checks if not check.ok]
    if missing:
        raise ToolMissingError(
            f"missing: {', '.join(missing)}; run 'make setup' in the repository",
            detail="\n".join(f"{c.name}: {c.found}" for c in checks if not c.ok),
        )
    return {"checks": [asdict(check) for check in checks]}
