# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A session with GDB on the vehicle, as the guide shows it: who wrote a variable, found backwards.

`python -m tools.docs.gdb_session` holds the session and writes it into docs/guides/debugging.md;
`--check` holds it and compares what it is about: stops, values, callers and the line that is found.
The rest, and all numbers, change with every build. Needs gdb-multiarch and the built vehicle.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

__all__ = ["compared", "guide_session", "hold", "main", "talk"]

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs" / "guides" / "debugging.md"
COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
COMMAND += ["debug", str(ROOT / "examples" / "vehicle"), "drive", "--gdb", "--port", "0"]
QUIET = ("set pagination off", "set confirm off", "set width 0", "set style enabled off")
MARK = "=== said ==="
# The assignment that is looked for.
FOUND = "Control_Left :="
# A fresh clone has sources that are newer than an image that was built elsewhere.
TOUCHED = "warning: Source file is more recent than executable."
BEGIN = "<!-- written by python -m tools.docs.gdb_session -->\n\n```text\n"
END = "```\n"

SESSION = (
    "break driving.begin_drive",
    "continue",
    "tbreak panel.draw",
    "continue",
    "info threads",
    "print vehicle_control_left",
    "watch vehicle_control_left",
    "reverse-continue",
    "backtrace",
    "monitor time",
    "delete",
    "reverse-continue",
    "monitor time",
)
TELLING = re.compile(r"\(gdb\) |Thread \d+ hit |(?:Old|New) value|#[01] .*\b(?:panel|tasks)\.")


def talk(command: list[str], commands: tuple[str, ...]) -> list[str]:
    """Run a program that reads GDB's commands; what GDB said to each. Raises `OSError`."""
    lines = [*QUIET, f"echo {MARK}\\n"]
    for line in commands:
        lines += [line, f"echo {MARK}\\n"]
    done = subprocess.run(
        command,
        input="\n".join([*lines, "kill", "quit"]) + "\n",
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=1200,
        check=False,
    )
    said = done.stdout.replace("(gdb) ", "").split(MARK)[1:-1]
    if done.returncode != 0 or len(said) != len(commands):
        raise OSError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout}")
    return [text.strip("\n").rstrip() for text in said]


def _without_folders(text: str) -> str:
    return re.sub(r"[\w./-]+/(?=[\w.-]+\.(?:ad[bs]|[cS])[:,])", "", text)


def hold() -> str:
    """The session as it would stand on a terminal, without folders."""
    said = talk(COMMAND, SESSION)
    parts = [f"(gdb) {given}\n{answer}\n" for given, answer in zip(SESSION, said, strict=True)]
    lines = _without_folders("".join(parts)).splitlines()
    shown = (line.rstrip() for line in lines if line.strip() and line != TOUCHED)
    return "".join(f"{line}\n" for line in shown)


def guide_session() -> str:
    """The session that the guide shows."""
    return GUIDE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]


def compared(session: str) -> list[str]:
    """The telling lines without what another build changes: addresses, values, numbers."""
    telling = filter(lambda line: TELLING.match(line) or FOUND in line, session.splitlines())
    lines = (re.sub(r"0x[0-9a-f]+|\d+(?:\.\d+)?", "#", line) for line in telling)
    return [" ".join(line.split()) for line in lines]


def main(arguments: list[str]) -> int:
    """Write or check; 1 when the guide shows another session."""
    held = hold()
    if "--check" in arguments:
        same = compared(held) == compared(guide_session())
        if not same:
            print(f"{GUIDE}: shows another session than GDB; run tools.docs.gdb_session")
            print(held)
        return int(not same)
    before, _, rest = GUIDE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    GUIDE.write_text(before + BEGIN + held + END + after, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
