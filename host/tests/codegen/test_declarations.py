# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Sizes and layouts that are read of C headers, against the compiler for the brick."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from verification.support.codegen.c_build import run
from verification.support.needed_tools import NEEDS_TOOLCHAIN

from ravenbrick.codegen.c.declarations import NUMBERS, read_declarations
from ravenbrick.codegen.c.rtwtypes import RTWTYPES
from ravenbrick.errors import DesignError

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
LISTS = """\
typedef double Real, *Place;
struct Lists_ {
  double P, I; /* gains, V */
  char flag, rows[3], *text, table[2][3];
  short low, /* of the range, mm */
    high; /* end, m */
  struct { char odd; double wide; } pair, pairs[2];
  Real *first, last;
  Place places[2];
  char end;
};
extern struct Lists_ left, *right;
float start = 1.0F, lines[2] = {1.0F, 2.0F}, stop;
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


def placed_as_compiled(folder: Path, text: str, name: str, paths: list[str]) -> None:
    """The structure has these numbers and pointers, where the compiler puts them."""
    found = read_declarations({"header.h": text})
    structure = found.structure(name)
    assert structure is not None
    leaves = {leaf.path: leaf.offset_bytes for leaf in found.leaves(structure)}
    assert list(leaves) == paths
    checks = [asserted(f"offsetof(struct {name}, {p}) == {at}") for p, at in leaves.items()]
    size, alignment = found.extent(structure)
    checks += [asserted(f"sizeof(struct {name}) == {size}")]
    checks += [asserted(f"_Alignof(struct {name}) == {alignment}")]
    compiled(folder, text, *checks)


def test_every_name_of_a_number_has_its_size(tmp_path: Path) -> None:
    compiled(tmp_path, *(asserted(f"sizeof({name}) == {size}") for name, size in NUMBERS.items()))


def test_fields_lie_where_the_compiler_puts_them(tmp_path: Path) -> None:
    """Nested and nameless structures, a union, arrays, pointers, and what is left at the end."""
    placed_as_compiled(tmp_path, HEADER, "Whole_", [
        "on", "counts", "gains.first", "gains.P", "gains.I", "inner.odd", "inner.wide", "shared",
        "both.large", "both.small", "last", "end",
    ])  # fmt: skip


def test_several_names_of_one_declaration_are_fields_and_variables_each(tmp_path: Path) -> None:
    """A pointer's star and an array's length belong to one name, a comment to those before it."""
    placed_as_compiled(tmp_path, LISTS, "Lists_", [
        "P", "I", "flag", "rows", "text", "table", "low", "high", "pair.odd", "pair.wide",
        "first", "last", "places", "end",
    ])  # fmt: skip
    found = read_declarations({"lists.h": LISTS})
    lists = found.structure("Lists_")
    assert lists is not None
    assert [(m.name, m.pointer, m.count) for m in lists.members][2:6] == [
        ("flag", False, 1), ("rows", False, 3), ("text", True, 1), ("table", False, 6),
    ]  # fmt: skip
    about = {member.name: member.about for member in lists.members}
    assert (about["P"], about["I"]) == ("gains, V", "gains, V")
    assert (about["low"], about["high"]) == ("of the range, mm", "end, m")
    pointers = {name: (one.type_name, one.pointer) for name, one in found.variables.items()}
    assert pointers == {
        "left": ("Lists_", False), "right": ("Lists_", True),
        "start": ("float", False), "lines": ("float", True), "stop": ("float", False),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("double P, ;", "no name"),
        ("double P[2 * 3];", "must be a number, not 2 * 3"),
        ("double P[1, 2], I;", "must be a number, not 1 , 2"),
        ("double ,;", "no name"),
    ],
)
def test_a_list_that_is_none_is_refused(field: str, words: str) -> None:
    with pytest.raises(DesignError, match=re.escape(words)):
        read_declarations({"model.h": f"struct Gains_ {{ {field} }};"})


@pytest.mark.parametrize(
    "text", [",x;", "typedef ,x;", "double a,,b;", "double a = {1, ;", ", ,;", "[2] a;"]
)
def test_a_broken_list_of_variables_is_passed_over(text: str) -> None:
    assert read_declarations({"model.h": f"{text}\nextern float speed;"}).variables


def nested(levels: int, fields: str) -> str:
    """Structures T0, T1, ..., each with the fields of the structure before."""
    each = [fields.replace("T", f"T{level}") for level in range(levels)]
    chain = [f"typedef struct {{ {each[level]} }} T{level + 1};" for level in range(levels)]
    return "\n".join(["typedef struct { } T0;", *chain])


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("typedef struct { char end; Own own; } Own;", "Own", "field 'own' of type Own"),
        ("typedef struct { B b; } A;\ntypedef struct { A a[2]; } B;", "A", "holds itself"),
        (nested(1_000, "T in;"), "T1000", "lie 100 deep"),
        (nested(40, "T left; T right;"), "T40", "more than 10000 fields"),
        (nested(40, "T left[2]; T right[2];"), "T40", "more than 10000 fields"),
    ],
    ids=["itself", "each the other", "1,000 deep", "a tree of 2 to the 40", "arrays"],
)
def test_structures_without_end_are_refused_soon(text: str, name: str, words: str) -> None:
    found = read_declarations({"model.h": text})
    structure = found.structure(name)
    assert structure is not None
    with pytest.raises(DesignError, match=re.escape(words)):
        found.leaves(structure)


def test_structures_without_names_may_lie_so_deep_only() -> None:
    text = f"struct A {{ {'struct { ' * 3_000} int a; {'} b; ' * 3_000} }};"
    with pytest.raises(DesignError, match=r"model\.h: structures lie 100 deep in each other"):
        read_declarations({"model.h": text})


def test_a_structure_may_point_to_itself() -> None:
    found = read_declarations({"model.h": "struct Node { struct Node *next; double value; };"})
    structure = found.structure("Node")
    assert structure is not None
    assert [leaf.offset_bytes for leaf in found.leaves(structure)] == [0, 8]
