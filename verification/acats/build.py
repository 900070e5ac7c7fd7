# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""From a test's files to an image for the brick, or to the reason why there is none."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from verification.acats.suite import AcatsTest, Suite

__all__ = ["BuildError", "Builder", "Image", "Memory"]

HERE = Path(__file__).resolve().parent
PREFIX = "arm-linux-gnueabi-"
MACHINE = (
    *("-mcpu=arm7tdmi", "-marm", "-mfloat-abi=soft", "-mthumb-interwork", "-fno-pic"),
    *("-fno-stack-protector", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables"),
    *("-ffunction-sections", "-fdata-sections", "-O2"),
)
LINK = (
    *("arm-none-eabi-gcc", "-mcpu=arm7tdmi", "-marm", "-nostdlib", "-nostartfiles"),
    *("-Wl,--gc-sections", "-Wl,--no-warn-mismatch", "-Wl,--build-id=none"),
    *("-Wl,-z,noexecstack", "-Wl,--no-warn-rwx-segments"),
)
REMOVED = re.compile(r"this handler can never be entered, and has been removed")

FOR_OTHER_TARGETS = (
    (r"(?im)^with Ada\.Text_IO;", ""),
    (r"(?is)package \w+ is\s+new Ada\.Text_IO\.\w+ ?\([^;]*;", ""),
    (r"(?is)pragma Linker_Options[^;]*;", ""),
    (r"(?i)pragma Unreserve_All_Interrupts;", ""),
    (r"(?i)Names\.SIGINT", "Names.TC1"),
)
"""In the suite's packages of implementation-defined values, which are the implementer's to fill in:
programs with input-output, objects of another language, an interrupt that a program can request."""


@dataclass(frozen=True)
class Memory:
    """Of the environment task, of allocators, and of each task for results of unknown size.

    The suite was written for workstations.
    """

    stack_bytes: int = 30_720
    heap_bytes: int = 12_288
    secondary_stack_kib: int = 8


class BuildError(Exception):
    """There is no image; `reasons` are what the tools said, each once."""

    def __init__(self, step: str, reasons: list[str]) -> None:
        super().__init__(f"{step}: {'; '.join(reasons)}")
        self.step = step
        self.reasons = reasons


@dataclass(frozen=True)
class Image:
    """An image that can run; `removed_handlers` of its sources can never be entered."""

    elf: Path
    removed_handlers: int


def _run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["nice", "-n", "5", *command], cwd=folder, capture_output=True, text=True,
        encoding="latin-1", timeout=300,
    )  # fmt: skip


def reasons_of(text: str) -> list[str]:
    """What made the compiler refuse: restrictions and absent units by name, else its words."""
    found: dict[str, None] = {}
    for line in text.splitlines():
        message = re.sub(r"^\S+?:\d+(:\d+)?: (error: )?", "", line)
        if match := re.search(r'violation of restriction "?([\w ."=>]+?)"?( at|$)', message):
            found[f"restriction {match.group(1)}"] = None
        elif match := re.search(r'file "([\w-]+)\.ad[sb]" not found', message):
            found[f"absent unit {match.group(1)}"] = None
        elif match := re.search(r'"?([\w.]+)"? is not a predefined library unit', message):
            found[f"absent unit {match.group(1)}"] = None
        elif match := re.search(r'entity "?([\w.]+)"? not (?:available|defined)', message):
            found[f"absent entity {match.group(1)}"] = None
        elif match := re.search(r"(construct not allowed in (?:configurable|no) run-?time mode)",
                                message):  # fmt: skip
            found[match.group(1)] = None
    if not found:
        errors = [x for x in text.splitlines() if re.match(r"\S+:\d+:\d+: (?!warning)", x)]
        for line in errors[:2] or text.strip().splitlines()[-2:]:
            found[re.sub(r"^\S+?:\d+(:\d+)?: (error: )?", "", line)] = None
    return list(found)


