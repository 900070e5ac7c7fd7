# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of the virtual brick's processor beside emulators without a notion of cycles.

The same ELF files run everywhere, one after the other: a busy program in ARM and in Thumb state,
with its data apart from its code and on the same page. Times are processor time, without loading.
"""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "benchmarks" / "cpu"
START = ROOT / "conformance" / "cpu" / "busy_start.S"
# Emulators that translate code collapse when data lies on the same page: fewer rounds there.
ROUNDS = {"apart": 4000, "packed": 250}
PEER_SECONDS_MAX = 90
CYCLES_MAX = 1 << 34
QEMU = "qemu-arm"
QEMU_ABSENT = "qemu-arm (absent: install the Debian package qemu-user; or over 90 s)"
LAYOUTS = {"apart": "code and data apart", "packed": "code and data on one page"}
RAM = (0x0020_0000, 0x1_0000)


def build(folder: Path, state: str, layout: str) -> Path:
    """The busy program as an ELF file."""
    file = folder / f"busy_{state}_{layout}.elf"
    command = ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", f"-m{state}", "-mthumb-interwork", "-O2"]
    command += ["-ffreestanding", "-nostdlib", f"-DROUNDS={ROUNDS[layout]}", "-Wl,--build-id=none"]
    command += ["-w", "-Wa,--no-warn"]
    command += ["-DPACKED"] if layout == "packed" else []
    command += ["-T", str(SOURCES / "busy.ld")]
    command += [str(START), str(SOURCES / "busy.c"), "-lgcc", "-o", str(file)]
    subprocess.run(command, check=True)
    return file


def ours(elf: Path) -> dict[str, Any]:
    """Speeds of both engines on the whole brick, in guest MIPS and times real time."""
    command = ["cargo", "run", "--locked", "--quiet", "--release", "-p", "virtual-brick"]
    command += ["--example", "brick_speed", "--", str(elf), str(CYCLES_MAX)]
    result = subprocess.run(command, cwd=ROOT / "virtual-brick", capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(f"brick_speed {elf.name}: {result.stderr}")
    answer: dict[str, Any] = json.loads(result.stdout)
    return answer


def unicorn_seconds(elf: Path) -> float:
    """Processor time of one run, in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.cpu_speed", str(elf)]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return float(result.stdout)


def run_in_unicorn(elf: Path) -> float:
    """Load, run to the program's end, give the processor time of the run."""
    import unicorn
    from elftools.elf.elffile import ELFFile
    from unicorn.arm_const import UC_ARM_REG_CPSR

    with elf.open("rb") as file:
        image = ELFFile(file)
        machine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_ARM)
        machine.mem_map(*RAM)
        for segment in image.iter_segments("PT_LOAD"):
            machine.mem_write(segment["p_vaddr"], segment.data())
        symbols = image.get_section_by_name(".symtab")
        finish = symbols.get_symbol_by_name("finish")[0]["st_value"]
        entry = image["e_entry"]
    machine.reg_write(UC_ARM_REG_CPSR, 0xD3)
    start = time.process_time()
    machine.emu_start(entry, finish)
    return time.process_time() - start


def qemu_seconds(elf: Path) -> float | None:
    """Processor time of one run as a process; none without the emulator or a timely end."""
    if shutil.which(QEMU) is None:
        return None
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        subprocess.run([QEMU, str(elf)], check=True, timeout=PEER_SECONDS_MAX)
    except subprocess.TimeoutExpired:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measurements() -> Iterator[tuple[str, float, str, str | None, float | None]]:
    """Figure, value, unit, peer and the peer's value."""
    with tempfile.TemporaryDirectory() as folder:
        for state in ("arm", "thumb"):
            for layout, shown in LAYOUTS.items():
                elf = build(Path(folder), state, layout)
                name = f"busy program, {state.upper() if state == 'arm' else 'Thumb'}, {shown}"
                speeds = ours(elf)
                count, mips = speeds["instructions"] / 1e6, speeds["fast"]["mips"]
                real_time = speeds["fast"]["times_real_time"]
                yield name, real_time, "virtual s per s", "the brick", 1.0
                peer = count / unicorn_seconds(elf)
                yield name, mips, "guest MIPS", "unicorn 2.1.4", peer
                seconds = qemu_seconds(elf)
                if seconds is None:
                    yield name, mips, "guest MIPS", QEMU_ABSENT, None
                else:
                    yield name, mips, "guest MIPS", "qemu-arm, user emulation", count / seconds
                reference = speeds["reference"]["mips"]
                yield name, mips, "guest MIPS", "reference engine", reference


if __name__ == "__main__":
    print(run_in_unicorn(Path(sys.argv[1])))
