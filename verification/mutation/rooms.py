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
# With the project of the run-time, so that only what a change reaches is compiled.
GPRBUILD = "gprbuild -q -c -u -p --config=tools/ravenbrick.cgpr --implicit-with=tools/run_time.gpr"
VITEST = "cd web && npx vitest run --bail=1 --configLoader runner"
WORDS = "def|class|function|const|procedure|package body|package"
DEFINED = re.compile(rf"^ *(?:export )?(?:{WORDS}) (?:\w+\.)*([A-Za-z]\w{{2,}})", re.MULTILINE)
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
    used_in: str = ""  # a folder with users of its sources, if there are others than these

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

    def read_by(self, test: Path) -> list[Path]:
        """A file of tests and the sources of the programs `programs/<name>` that it names."""
        programs = [
            test.parent / "programs" / name
            for name in sorted(set(re.findall(r'"(\w+)"', test.read_text("utf-8"))))
        ]
        return [test, *(path for folder in programs for path in sorted(folder.glob("*.ad[sb]")))]

    def tests_near(self, tree: Path, source: str, count: int) -> list[Path]:
        """The files of tests that name most of what a source defines; none: all are to run.

        What imports it counts a quarter, a name less the more files have it, and a file less the
        more programs it runs.
        """
        if not (count and self.test_files):
            return []
        stem, texts = Path(source).stem, {}
        for path in self.files(tree, self.used_in or self.sources):
            if path.suffix in {*LANGUAGES, ".ads"} and tree / self.tests not in path.parents:
                texts[path] = path.read_text("utf-8")
        own = [stem, stem.rpartition("-")[2], *DEFINED.findall(texts[tree / source])]
        unit = stem.replace("-", r"\.")
        imports = re.compile(
            rf'\b{stem}(?: import |")|^with {unit}\b', re.MULTILINE | re.IGNORECASE
        )
        users = [text for text in texts.values() if imports.search(text)]
        used = {name.lower(): 0.25 for name in DEFINED.findall("\n".join(users))}
        share = used | {name.lower(): 1.0 for name in own}
        files = [p for p in self.files(tree, self.tests) if re.match(r"test_|.*\.test\.", p.name)]
        read = {path: self.read_by(path) for path in files}
        words = {path: re.findall(r"\w+", "".join(map(_lower, read[path]))) for path in files}
        named = {path: share.keys() & set(words[path]) for path in files}
        having = Counter(name for names in named.values() for name in names)
        weight = {
            path: sum(share[name] / having[name] for name in names) / len(read[path]) ** 0.5
            for path, names in named.items()
        }
        return sorted(files, key=lambda path: -weight[path])[:count]

    def command(self, tests: list[Path]) -> str:
        """That runs files of tests; none: all of the room."""
        return " ".join([self.test_files, *map(str, tests)]) if tests else self.test


def _lower(path: Path) -> str:
    return path.read_text("utf-8").lower()


def _crate(name: str) -> Room:
    folder = f"virtual-brick/crates/{name}"
    command = f"{CARGO} -p {name} --lib --bins --tests"
    # The first test that fails ends the run.
    test = f"! grep -m 1 FAILED < <( ({command} || echo FAILED) 2>&1 | tee -a /dev/stderr)"
    # Unit tests stand among the sources.
    return Room(name, f"{folder}/src", folder, f"{command} --no-run", test)


def _host(name: str) -> Room:
    folder = f"host/src/ravenbrick/{name}"
    tests = f"host/tests/{name}"
    return Room(name, folder, tests, f"{COMPILE} {folder}", f"{PYTEST} {tests}", PYTEST)


ROOMS = {
    room.name: room
    for room in (
        Room("kernel", "runtime/kernel", "runtime/tests", "make -s -C runtime",
             f"{PYTEST} runtime/tests", PYTEST, "runtime"),
        Room("drivers", "drivers/src", "drivers/tests",
             f"{GPRBUILD} -P drivers/drivers.gpr",
             f"{PYTEST} drivers/tests", PYTEST),
        *map(_crate, CRATES),
        *map(_host, HOST),
        Room("page", "web/src", "web/tests", "cd web && npx tsc --noEmit",
             VITEST, VITEST),
    )
}  # fmt: skip
