# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick debug` on C programs of newlib: its semihosting, Thumb state, programs from GDB."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tools.docs.gdb_session import talk
from verification.support.projects import VEHICLE

from ravenbrick.cli.debug import GDB

COMPILER = "arm-none-eabi-gcc"
SOURCE = Path(__file__).parent / "programs" / "squares.c"
COMMAND = [sys.executable, "-c", "from ravenbrick.cli import main; main()", "debug", str(VEHICLE)]

pytestmark = [
    pytest.mark.skipif(
        shutil.which(GDB) is None,
        reason=f"{GDB} is not installed (Debian package gdb-multiarch)",
    ),
    pytest.mark.skipif(
        shutil.which(COMPILER) is None,
        reason="the C compiler is not installed (Debian package gcc-arm-none-eabi)",
    ),
]


def compiled(folder: Path, state: str, *options: str, at: str = "0x202000") -> Path:
    """The program with newlib's own semihosting (librdimon), of ARM or Thumb instructions."""
    image = folder / f"squares-{state}{len(options)}.elf"
    command = [COMPILER, "-mcpu=arm7tdmi", f"-m{state}", "-g", "-Og", *options]
    command += ["--specs=nano.specs", "--specs=rdimon.specs"]
    command += [f"-Wl,-Ttext-segment={at}", "-Wl,--no-warn-rwx-segments", "-o", str(image)]
    subprocess.run([*command, str(SOURCE)], check=True)
    return image


def gdb(image: Path, *commands: str) -> list[str]:
    """What GDB says to each command."""
    return talk([*COMMAND, "--gdb", "--port", "0", "--elf", str(image)], commands)


LONG = pytest.mark.long("long")
STATES = [pytest.param("arm", marks=LONG), "thumb"]


@pytest.mark.parametrize("state", STATES)
def test_what_newlib_prints_is_shown_by_gdb(tmp_path: Path, state: str) -> None:
    """Text, numbers, the stream of errors, and the code of the program's exit."""
    image = compiled(tmp_path, state)
    printed, why, back, again = gdb(image, "continue", "monitor why", "reverse-stepi", "continue")
    lines = "1: 1 so far\n2: 5 so far\n3: 14 so far\nsum 14\n"
    assert lines in printed
    assert why.endswith("the program ended itself with code 7 (semihosting)")
    assert "so far" not in back and "so far" not in again


@pytest.mark.parametrize("state", STATES)
def test_both_states_are_debugged_in_both_directions(tmp_path: Path, state: str) -> None:
    """Breakpoint, arguments, backtrace, status; steps back to who wrote a variable."""
    _, place, backtrace, status, _, written, where, before, stepped, forwards = gdb(
        compiled(tmp_path, state),
        "break add if amount == 9",
        "continue",
        "info args",
        "bt",
        "print ($cpsr >> 5) & 1",
        "watch total",
        "reverse-continue",
        "bt 1",
        "print total",
        "reverse-stepi",
        "continue",
    )[1:]
    assert place == "amount = 9"
    assert "in main () at" in backtrace
    assert status == f"$1 = {int(state == 'thumb')}"
    assert "Old value = 5\nNew value = 1" in written
    assert where.startswith("#0  ") and "add (amount=" in where
    assert before == "$2 = 1"
    assert stepped.endswith("total += amount;")
    assert "Old value = 1\nNew value = 5" in forwards


def test_a_program_is_loaded_into_ram_by_gdb(tmp_path: Path) -> None:
    """`load` of a newer program over the old one, as on the real brick."""
    old, new = compiled(tmp_path, "arm"), compiled(tmp_path, "thumb", "-Dmain=main")
    *_, loaded, start, printed = gdb(
        old,
        "tbreak main",
        "continue",
        "monitor reset",
        "maintenance flush register-cache",
        f"file {new}",
        "load",
        "print $pc == ((unsigned) _start & ~1)",
        "continue",
    )
    assert "Loading section .text" in loaded and "Start address" in loaded
    assert start == "$1 = 1"
    assert "3: 14 so far" in printed


@LONG
def test_a_program_is_loaded_into_flash_by_gdb(tmp_path: Path) -> None:
    """Pages are erased and written; memory then compares equal to the file's sections."""
    image = compiled(tmp_path, "thumb")
    flashed = compiled(tmp_path, "arm", "-Wl,-Tdata=0x204000", at="0x110000")
    *_, loaded, compared = gdb(image, f"file {flashed}", "load", "compare-sections .text")
    assert "Loading section .text" in loaded
    assert compared.endswith("matched.")


@LONG
def test_another_program_begins_with_its_symbols(tmp_path: Path) -> None:
    """`program FILE` in GDB: server and GDB both take the file."""
    first, second = compiled(tmp_path, "arm"), compiled(tmp_path, "thumb")
    _, begun, printed = gdb(first, "continue", f"program {second}", "continue")
    assert "cycle 0, 0.000000 s" in begun
    assert "sum 14" in printed
