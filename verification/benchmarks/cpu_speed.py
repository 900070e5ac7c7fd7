# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of the virtual brick's processor beside emulators of other makers.

The same ELF files run everywhere, engine after engine and the whole in rounds: programs of three
kinds in ARM and in Thumb state, with their data apart from their code and on the same page. Times
are processor time, without loading (`qemu_system` says how that is had of a whole machine). Those
of our engines are what passes on the clock, since a thread compiles JIT code beside the run: not
less than the run's own processor time, and what a user waits for. One more mean counts processor
time of both threads. A figure is the median of the rounds. Every engine must end with the same
result.
"""

from __future__ import annotations

import json
import math
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from verification.benchmarks import qemu_system
from verification.benchmarks.child_time import run_timed
from verification.benchmarks.figures import Figure
from verification.commands import NoResultError
from verification.support.paths import ROOT

SOURCES = ROOT / "verification" / "benchmarks" / "cpu"
START = ROOT / "verification" / "processor" / "busy_start.S"
CONTROLLER = ROOT / "examples" / "vehicle" / "generated"
ROUNDS = 5
PEER_SECONDS_MAX = 60
CYCLES_MAX = 1 << 34
RAM = (0x0020_0000, 0x1_0000)
FAST, REFERENCE = "fast engine", "reference engine"
FAST_BY_PROCESSOR = "fast engine, processor time of all its threads"
UNICORN = "unicorn 2.1.4"
QEMU = "qemu-arm, user emulation"
MGBA = "mGBA's ARM core"
ABSENT = {
    QEMU: f"install the Debian package qemu-user (or over {PEER_SECONDS_MAX} s)",
    MGBA: "install the Debian packages libmgba-dev and gcc",
    qemu_system.NAME: "install the Debian package qemu-system-arm",
}
PEERS = (UNICORN, QEMU, qemu_system.NAME, MGBA, REFERENCE)
LAYOUTS = {"apart": "code and data apart", "packed": "code and data on one page"}
STATES = {"arm": "ARM", "thumb": "Thumb"}


@dataclass(frozen=True)
class Kind:
    """A program in C: its sources and how often it goes round.

    Emulators that translate code can collapse when data lies on the same page: fewer rounds there.
    """

    name: str
    sources: tuple[Path, ...]
    rounds: dict[str, int]


KINDS = (
    Kind("integer", (SOURCES / "integer.c",), {"apart": 1600, "packed": 400}),
    Kind(
        "PI controller in soft float",
        (SOURCES / "pi_controller.c", CONTROLLER / "functional.c"),
        {"apart": 800, "packed": 200},
    ),
    Kind("mixed", (SOURCES / "mixed.c",), {"apart": 2000, "packed": 500}),
)


@dataclass
class Program:
    """An ELF file and what was measured of it."""

    name: str
    elf: Path
    longer: Path
    image: bytes
    symbols: dict[str, int]
    instructions: int = 0
    result: int | None = None
    virtual_seconds: float = 0.0
    seconds: dict[str, list[float]] = field(default_factory=dict)

    def took(self, engine: str, seconds: float | None, result: int | None) -> None:
        """One run of an engine; none when it is absent or did not end in time."""
        if self.result is None:
            self.result = result
        if result not in (None, self.result):
            raise NoResultError(f"{self.name}: {engine} ends with {result}, not {self.result}")
        if seconds is not None:
            self.seconds.setdefault(engine, []).append(seconds)

    def mips(self, engine: str) -> float | None:
        """Guest instructions per microsecond, median of the rounds."""
        seconds = self.seconds.get(engine)
        return self.instructions / 1e6 / statistics.median(seconds) if seconds else None


def compiled(elf: Path, kind: Kind, state: str, layout: str, rounds: int) -> Path:
    """The ELF file at `elf`."""
    command = ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", f"-m{state}", "-mthumb-interwork", "-O2"]
    command += ["-ffreestanding", "-nostdlib", "-Wl,--build-id=none", "-w", "-Wa,--no-warn"]
    command += [f"-DROUNDS={rounds}", "-I", str(CONTROLLER)]
    command += ["-DPACKED"] if layout == "packed" else []
    command += ["-T", str(SOURCES / "program.ld"), str(START), *map(str, kind.sources)]
    subprocess.run([*command, "-lgcc", "-o", str(elf)], check=True)
    return elf


def build(folder: Path, kind: Kind, state: str, layout: str) -> Program:
    """The program as an ELF file, and the one that goes round more often."""
    from elftools.elf.elffile import ELFFile

    rounds, stem = kind.rounds[layout], f"{kind.name.split()[0]}_{state}_{layout}"
    elf = compiled(folder / f"{stem}.elf", kind, state, layout, rounds)
    more = rounds * qemu_system.LONGER
    longer = compiled(folder / f"{stem}_longer.elf", kind, state, layout, more)
    image = bytearray(RAM[1])
    with elf.open("rb") as file:
        parsed = ELFFile(file)
        for segment in parsed.iter_segments("PT_LOAD"):
            offset = segment["p_vaddr"] - RAM[0]
            image[offset : offset + segment["p_filesz"]] = segment.data()
        table = parsed.get_section_by_name(".symtab")
        names = ("start", "finish", "result")
        symbols = {name: table.get_symbol_by_name(name)[0]["st_value"] for name in names}
    name = f"busy program, {kind.name}, {STATES[state]}, {LAYOUTS[layout]}"
    return Program(name, elf, longer, bytes(image), symbols)


def run_ours(program: Program) -> None:
    """Both engines on the whole brick."""
    command = ["cargo", "run", "--locked", "--quiet", "--release", "-p", "virtual-brick"]
    command += ["--example", "brick_speed", "--", str(program.elf), str(CYCLES_MAX), "1"]
    result = subprocess.run(command, cwd=ROOT / "virtual-brick", capture_output=True, text=True)
    if result.returncode != 0:
        raise NoResultError(f"brick_speed {program.elf.name}: {result.stderr}")
    answer: dict[str, Any] = json.loads(result.stdout)
    program.instructions = answer["instructions"]
    program.virtual_seconds = answer["virtual_seconds"]
    for name, engine in (("fast", FAST), ("reference", REFERENCE)):
        program.took(engine, answer[name]["seconds"], answer["result"])
    program.took(FAST_BY_PROCESSOR, answer["fast"]["processor_seconds"], answer["result"])


def run_unicorn(program: Program) -> None:
    """One run in a process of its own."""
    image = program.elf.with_suffix(".bin")
    words = [hex(program.symbols[name]) for name in ("start", "finish", "result")]
    command = [sys.executable, "-m", "verification.benchmarks.cpu_speed", str(image), *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    seconds, result = done.stdout.split()
    program.took(UNICORN, float(seconds), int(result))


def unicorn_alone(image: bytes, start: int, finish: int, result: int) -> tuple[float, int]:
    """Run to the program's end: the processor time of the run, and the result."""
    import unicorn.unicorn_const as constants
    from unicorn.arm_const import UC_ARM_REG_CPSR
    from unicorn.unicorn_py3 import Uc

    machine = Uc(constants.UC_ARCH_ARM, constants.UC_MODE_ARM)
    machine.mem_map(*RAM)
    machine.mem_write(RAM[0], image)
    machine.reg_write(UC_ARM_REG_CPSR, 0xD3)
    begin = time.process_time()
    machine.emu_start(start, finish)
    seconds = time.process_time() - begin
    return seconds, int.from_bytes(machine.mem_read(result, 4), "little")


