# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the suite's folder holds: tests by name with their files, shared packages, macros.

File names follow the user's guide of the suite (ACATS 4.2, section 4.3): the first seven characters
name the test, the eighth tells the files of a test apart.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from verification.outside import data_sets

__all__ = ["EXECUTED", "REJECTED", "AcatsTest", "Suite", "SuiteMissingError"]

SOURCES = {".a", ".ada", ".am", ".au", ".dep", ".tst"}
EXECUTED = (
    *("a", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "c9", "ca", "cb", "cc", "cd"),
    *("cxa", "cxb", "cxc", "cxd", "cxf", "cxg", "cxh", "d", "e"),
)
"""Chapters whose programs run to a verdict; files (ce), distribution (cxe) and obsolescent
rendering of input-output (cz) have no place on a brick."""
REJECTED = ("lxd",)
"""Chapter whose programs must be refused before they run."""


class SuiteMissingError(Exception):
    """The suite is not where it was said to be."""


@dataclass(frozen=True)
class AcatsTest:
    """One test: its name, chapter, files in Ada and in C, what the suite asks the compiler for."""

    name: str
    chapter: str
    files: tuple[Path, ...]
    switches: tuple[str, ...] = ()
    foreign: tuple[Path, ...] = ()

    def main(self, folder: Path) -> str | None:
        """Unit of the main procedure among the chopped sources in `folder`."""
        special = {"c3a1003": "c3a10032", "c3a1004": "c3a10042", "ca11023": "ca110232"}
        if self.name in special:
            return special[self.name]
        found = [
            *sorted(folder.glob(f"{self.name}?.adb")),
            *sorted(folder.glob(f"{self.name}*m.adb")),
            *folder.glob(f"{self.name}.adb"),
        ]
        return found[-1].stem if found else None


class Suite:
    """The suite's folder, with `support/` and `tests/<chapter>/`."""

    def __init__(self, root: Path) -> None:
        """Raises SuiteMissingError."""
        self.root = root
        self.support = root / "support"
        for part in (self.support / "report.a", root / "tests" / "cxd"):
            if not part.exists():
                raise SuiteMissingError(f"{root}: no {part.relative_to(root)} there")
        self._with_switch = {
            "-gnatE": self._list("elabd.lst"),
            "-ffloat-store": self._list("floatstore.lst"),
        }

    @classmethod
    def fetched(cls) -> Suite:
        """The suite where `verification.outside` has it. Raises SuiteMissingError."""
        data = data_sets()["acats"]
        place = data.place()
        if place is None:
            raise SuiteMissingError(data.advice())
        return cls(place.resolve())

    def _list(self, name: str) -> set[str]:
        path = self.root / name
        return set(path.read_text().split()) if path.exists() else set()

    def shared_files(self) -> list[Path]:
        """Packages that tests name in context clauses, Report and host tools apart."""
        own = {"report.a", "version.a", "special.a"}
        paths = [p for p in self.support.iterdir() if p.suffix in SOURCES]
        return sorted(
            p
            for p in paths
            if p.name not in own and re.match(r"f|impdef|lencheck|enumchek|spprt|tctouch", p.name)
        )

    def tests(self, chapters: tuple[str, ...]) -> list[AcatsTest]:
        """Tests of the chapters in the order of their names."""
        tests = []
        for chapter in chapters:
            groups: dict[str, list[Path]] = {}
            foreign: dict[str, list[Path]] = {}
            for path in sorted((self.root / "tests" / chapter).iterdir()):
                if path.suffix == ".c":
                    foreign.setdefault(path.stem[:7].lower(), []).append(path)
                if path.suffix in SOURCES:
                    groups.setdefault(path.stem[:7].lower(), []).append(path)
            for name, files in groups.items():
                switches = tuple(s for s, names in self._with_switch.items() if name in names)
                test = AcatsTest(
                    name, chapter, tuple(files), switches, tuple(foreign.get(name, ()))
                )
                tests.append(test)
        return tests

    def macros(self) -> dict[str, str]:
        """Values of the names that `.tst` files hold for the implementer to fill in."""
        target = {
            "ACATS4GNATBIT": "32",
            "ACATS4GNATINSN": "nop",
            "ACATS4GNATMAXINT": str(2**63 - 1),
            "ACATS4GNATMININT": str(-(2**63)),
            "ACATS4GNATDIR": ".",
        }
        values = {}
        for line in (self.support / "macro.dfs").read_text().splitlines():
            if line.startswith("--") or not line.strip():
                continue
            name, _, value = line.strip().partition("\t")
            if not value:
                name, _, value = line.strip().partition(" ")
            for mark, text in target.items():
                value = value.replace(mark, text)
            values[name.strip()] = value.strip()
        longest = int(values.get("MAX_IN_LEN", "200"))
        literal = '"' + "A" * (longest - 2) + '"'
        return values | {"BLANKS": " " * (longest - 20), "MAX_STRING_LITERAL": literal}

    def text(self, path: Path) -> str:
        """A source file with its macros filled in."""
        text = path.read_text(encoding="latin-1")
        if path.suffix != ".tst":
            return text
        macros = self.macros()
        return re.sub(r"\$([A-Z][A-Z0-9_]*)", lambda m: macros.get(m.group(1), m.group(0)), text)
