# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which part may know which: crates, bindings and rooms by borders.toml, and tests."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

from tools.style.circles import circle_complaints

__all__ = ["border_complaints"]

Complaint = tuple[Path, int, str]
Borders = dict[str, list[str]]
TESTS = ("host/tests", "runtime/tests", "drivers/tests", "examples", "virtual-brick/bindings")


def _order(file: Path, title: str, borders: Borders) -> Iterator[Complaint]:
    """A part may know earlier parts only, so that there is no circle."""
    earlier: set[str] = set()
    for part, allowed in borders.items():
        for name in sorted(set(allowed) - earlier):
            yield file, 1, f"[{title}] {part}: '{name}' is not an earlier part"
        earlier.add(part)


def _crates(workspace: Path, folder: str, borders: Borders, crates: Borders) -> Iterator[Complaint]:
    for manifest in sorted((workspace / folder).glob("*/Cargo.toml")):
        crate = manifest.parent.name
        if crate not in borders:
            yield manifest, 1, f"the crate {crate} is not in tools/style/borders.toml"
            continue
        content = tomllib.loads(manifest.read_text())
        tables = [content, *content.get("target", {}).values()]
        known = {name for table in tables for name in table.get("dependencies", {})}
        for name in sorted(known & set(crates) - set(borders[crate])):
            yield manifest, 1, f"the crate {crate} must not know {name}"


def _imports(path: Path, package: str) -> Iterator[tuple[int, str]]:
    """Line and dotted name of each import of a package in a file, in functions too."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from ((node.lineno, name) for name in names if name.startswith(package))


def _rooms(package: Path, borders: Borders) -> Iterator[Complaint]:
    for folder in sorted(package.iterdir()):
        if not (folder / "__init__.py").is_file():
            continue
        room = folder.name
        if room not in borders:
            yield folder / "__init__.py", 1, f"'{room}' is not in tools/style/borders.toml"
            continue
        for path in sorted(folder.rglob("*.py")):
            for line, name in _imports(path, "ravenbrick."):
                other = name.split(".")[1]
                if other != room and other in borders and other not in borders[room]:
                    yield path, line, f"the room {room} must not know {other}"


def _tests(root: Path) -> Iterator[Complaint]:
    """Tests import helpers from verification/support, neither other tests nor campaigns."""
    for folder in (*TESTS, "verification"):
        for path in sorted((root / folder).rglob("*.py")):
            campaign = folder == "verification" and "support" not in path.parts
            for line, name in _imports(path, ""):
                parts = name.split(".")
                if any(part.startswith("test_") or part == "conftest" for part in parts):
                    yield path, line, f"{name}: a test must not be imported"
                elif parts[0] == "verification" and parts[1:2] != ["support"] and not campaign:
                    yield path, line, f"{name}: import helpers from verification.support only"


def border_complaints(root: Path) -> Iterator[Complaint]:
    """What crosses a border, file by file; `root` is the tree."""
    file = root / "tools" / "style" / "borders.toml"
    borders: dict[str, Borders] = tomllib.loads(file.read_text())
    crates = borders["crates"]
    yield from _order(file, "crates", crates)
    yield from _order(file, "rooms", borders["rooms"])
    for folder in ("crates", "bindings"):
        yield from _crates(root / "virtual-brick", folder, borders[folder], crates)
        for source in sorted((root / "virtual-brick" / folder).glob("*/src")):
            yield from circle_complaints(source)
    yield from _tests(root)
    yield from _rooms(root / "host" / "src" / "ravenbrick", borders["rooms"])