def run_qemu(program: Program) -> None:
    """One run as a process; none without the emulator, and no second one after a late end."""
    if shutil.which("qemu-arm") is None or (QEMU in program.seconds and not program.seconds[QEMU]):
        return
    try:
        seconds, code = run_timed(["qemu-arm", str(program.elf)], PEER_SECONDS_MAX)
    except subprocess.TimeoutExpired:
        program.seconds[QEMU] = []
        return
    if code != 0:
        raise NoResultError(f"{program.elf.name}: {QEMU} exits with {code}")
    program.took(QEMU, seconds, None)


def run_qemu_system(program: Program) -> None:
    """Two runs as processes; the result of the other engines is known."""
    address, result = program.symbols["result"], program.result
    assert result is not None
    seconds = qemu_system.run(program.elf, program.longer, address, result)
    program.took(qemu_system.NAME, seconds, None)


def build_mgba(folder: Path) -> Path | None:
    """The driver of mGBA's core; none where compiler or library is missing."""
    driver = folder / "mgba"
    command = ["gcc", "-O2", "-w", str(SOURCES / "mgba.c"), "-lmgba", "-o", str(driver)]
    if shutil.which("gcc") is None:
        return None
    built = subprocess.run(command, capture_output=True)
    return driver if built.returncode == 0 else None


