# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The rooms whose tests are judged: sources, a command that builds, and the room's own tests."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from verification.mutation.mutants import LANGUAGES, Mutant, mutants_of

__all__ = ["ROOMS", "Room"]

CRATES = ("arm7tdmi", "at91sam7s", "nxt", "plant")
HOST = ("trace", "model", "codegen", "control", "schedule", "timing", "grading", "telemetry")
CARGO = "cargo test --offline --locked --quiet --manifest-path virtual-brick/Cargo.toml"
PYTEST = ".venv/bin/python -m pytest -q -x -p no:cacheprovider"
VITEST = "cd web && npx vitest run --bail=1 --configLoader runner"
WORDS = "def|class|function|const|procedure|package"
DEFINED = re.compile(rf"^ *(?:export )?(?:{WORDS}) ([A-Za-z]\w{{3,}})", re.MULTILINE)
COMPILE = ".venv/bin/python -m compileall -q"


@dataclass(frozen=True)
class Room:
    """Folders of its sources and of its tests, and two commands of a shell.

    A mutant that `build` refuses is none; one that `test` refuses is killed.
    """

    name: str
    sources: str
    tests: str
    build: str
    test: str
    test_files: str = ""  # a command that takes files of tests as arguments
    one_build: bool = False  # of a crate that serves many mutants

    def files(self, tree: Path, folder: str) -> list[Path]:
        """Every file below one of its folders, in a fixed order, but none that Python compiled."""
        found = (path for path in (tree / folder).rglob("*") if path.is_file())
        return sorted(path for path in found if path.parent.name != "__pycache__")

    def mutants(self, tree: Path) -> list[Mutant]:
        """Of all its sources but unit tests, with paths below the tree."""
        files = self.files(tree, self.sources)
        sources = [p for p in files if p.suffix in LANGUAGES and p.parent.name != "tests"]
        return [
            mutant
            for path in sources
            for mutant in mutants_of(str(path.relative_to(tree)), path.read_text(encoding="utf-8"))
        ]

    def tests_near(self, tree: Path, source: str, count: int) -> str:
        """The command for the files of tests that name most of what a source defines, 0: for all.

        What imports it counts a quarter, and a name less the more files have it.
        """
        if not (count and self.test_files):
            return self.test
        stem, texts = Path(source).stem, {}
        for path in self.files(tree, self.sources):
            if path.suffix in LANGUAGES:
                texts[path] = path.read_text("utf-8")
        own = {stem, *DEFINED.findall(texts[tree / source])}
        users = [text for text in texts.values() if re.search(rf"\b{stem}(?: import |\")", text)]
        share = dict.fromkeys(DEFINED.findall("\n".join(users)), 0.25) | dict.fromkeys(own, 1.0)
        files = [p for p in self.files(tree, self.tests) if re.match(r"test_|.*\.test\.", p.name)]
        named = {p: share.keys() & set(re.findall(r"\w+", p.read_text("utf-8"))) for p in files}
        having = Counter(name for names in named.values() for name in names)
        weight = {p: sum(share[n] / having[n] for n in names) for p, names in named.items()}
        nearest = sorted(files, key=lambda path: -weight[path])[:count]
        return " ".join([self.test_files, *map(str, nearest)])


def _crate(name: str) -> Room:
    folder = f"virtual-brick/crates/{name}"
    command = f"{CARGO} -p {name} --lib --bins --tests"
    # The first test that fails ends the run.
    test = f"! grep -m 1 FAILED < <( ({command} || echo FAILED) 2>&1 | tee -a /dev/stderr)"
    # Unit tests stand among the sources.
    return Room(name, f"{folder}/src", folder, f"{command} --no-run", test, one_build=True)


def _host(name: str) -> Room:
    folder = f"host/src/ravenbrick/{name}"
    tests = f"host/tests/{name}"
    return Room(name, folder, tests, f"{COMPILE} {folder}", f"{PYTEST} {tests}", PYTEST)


ROOMS = {
    room.name: room
    for room in (
        Room("kernel", "runtime/kernel", "runtime/tests", "make -s -C runtime",
             f"{PYTEST} runtime/tests", PYTEST),
        Room("drivers", "drivers/src", "drivers/tests",
             "gprbuild -q -c -u -p --config=tools/ravenbrick.cgpr -P drivers/drivers.gpr",
             f"{PYTEST} drivers/tests", PYTEST),
        *map(_crate, CRATES),
        *map(_host, HOST),
        Room("page", "web/src", "web/tests", "cd web && npx tsc --noEmit",
             VITEST, VITEST),
    )
}  # fmt: skip
