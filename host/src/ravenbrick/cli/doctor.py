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
from ravenbrick.errors import ConnectionFailedError, ToolMissingError
from ravenbrick.target.build import TOOLS, Tool, find_tool
from ravenbrick.target.real import LOADERS, brick_to_load
from ravenbrick.target.usb_bricks import find_bricks

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


def _connection() -> list[Check]:
    """What a real brick needs; nothing of it is needed for the virtual one."""
    loaders = [_loader(tool) for tool in LOADERS.values()]
    bricks = find_bricks()
    on_bus = [Check(f"brick {b.node}", b.usable, b.mode.words) for b in bricks]
    try:
        brick_to_load(bricks)
        ready = Check("upload", all(loader.ok for loader in loaders), "possible")
    except ConnectionFailedError as error:
        ready = Check("upload", False, error.sentence)
    return [*loaders, *on_bus, ready]


def _loader(tool: Tool) -> Check:
    place = find_tool(tool)
    advice = f"missing ({tool.purpose}); Debian package {tool.package}"
    return Check(tool.program, place is not None, place or advice)


@command("ravenbrick doctor")
def doctor_command(json_output: JsonOption = False) -> dict[str, Any]:
    reporter = Reporter(json_output)
    checks = _checks()
    reporter.table(
        ("what", "state", "found"),
        [[check.name, "ok" if check.ok else "MISSING", check.found] for check in checks],
        left=("state", "found"),
    )
    connection = _connection()
    reporter.print("\nFor a real brick:")
    reporter.table(
        ("what", "state", "found"),
        [[check.name, "ok" if check.ok else "no", check.found] for check in connection],
        left=("state", "found"),
    )
    missing = [check.name for check in checks if not check.ok]
    if missing:
        raise ToolMissingError(
            f"missing: {', '.join(missing)}; run 'make setup' in the repository",
            detail="\n".join(f"{c.name}: {c.found}" for c in checks if not c.ok),
        )
    return {
        "checks": [asdict(check) for check in checks],
        "connection": [asdict(check) for check in connection],
    }