def run_mgba(driver: Path, program: Program) -> None:
    """One run over a flat memory."""
    image = program.elf.with_suffix(".bin")
    words = [hex(program.symbols[name]) for name in ("start", "result")]
    done = subprocess.run([str(driver), str(image), *words], capture_output=True, text=True)
    if done.returncode != 0:
        reason = done.stderr or f"ended with {done.returncode}"
        raise NoResultError(f"mGBA's core, {program.elf.name}: {reason}")
    seconds, result = done.stdout.split()
    program.took(MGBA, float(seconds), int(result))


def measure(folder: Path) -> list[Program]:
    """All programs, all engines, in rounds."""
    driver = build_mgba(folder)
    programs = [
        build(folder, kind, state, layout)
        for kind in KINDS
        for state in STATES
        for layout in LAYOUTS
    ]
    for turn in range(ROUNDS):
        for program in programs:
            program.elf.with_suffix(".bin").write_bytes(program.image)
            run_ours(program)
            run_unicorn(program)
            run_qemu(program)
            run_qemu_system(program)
            if driver is not None:
                run_mgba(driver, program)
        print(f"busy programs: round {turn + 1} of {ROUNDS}", file=sys.stderr, flush=True)
    return programs


def geometric_mean(values: Iterable[float]) -> float:
    """Of positive values."""
    return math.exp(statistics.mean(math.log(value) for value in values))


def means(programs: list[Program]) -> Iterator[Figure]:
    """Geometric means over the programs that an engine ran."""
    for peer in PEERS:
        ran = [program for program in programs if program.mips(peer) is not None]
        if ran:
            ours = geometric_mean(program.mips(FAST) or 0 for program in ran)
            theirs = geometric_mean(program.mips(peer) or 0 for program in ran)
            name = f"busy programs, geometric mean of {len(ran)}"
            yield Figure(name, ours, "guest MIPS", peer, theirs)
            if peer == UNICORN:
                ours = geometric_mean(program.mips(FAST_BY_PROCESSOR) or 0 for program in ran)
                yield Figure(f"{name}, by processor time", ours, "guest MIPS", peer, theirs)


def measurements() -> Iterator[Figure]:
    """Speeds of all programs beside those of the peers, and their means."""
    with tempfile.TemporaryDirectory() as folder:
        programs = measure(Path(folder))
    for program in programs:
        mips = program.mips(FAST) or 0.0
        ratio = program.virtual_seconds / statistics.median(program.seconds[FAST])
        yield Figure(program.name, ratio, "virtual s per s", "the brick", 1.0)
        for peer in PEERS:
            value = program.mips(peer)
            if value is not None:
                yield Figure(program.name, mips, "guest MIPS", peer, value)
            else:
                reason = f"not compared with {peer}: {ABSENT[peer]}"
                print(f"{program.name}: {reason}", file=sys.stderr, flush=True)
    yield from means(programs)


if __name__ == "__main__":
    addresses = [int(word, 16) for word in sys.argv[2:]]
    print(*unicorn_alone(Path(sys.argv[1]).read_bytes(), *addresses))