class Builder:
    """Builds tests in a work folder with one run-time."""

    def __init__(self, suite: Suite, rts: Path, work: Path, memory: Memory | None = None) -> None:
        self.memory = memory or Memory()
        self.suite = suite
        self.rts = rts
        self.work = work
        self.shared = work / "shared"

    def prepare(self) -> None:
        """Chop and compile what all tests share. What the run-time does not admit is left out."""
        shutil.rmtree(self.shared, ignore_errors=True)
        self.shared.mkdir(parents=True)
        files = [self.suite.support / "report.a", self.suite.support / "version.a"]
        self._chop([*files, *self.suite.shared_files()], self.shared)
        for stray in self.shared.glob("report*.adb"):
            stray.unlink()
        for own in (HERE / "support").glob("*.adb"):
            shutil.copy(own, self.shared)
        for name in ("impdef.ads", "impdef-annex_c.ads"):
            text = (self.shared / name).read_text(encoding="latin-1")
            for pattern, by in FOR_OTHER_TARGETS:
                text = re.sub(pattern, by, text)
            (self.shared / name).write_text(text, encoding="latin-1")
        for unit in ("report", "impdef", "tctouch"):
            self._compile(unit, self.shared, ())

    def _chop(self, files: list[Path], folder: Path) -> None:
        copies = []
        for path in files:
            copy = folder / f"{path.name}.chop"
            copy.write_text(self.suite.text(path), encoding="latin-1")
            copies.append(copy.name)
        result = _run([f"{PREFIX}gnatchop-12", "-q", "-c", "-w", *copies], folder)
        for name in copies:
            (folder / name).unlink()
        if result.returncode != 0:
            raise BuildError("chop", reasons_of(result.stderr + result.stdout))

    def _compile(self, main: str, folder: Path, switches: tuple[str, ...]) -> str:
        command = [f"{PREFIX}gnatmake-12", "-q", "-c", "-k", f"--RTS={self.rts}"]
        command += [f"-aI{self.shared}", f"-aO{self.shared}", "-gnatwA", "-gnatw.x", *switches]
        source = f"{main}.adb" if (folder / f"{main}.adb").exists() else f"{main}.ads"
        result = _run([*command, *MACHINE, source], folder)
        text = result.stderr + result.stdout
        if result.returncode != 0:
            raise BuildError("compile", reasons_of(text))
        return text

    def build(self, test: AcatsTest) -> Image:
        """The image of a test. Raises BuildError."""
        folder = self.work / test.name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self._chop(list(test.files), folder)
        main = test.main(folder)
        if main is None:
            raise BuildError("chop", ["no main procedure"])
        messages = self._compile(main, folder, test.switches)
        bind = [
            f"{PREFIX}gnatbind-12",
            f"--RTS={self.rts}",
            f"-D{self.memory.secondary_stack_kib}k",
        ]
        bind += ["-static", f"-aO{self.shared}", f"{main}.ali"]
        result = _run(bind, folder)
        if result.returncode != 0:
            raise BuildError("bind", reasons_of(result.stderr + result.stdout))
        elf = self._link(main, self._foreign(test, folder), folder)
        return Image(elf, len(REMOVED.findall(messages)))

    def _foreign(self, test: AcatsTest, folder: Path) -> list[str]:
        """Objects of the test's files in C."""
        objects = []
        for path in test.foreign:
            objects.append(f"{path.stem}.o")
            command = [f"{PREFIX}gcc-12", "-c", "-ffreestanding", *MACHINE, "-o", objects[-1]]
            result = _run([*command, str(path)], folder)
            if result.returncode != 0:
                raise BuildError("compile", reasons_of(result.stderr))
        return objects

    def _link(self, main: str, foreign: list[str], folder: Path) -> Path:
        binder = f"b~{main}.adb"
        compiler = [f"{PREFIX}gcc-12", "-c", "-gnatA", "-gnatws", f"--RTS={self.rts}", *MACHINE]
        result = _run([*compiler, f"-I{self.shared}", binder], folder)
        if result.returncode != 0:
            raise BuildError("bind", reasons_of(result.stderr))
        lines = (folder / binder).read_text(encoding="latin-1").splitlines()
        objects = [x[5:].strip() for x in lines if re.match(r"   --   \S+\.o$", x)]
        own = [x for x in objects if not x.startswith(str(self.rts))]
        elf = folder / f"{main}.elf"
        command = [*LINK, f"-L{self.rts}/adalib", "-Tflash.ld", "-o", str(elf)]
        command += [f"-Wl,--defsym=ravenbrick_environment_stack_size={self.memory.stack_bytes}"]
        command += [f"-Wl,--defsym=ravenbrick_heap_size={self.memory.heap_bytes}"]
        command += [f"b~{main}.o", *own, *foreign, "-lgnat", "-lm", "-lgnat", "-lgcc"]
        result = _run(command, folder)
        if result.returncode == 0:
            return elf
        undefined = re.findall(r"undefined reference to `(\S+)'", result.stderr)
        if undefined:
            raise BuildError("link", [f"undefined {name}" for name in sorted(set(undefined))])
        raise BuildError("link", result.stderr.strip().splitlines()[-3:-1])
