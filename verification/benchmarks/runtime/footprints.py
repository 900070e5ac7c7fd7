# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of small programs, of what each feature adds, and of each object of the language.

`python -m verification.benchmarks.runtime.footprints` writes docs/reference/footprint.md. Text is
all code and
constants of the image, start-up and the compiler's helpers included; data are initialised and zero
variables with the tasks' stacks, without the low memory that every image has (vectors, kernel's
state, stacks of handlers and the environment task).
"""

from __future__ import annotations

import re
import struct
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from elftools.elf.elffile import ELFFile

from verification.benchmarks.runtime.measure import image_of
from verification.support.bricks.runtime_programs import build
from verification.support.paths import ROOT

__all__ = ["PAGE", "footprints", "linked_bytes", "object_bytes", "page"]

PAGE = ROOT / "docs" / "reference" / "footprint.md"
STACK_BYTES = 512
STACKS_BYTES = {"hello": STACK_BYTES, "two_tasks": 2 * STACK_BYTES}
TITLES = {"hello": "hello-task", "two_tasks": "two tasks"}
LAYOUT = "ravenbrick_thread_layout"

# Units of each feature, as the linker's map names their objects
FEATURES = {
    "start, clocks, vectors, interrupt entry, last chance": (
        *("start", "board", "interrupt", "failure", "ravenbrick-board", "ravenbrick-failures"),
        *("switch", "calls"),
    ),
    "tasks and dispatching": ("ravenbrick-threads", "s-tarest", "s-taskin", "state"),
    "protected procedures and functions": ("s-taprob",),
    "entries": ("s-tposen",),
    "clock and `delay until`": (
        *("ravenbrick-clock", "ravenbrick-alarm", "ravenbrick-delays", "a-retide", "a-reatim"),
    ),
    "interrupt handlers": ("ravenbrick-interrupts", "s-interr"),
    "suspension objects": ("a-sytaco",),
    "timing events": ("a-rttiev", "ravenbrick-delays-events", "a-tags", "memory"),
    "`Yield`": ("a-dispat",),
    "task identification": ("a-taside",),
    "fall-back handler at termination": ("a-taster", "a-except"),
    "secondary stack": ("s-secsta",),
}
JORVIK = {
    "Jorvik: entries with queues": (*("s-tpobop", "s-tpoben", "ravenbrick-entry_queues"),),
    "Jorvik: relative delay": ("s-reldel",),
    "Jorvik: `Ada.Calendar`": ("a-calend", "a-caldel"),
}
TIMED = {
    "execution-time clocks": ("a-exetim", "a-extiin", "ravenbrick-execution_times", "accounting"),
}

# Objects of the program `service_sizes`; what the program itself keeps in them, in bytes
OBJECTS = {
    "task, besides its stack": ("service_uses__cyclic", STACK_BYTES),
    "protected object": ("service_uses__plain", 4),
    "protected object with an entry": ("service_uses__guarded", 4),
    "suspension object": ("service_uses__flag", 0),
    "timing event": ("service_uses__event", 0),
}

KEPT = re.compile(
    r"^ \.(text|rodata|vectors|data|bss)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S+)", re.MULTILINE
)
LIBRARY = re.compile(r"(?:/adalib/|/libgcc\.a\()(?:libgnat\.a\()?([^/()]+)\.o\)?$")


def _sections(elf: Path) -> dict[str, int]:
    """Sizes of the sections as the linker script names them."""
    with elf.open("rb") as file:
        return {section.name: section["sh_size"] for section in ELFFile(file).iter_sections()}


def _control_block(elf: Path) -> int:
    """The size that the image states."""
    with elf.open("rb") as file:
        image = ELFFile(file)
        (symbol,) = image.get_section_by_name(".symtab").get_symbol_by_name(LAYOUT)
        text = image.get_section_by_name(".text")
        assert text is not None
        offset = symbol["st_value"] - text["sh_addr"]
        _, size = struct.unpack_from("<II", text.data(), offset)
    return int(size)


def _linked(elf: Path) -> dict[str, Counter[str]]:
    """Bytes of text, data and bss of each unit of the library that a program's image keeps."""
    kept = elf.with_suffix(".map").read_text().split("Linker script and memory map", 1)[1]
    units: dict[str, Counter[str]] = {}
    for kind, size, file in KEPT.findall(kept):
        if match := LIBRARY.search(file):
            sort = kind if kind in {"data", "bss"} else "text"
            units.setdefault(match[1], Counter())[sort] += int(size, 16)
    return units


