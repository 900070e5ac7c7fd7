# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""GDB driven by its commands, for tests."""

from __future__ import annotations

import subprocess

__all__ = ["talk"]

QUIET = ("set pagination off", "set confirm off", "set width 0", "set style enabled off")
MARK = "=== said ==="


def talk(command: list[str], commands: tuple[str, ...]) -> list[str]:
    """Run a program that reads GDB's commands; what GDB said to each."""
    lines = [*QUIET, f"echo {MARK}\\n"]
    for line in commands:
        lines += [line, f"echo {MARK}\\n"]
    done = subprocess.run(
        command,
        input="\n".join([*lines, "kill", "quit"]) + "\n",
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    said = done.stdout.replace("(gdb) ", "").split(MARK)[1:-1]
    assert len(said) == len(commands), done.stdout
    return [text.strip() for text in said]
