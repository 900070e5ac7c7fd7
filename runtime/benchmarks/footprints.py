# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of small programs, of what each feature adds, and of a task's control block.

`python -m runtime.benchmarks.footprints` prints them. Text is all code and constants of the image,
start-up and the compiler's helpers included; data are initialised and zero variables with the
tasks' stacks, without the low memory that every image has (vectors, kernel's state, stacks of
handlers and the environment task).
"""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

from elftools.elf.elffile import ELFFile

from runtime.benchmarks.measure import image_of

__all__ = ["footprints"]

STACKS_BYTES = {"hello": 512, "two": 2 * 512}
TITLES = {"hello": "hello-task", "two": "two tasks"}
LAYOUT = "ravenbrick_thread_layout"


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
        offset = symbol["st_value"] - text["sh_addr"]
        _, size = struct.unpack_from("<II", text.data(), offset)
    return int(size)


def footprints() -> Iterator[tuple[str, int]]:
    """Figure and bytes."""
    for program, title in TITLES.items():
        for code in ("arm", "thumb"):
            sizes = _sections(image_of(program, "ram", code))
            yield f"{title}, {code} text", sizes[".text"]
            if code == "arm":
                data = sizes.get(".data", 0) + sizes.get(".bss", 0)
                yield f"{title}, data without stacks", data - STACKS_BYTES[program]
    yield "control block", _control_block(image_of("hello", "ram", "arm"))


def main() -> None:
    """Print all figures."""
    for figure, size in footprints():
        print(f"{figure}: {size} bytes")


if __name__ == "__main__":
    try:
        main()
    except subprocess.CalledProcessError as failure:
        raise SystemExit(f"a program could not be built: {failure}") from failure
