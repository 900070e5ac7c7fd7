# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sizes and layouts that are read of C headers, against the compiler for the brick."""

from __future__ import annotations

from pathlib import Path

from verification.support.codegen.c_build import run
from verification.support.needed_tools import NEEDS_TOOLCHAIN

from ravenbrick.codegen.c.declarations import NUMBERS, read_declarations
from ravenbrick.codegen.c.rtwtypes import RTWTYPES

pytestmark = NEEDS_TOOLCHAIN
HEADER = """\
typedef struct { char first; double P; double I; } Gains;
struct Whole_ {
  boolean_T on;
  int16_T counts[3];
  Gains gains;
  struct { char odd; unsigned long wide; } inner;
  const Gains *shared;
  union { int64_T large; uint16_T small; } both;
  long last;
  char end;
};
"""


def compiled(folder: Path, *lines: str) -> None:
    """The compiler for the brick agrees with every assertion."""
    (folder / "rtwtypes.h").write_text(RTWTYPES)
    heads = ["<stdint.h>", "<stdbool.h>", "<stddef.h>", '"rtwtypes.h"']
    text = "\n".join([*(f"#include {head}" for head in heads), *lines])
    (folder / "sizes.c").write_text(text + "\n")
    run("arm-none-eabi-gcc", "-std=c11", "-ffreestanding", "-fsyntax-only", folder / "sizes.c")


def asserted(condition: str) -> str:
    """What the compiler refuses if it is wrong."""
    return f'_Static_assert({condition}, "{condition}");'


def test_every_name_of_a_number_has_its_size(tmp_path: Path) -> None:
    compiled(tmp_path, *(asserted(f"sizeof({name}) == {size}") for name, size in NUMBERS.items()))


def test_fields_lie_where_the_compiler_puts_them(tmp_path: Path) -> None:
    """Nested and nameless structures, a union, arrays, pointers, and what is left at the end."""
    found = read_declarations({"whole.h": HEADER})
    whole = found.structure("Whole_")
    assert whole is not None
    leaves = {leaf.path: leaf.offset_bytes for leaf in found.leaves(whole)}
    assert list(leaves) == [
        "on", "counts", "gains.first", "gains.P", "gains.I", "inner.odd", "inner.wide", "shared",
        "both.large", "both.small", "last", "end",
    ]  # fmt: skip
    checks = [asserted(f"offsetof(struct Whole_, {p}) == {at}") for p, at in leaves.items()]
    size, alignment = found.extent(whole)
    checks += [asserted(f"sizeof(struct Whole_) == {size}")]
    checks += [asserted(f"_Alignof(struct Whole_) == {alignment}")]
    compiled(tmp_path, HEADER, *checks)