def linked_bytes(elf: Path) -> int:
    """Code, constants and initial values that the image has of the library and of libgcc."""
    return sum(unit["text"] + unit["data"] for unit in _linked(elf).values())


def _of(units: dict[str, Counter[str]], names: tuple[str, ...], *kinds: str) -> int:
    return sum(units[name][kind] for name in names if name in units for kind in kinds)


def feature_bytes() -> Iterator[tuple[str, int, int | None, int]]:
    """Feature, ARM text, Thumb text, data, from programs that use it."""
    arm, thumb = (_linked(image_of("service_sizes", "ram", code)) for code in ("arm", "thumb"))
    for title, names in FEATURES.items():
        text = (_of(arm, names, "text"), _of(thumb, names, "text"))
        yield title, *text, _of(arm, names, "data", "bss")
    for features, program, runtime in (
        (JORVIK, "jorvik_queues", "jorvik"),
        (TIMED, "execution_times", "timed"),
    ):
        units = _linked(build(program, runtime=runtime))
        for title, names in features.items():
            yield title, _of(units, names, "text"), None, _of(units, names, "data", "bss")


def object_bytes() -> Iterator[tuple[str, int]]:
    """What an object of the language takes of the RAM."""
    with image_of("service_sizes", "ram", "arm").open("rb") as file:
        table = ELFFile(file).get_section_by_name(".symtab")
        for title, (symbol, own) in OBJECTS.items():
            (entry,) = table.get_symbol_by_name(symbol)
            yield title, entry["st_size"] - own


def footprints() -> Iterator[tuple[str, int]]:
    """Figure and bytes."""
    for program, title in TITLES.items():
        for code in ("arm", "thumb"):
            sizes = _sections(image_of(program, "ram", code))
            yield f"{title}, {code} text", sizes[".text"]
            if code == "arm":
                data = sizes.get(".data", 0) + sizes.get(".bss", 0)
                yield f"{title}, data without stacks", data - STACKS_BYTES[program]
    for code in ("arm", "thumb"):
        elf = build("footprint", code=code, runtime=code)
        yield f"kernel and Ada layer with all its services, {code} text", linked_bytes(elf)
    yield "control block", _control_block(image_of("hello", "ram", "arm"))


def page() -> str:
    """The page's text."""
    lines = [
        "# Footprint of the run-time",
        "",
        "Generated by `python -m verification.benchmarks.runtime.footprints` from the linker maps",
        "of programs that use the feature; an image does not contain unused features. Helper",
        "functions of the compiler (such as 64-bit division) are not counted. The",
        "[benchmarks](../../verification/benchmarks/results.md) have the footprints of whole",
        "programs.",
        "",
        "| Feature | Text, ARM | Text, Thumb | Data |",
        "|---|---:|---:|---:|",
    ]
    for title, arm, thumb, data in feature_bytes():
        lines.append(f"| {title} | {arm} | {'' if thumb is None else thumb} | {data} |")
    lines += ["", "| Object | RAM in bytes |", "|---|---:|"]
    lines += [f"| {title} | {size} |" for title, size in object_bytes()]
    return "\n".join(lines).replace("|  |", "| |") + "\n"


def main() -> int:
    """Write the page."""
    PAGE.write_text(page())
    return 0


if __name__ == "__main__":
    sys.exit(main())
