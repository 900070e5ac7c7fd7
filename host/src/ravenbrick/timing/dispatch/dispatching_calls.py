# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Targets of the dispatching calls of Ada, from the dispatch tables in the image.

A dispatching call takes a word of a table, whose address (the tag) is in the object. The compiler
may join two such calls of different types in one instruction, which then has the line of one of
them. So a line does not tell the targets: they are the words with this number in the tables of all
types whose operations the unit refers to. GNAT's .ali files tell which these are, that the unit
sees no access-to-subprogram type, for which the code would be the same, and that no table is built
at run time.
"""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile

from ravenbrick.timing.bounds import ExecutionTimeError
from ravenbrick.timing.dispatch.ada_library import AdaLibrary, Place, read_library
from ravenbrick.timing.dispatch.dispatch_code import DispatchCode
from ravenbrick.timing.dispatch.dispatch_tables import DispatchTables
from ravenbrick.timing.facts.facts import annotations_of

__all__ = ["DISPATCH_TABLES", "DispatchingCalls"]

DISPATCH_TABLES = "dispatch tables"
ACCESS = "NO_ACCESS_SUBPROGRAMS"
CALLS = "NO_DISPATCHING_CALLS"
COMPILER = "GNAT Lib v12"
SOURCES = (".adb", ".ads")
STATIC = "STATIC_DISPATCH_TABLES"
NO_REFERENCES = "-gnatx"
LAST_CHANCE = "__gnat_last_chance_handler"
UNSEEN = {"ada.iterator_interfaces", "ada.tags.generic_dispatching_constructor"}
UNKNOWN = re.compile(r"(0x[0-9a-f]{8}).*: the target of this branch is not known")


Answer = TypeVar("Answer")


class NotDerivedError(Exception):
    """Why the targets of a unit's calls are not known."""


