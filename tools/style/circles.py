# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Rust files that know each other, directly or over others, without a comment that says why."""

from __future__ import annotations

import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

__all__ = ["circle_complaints"]

Complaint = tuple[Path, int, str]
Module = tuple[str, ...]
# A file with these words in a comment may know files that know it.
REASON = "knows the other"
USE = re.compile(r"^\s*(?:pub(?:\(\w+\))? )?use ((?:crate|super|self)::[^;]+);", re.MULTILINE)
# An item for tests only; a module with its body is the file's last.
TEST = re.compile(r"#\[cfg\(test\)\]\s+(?:[^;{]*;|mod \w+ \{.*)", re.DOTALL)
PATH = re.compile(r"\b(?:crate|super)(?:::\w+)+")


def _paths(tree: str) -> Iterator[str]:
    """`a::{b, c::{d}}` as `a::b` and `a::c::d`."""
    head, brace, rest = tree.partition("{")
    if not brace:
        yield tree.split(" as ")[0]
        return
    depth, part = 0, ""
    for letter in rest.rpartition("}")[0] + ",":
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter != "," or depth:
            part += letter
            continue
        yield from (head + path for path in _paths(part) if part.strip())
        part = ""


def _modules(source: Path) -> dict[Module, Path]:
    """The files of a crate by the modules that they are, without unit tests."""
    found = {}
    for path in sorted(source.rglob("*.rs")):
        *folders, name = path.relative_to(source).with_suffix("").parts
        if "tests" not in (*folders, name):
            found[(*folders, *({name} - {"lib", "main", "mod"}))] = path
    return found


def _known(module: Module, code: str) -> Iterator[Module]:
    """What a file names: modules of its crate, with the names of their items behind them."""
    uses = (re.sub(r"\s+", " ", use) for use in USE.findall(code))
    for path in [*(path for use in uses for path in _paths(use)), *PATH.findall(code)]:
        first, *words = path.replace(" ", "").split("::")
        base = {"crate": (), "self": module, "super": module[:-1]}[first]
        while words and words[0] == "super":
            base, words = base[:-1], words[1:]
        yield (*base, *words)


def circle_complaints(source: Path) -> Iterator[Complaint]:
    """A circle of the files below a crate's `src`, if there is one."""
    modules = _modules(source)
    graph: dict[Module, set[Module]] = {}
    for module, path in modules.items():
        text = path.read_text("utf-8")
        code = re.sub(r"//.*", "", TEST.sub("", text))
        known = set()
        for name in _known(module, code):
            while name and name not in modules:
                name = name[:-1]
            known.add(name)
        graph[module] = set() if REASON in text else known - {(), module}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        circle = [modules[module] for module in reversed(error.args[1])]
        names = " → ".join(str(path.relative_to(source)) for path in circle)
        yield circle[0], 1, f"a circle of files: {names}; cut it, or say why each {REASON}"
