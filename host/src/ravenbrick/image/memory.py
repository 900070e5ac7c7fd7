# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How an image uses the brick's memory: from the ELF and the link map."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import REGIONS, ElfImage
from ravenbrick.project.robot import Robot

__all__ = ["MemoryReport", "TaskStack", "memory_report"]

_PLACED = re.compile(r"^ (\.\S+)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) (\S.*)$", re.MULTILINE)
_KINDS = (
    ("text", (".text", ".rodata", ".glue_7", ".glue_7t", ".vectors", ".init")),
    ("data", (".data",)),
    ("bss", (".bss", "COMMON")),
)


@dataclass(frozen=True)
class TaskStack:
    """A task's stack, bytes; None for what is not known.

    `declared_bytes`: robot.toml. `object_bytes`: stack and control block, from the link.
    `storage_size_bytes`, `used_bytes`: Storage_Size and high-water mark, from a run.
    """

    name: str
    declared_bytes: int | None
    object_bytes: int | None
    storage_size_bytes: int | None
    used_bytes: int | None


@dataclass(frozen=True)
class MemoryReport:
    """Sizes in bytes; `parts` maps each part of the program to its text, data and bss.

    `used` is what lies in the region of `available` bytes: kernel state of a RAM image lies below
    it, where the boot monitor's own variables were.
    """

    image: str
    kind: str
    text: int
    data: int
    bss: int
    used: int
    available: int
    tasks: tuple[TaskStack, ...]
    parts: dict[str, dict[str, int]] = field(default_factory=dict)

    def write(self, path: Path) -> None:
        """Write the report as JSON."""
        atomic_write(path, json.dumps(self.as_json(), indent=1) + "\n")

    def as_json(self) -> dict[str, Any]:
        """The report with plain types."""
        return asdict(self)


def _part(file: str, generated: frozenset[str]) -> str:
    """The part of the program that an object file belongs to; `generated`: stems of C files."""
    member = re.search(r"([^/(]+)\.o\)?$", file)
    if member and member.group(1) in generated:
        return "generated C"
    for name in ("runtime", "drivers"):
        if re.search(rf"(^|[/_]){name}[/_]|lib{name}", file):
            return "run-time" if name == "runtime" else name
    return "compiler's library" if "libgcc" in file else "application"


def _section_kind(name: str) -> str | None:
    for kind, prefixes in _KINDS:
        if any(name == prefix or name.startswith(f"{prefix}.") for prefix in prefixes):
            return kind
    return None


def _parts(map_file: Path, generated: frozenset[str]) -> dict[str, dict[str, int]]:
    text = map_file.read_text("utf-8", "replace")
    _head, _marker, body = text.partition("Linker script and memory map")
    joined = re.sub(r"^( \.\S+)\n\s+(?=0x)", r"\1 ", body, flags=re.MULTILINE)
    sizes: defaultdict[str, dict[str, int]] = defaultdict(
        lambda: dict.fromkeys(("text", "data", "bss"), 0)
    )
    for name, address, size, file in _PLACED.findall(joined):
        kind = _section_kind(name)
        if kind and int(address, 16):
            sizes[_part(file, generated)][kind] += int(size, 16)
    return {name: sizes[name] for name in sorted(sizes)}


def _linked_tasks(image: ElfImage, robot: Robot) -> tuple[TaskStack, ...]:
    objects = {name: symbol.size for name, symbol in image.task_objects().items()}
    declared = {task.name.lower(): task.stack_bytes for task in robot.tasks}
    return tuple(
        TaskStack(name, declared.get(name), objects.get(name), None, None)
        for name in dict.fromkeys([*declared, *objects])
    )


def memory_report(image: ElfImage, robot: Robot) -> MemoryReport:
    """Report of an image; raises `ImageFileError` when it does not fit."""
    text, data, bss = (image.size_of(kind) for kind in ("text", "data", "bss"))
    region = REGIONS[image.kind]
    used = sum(
        section.size
        for section in image.sections
        if (image.kind == "ram" or section.kind != "bss")
        and (image.kind == "flash" or region.begin <= section.address < region.end)
    )
    if used > region.size:
        raise ImageFileError(
            f"{image.path}: takes {used} bytes, the {region.name} has {region.size}; shorten "
            "stacks or code, or build a flash image with '--image flash'"
        )
    map_file = image.path.with_suffix(".map")
    generated = frozenset(file.stem for file in (robot.directory / "generated").glob("*.c"))
    return MemoryReport(
        image=image.path.name,
        kind=image.kind,
        text=text,
        data=data,
        bss=bss,
        used=used,
        available=region.size,
        tasks=_linked_tasks(image, robot),
        parts=_parts(map_file, generated) if map_file.is_file() else {},
    )