class DispatchingCalls:
    """What is known about the calls of an ELF file, and why not more."""

    def __init__(self, path: Path, content: bytes) -> None:
        self._path = path
        self._libraries: dict[Path, AdaLibrary | None] = {}
        self._elf = ELFFile(io.BytesIO(content))
        self._units: dict[int | None, Path] = {}
        self._ranges = None
        try:
            dwarf = self._elf.get_dwarf_info()
            self._ranges = dwarf.get_aranges()
            for unit in dwarf.iter_CUs():
                found = unit.get_top_DIE().attributes
                name, home = (found[key].value.decode() for key in ("DW_AT_name", "DW_AT_comp_dir"))
                if name.endswith(SOURCES):
                    self._units[unit.cu_offset] = Path(home) / Path(name).with_suffix(".ali").name
        except (ELFError, ValueError, KeyError, AttributeError):
            self._units = {}

    def _unit(self, address: int) -> int | None:
        """The compilation unit of code, by its offset in the debug information."""
        return self._ranges.cu_offset_at_addr(address & ~1) if self._ranges else None

    @cached_property
    def _folders(self) -> list[Path]:
        """Where the program's own units were compiled; those of the run-time are gone."""
        return sorted({path.parent for path in self._units.values() if path.is_file()})

    @cached_property
    def _run_time(self) -> list[Path]:
        """The folder of the run-time's library files."""
        paths = [path for path in self._units.values() if path.parent in self._folders]
        found = {library.run_time for library in map(self._read, paths) if library}
        return sorted(path for path in found if path is not None)

    def _read(self, path: Path) -> AdaLibrary | None:
        if path not in self._libraries:
            try:
                self._libraries[path] = read_library(path) if path.is_file() else None
            except (ValueError, IndexError) as error:
                raise NotDerivedError(f"{path} is damaged: {error}; build again") from None
        return self._libraries[path]

    def _own(self, paths: Sequence[Path]) -> AdaLibrary | None:
        """The first of these library files that is there; none for a unit of the run-time.

        Raises `NotDerivedError` when there is none, or it is not that of the compilation."""
        found = next(filter(None, map(self._read, paths)), None)
        if found is None:
            if any(self._read(folder / paths[0].name) for folder in self._run_time):
                return None
            raise NotDerivedError(f"{paths[0]} is missing; build the image again")
        if found.path.stat().st_mtime > self._path.stat().st_mtime:
            raise NotDerivedError(f"{found.path} is newer than the image; build the image again")
        if found.compiler != COMPILER:
            raise NotDerivedError(
                f"{found.path} says '{found.compiler}', and tables are known of '{COMPILER}'"
            )
        return found

    @cached_property
    def _all(self) -> dict[int | None, AdaLibrary]:
        """All units with code. Raises `NotDerivedError` if not all types have their tables here."""
        compiled = {path.stem for path in self._units.values()}
        for name in (row.name for row in self._symbols("STT_FILE")):
            if name.endswith(SOURCES) and Path(name).stem not in compiled:
                self._check_generic(name)
        found = {offset: self._own([path]) for offset, path in self._units.items()}
        own = {offset: library for offset, library in found.items() if library is not None}
        for library in own.values():
            if STATIC in library.violated:
                raise NotDerivedError(
                    f"{library.path.stem} extends a type in a subprogram, a task or a block, "
                    "whose dispatch table is built at run time"
                )
        return own

    def _check_generic(self, name: str) -> None:
        """Raise `NotDerivedError` for a unit without debug information, unless it has no code."""
        paths = [folder / Path(name).with_suffix(".ali") for folder in self._folders]
        found = next(filter(None, map(self._read, paths)), None)
        if found is None or not found.is_generic:
            raise NotDerivedError(f"{name} was compiled without debug information")
        self._own([found.path])

    def _needed(self, library: AdaLibrary) -> list[AdaLibrary]:
        """A unit and the program's own units on which it depends. Raises `NotDerivedError` if a
        call in its code may be no dispatching one."""
        if CALLS not in library.violated:
            raise NotDerivedError(f"{library.path.stem} has no dispatching call")
        found = []
        for unit, file in library.needed.items():
            other = self._own(self._paths(library, file))
            if other is not None:  # what only the run-time's own units name is out of reach
                self._check_types(other, unit)
                found.append(other)
        return found

    def _types(self, library: AdaLibrary) -> frozenset[str] | None:
        """Names of types, one of which has the operation of any dispatching call in the code of a
        unit; None if that may be any type. Raises as `_needed`.

        A call of a function may be marked as static and dispatch all the same, by the tag of
        another operand; a call of a procedure may not. Iterators and constructors are called
        without a reference.
        """
        units = self._needed(library)
        owners: dict[Place, frozenset[str]] = {}
        for unit in units:
            owners |= {at: owners.get(at, frozenset()) | types for at, types in unit.types.items()}
        found: set[str] = set()
        for unit in units:
            for reference in (r for r in unit.references if r.file in library.files):
                if reference.letter in ("Rri" if reference.kind in "Ux" else "Rris"):
                    types = owners.get(reference.entity, frozenset())
                    if not types and reference.letter == "R":
                        return None
                    found |= types
        # The tables have other letters for names beyond ASCII.
        plain = all(name.isascii() for name in found)
        return frozenset(found) if plain and not UNSEEN & library.needed.keys() else None

    def _paths(self, library: AdaLibrary, file: str) -> list[Path]:
        name = Path(file).with_suffix(".ali")
        return [folder / name for folder in (library.path.parent, *self._folders)]

    def _check_types(self, library: AdaLibrary, unit: str) -> None:
        """Raise `NotDerivedError` if a unit declares an access-to-subprogram type, or may name one
        of the run-time."""
        words = "an access-to-subprogram type, a call through which looks like a dispatching one"
        if ACCESS in library.violated:
            raise NotDerivedError(f"{unit} declares {words}")
        if NO_REFERENCES in library.switches:
            raise NotDerivedError(f"{unit} was compiled with {NO_REFERENCES}")
        files = {reference.entity[0] for reference in library.references if reference.kind in "Pp"}
        for name, file in library.needed.items():
            if file in files and self._own(self._paths(library, file)) is None:
                found = (
                    self._read(folder / Path(file).with_suffix(".ali")) for folder in self._run_time
                )
                if any(other and ACCESS in other.violated for other in found):
                    raise NotDerivedError(f"{unit} names what {name} declares, perhaps {words}")

    def _symbols(self, kind: str) -> list[Any]:
        table: Any = self._elf.get_section_by_name(".symtab")
        rows = [] if table is None else table.iter_symbols()
        return [row for row in rows if row["st_info"]["type"] == kind]

    def _functions(self) -> list[tuple[str, int, int]]:
        """Functions with a name of their own, their addresses and sizes."""
        rows = self._symbols("STT_FUNC")
        count = Counter(row.name for row in rows)
        found = [(row.name, row["st_value"], row["st_size"]) for row in rows]
        return [row for row in found if count[row[0]] == 1]

    def _code(self, words: dict[int, int]) -> DispatchCode:
        """Instructions, which mapping symbols tell from data (ELF for Arm, 5.5.5)."""
        marks = {r["st_value"]: r.name[1] for r in self._symbols("STT_NOTYPE") if r.name[:1] == "$"}
        code, kind = set(), ""
        for address in sorted({*words, *marks}):
            kind = marks.get(address, kind)
            if kind == "a" and address in words:
                code.add(address)
        functions = self._symbols("STT_FUNC")
        endless = {row["st_value"] for row in functions if row.name == LAST_CHANCE}
        return DispatchCode(words, code, {row["st_value"] for row in functions}, endless)

    def facts(self) -> tuple[str, str]:
        """Targets of the calls that are known: a name and TOML."""
        rows: list[dict[str, object]] = []
        try:
            libraries = self._all
        except NotDerivedError:
            return DISPATCH_TABLES, ""
        tables = DispatchTables(self._elf)
        known: dict[int | None, frozenset[str] | None] = {}
        for offset, library in libraries.items():
            try:
                known[offset] = self._types(library)
            except NotDerivedError:
                continue
        functions = self._functions() if known else []
        names = {address: name for name, address, _ in functions}
        code = self._code(tables.words) if known else None
        for name, address, size in functions:
            unit = self._unit(address)
            if code is None or unit not in known or address & 1:
                continue
            for offset, slots in code.calls(address, size):
                words = (tables.operations(slot, known[unit]) for slot in sorted(slots))
                targets = set[int]().union(*words)
                if targets and all(target in names for target in targets):
                    row = {"symbol": name, "offset": offset, "reason": f"words {sorted(slots)}"}
                    rows.append(row | {"targets": sorted(names[target] for target in targets)})
        return DISPATCH_TABLES, annotations_of({"call": rows})

    def _reason(self, address: int) -> str | None:
        unit = self._unit(address)
        if unit not in self._units:
            return None
        try:
            if unit in self._all:
                self._needed(self._all[unit])
        except NotDerivedError as reason:
            return str(reason)
        return "the code does not show the number of the word that is taken from a dispatch table"

    def explain(self, error: ExecutionTimeError) -> None:
        """Add to a question about the targets of a call why they are not known."""
        place = UNKNOWN.search(str(error))
        reason = self._reason(int(place[1], 16)) if place else None
        if reason is not None:
            error.detail = "\n".join(
                filter(None, [error.detail, f"dispatch tables do not tell them: {reason}"])
            )

    def answer(self, ask: Callable[[Sequence[tuple[str, str]]], Answer]) -> Answer:
        """What `ask` finds under these facts. Its questions say why they do not tell a target."""
        try:
            return ask([self.facts()])
        except ExecutionTimeError as question:
            self.explain(question)
            raise
