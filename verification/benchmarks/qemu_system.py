# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""QEMU as a whole machine that counts instructions, as a peer of the virtual brick.

The machine is Versatile PB, whose memory begins at 0 and so holds the brick's addresses; its clock
advances by one nanosecond per instruction (`-icount shift=0,sleep=off`). A program ends with a
supervisor call: the handler placed at its vector passes the low byte of the result on as the exit
code (semihosting, operation SYS_EXIT_EXTENDED).

Starting the machine takes longer than a program does. A program's time is therefore the difference
of a run that goes round `LONGER` times as often and of a plain one, which leaves out start and
translation, in favour of QEMU.
"""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

from verification.benchmarks.child_time import run_timed

NAME = "qemu-system-arm -icount"
EMULATOR = "qemu-system-arm"
LONGER = 12
SECONDS_MAX = 60
STOPPED = 0x20026
MACHINE = [EMULATOR, "-M", "versatilepb", "-cpu", "arm926", "-m", "64", "-nodefaults"]
MACHINE += ["-display", "none", "-monitor", "none", "-serial", "none", "-audiodev", "none,id=none"]
MACHINE += ["-semihosting-config", "enable=on,target=native", "-icount", "shift=0,sleep=off"]


def vectors(result: int) -> bytes:
    """Words from address 0: reset and undefined instruction stop, a supervisor call exits."""
    stop, exit_extended = 0xEAFFFFFE, 0x20
    handler = [
        0xE59F1014,  # ldr r1, =result
        0xE5911000,  # ldr r1, [r1]
        0xE28F3010,  # add r3, pc, #16: the block of two words
        0xE5831004,  # str r1, [r3, #4]
        0xE3A00000 | exit_extended,  # mov r0, #exit_extended
        0xE1A01003,  # mov r1, r3
        0xEF123456,  # svc 0x123456
    ]
    return struct.pack("<12I", stop, stop, *handler, result, STOPPED, 0)


def seconds_of(elf: Path, handler: Path) -> tuple[float, int]:
    """Processor time of a run in seconds, the machine's start included, and the exit code."""
    command = [*MACHINE, "-device", f"loader,file={handler},addr=0,force-raw=on"]
    command += ["-device", f"loader,file={elf},cpu-num=0"]
    return run_timed(command, SECONDS_MAX)


def run(elf: Path, longer: Path, result_address: int, result: int) -> float | None:
    """Seconds that the program takes; none without the emulator.

    `longer` is the same program with `LONGER` times the rounds, `result` what the plain one must
    leave at `result_address`.
    """
    if shutil.which(EMULATOR) is None:
        return None
    handler = elf.with_suffix(".vectors")
    handler.write_bytes(vectors(result_address))
    plain, code = seconds_of(elf, handler)
    if code != result & 0xFF:
        raise SystemExit(f"{elf.name}: {NAME} exits with {code}, not with {result & 0xFF}")
    long, _ = seconds_of(longer, handler)
    return (long - plain) / (LONGER - 1)
