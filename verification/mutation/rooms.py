# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The rooms whose tests are judged: sources, a command that builds, and the room's own tests."""

from __future__ import annotations

import hashlib
import math
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from verification.mutation.mutants import LANGUAGES, Mutant, mutants_of

__all__ = ["ROOMS", "Room", "digest_of"]

CRATES = ("arm7tdmi", "at91sam7s", "nxt", "plant")
HOST = ("trace", "model", "codegen", "control", "schedule", "timing", "grading", "telemetry")
# What is built for each mutant anew costs more than its tests.
CARGO = (
    "CARGO_PROFILE_DEV_OPT_LEVEL=0 CARGO_INCREMENTAL=1 "
    "cargo test --offline --locked --quiet --manifest-path virtual-brick/Cargo.toml"
)
PYTEST = ".venv/bin/python -m pytest -q -x -p no:cacheprovider"
# With the project of the run-time, so that only what a change reaches is compiled.
GPRBUILD = "gprbuild -q -c -u -p --config=tools/ravenbrick.cgpr --implicit-with=tools/run_time.gpr"
VITEST = "cd web && node_modules/.bin/vitest run --bail=1 --configLoader runner"
# Of names, too: `Ready_Head` has two, `readyHead` as well.
WORD = re.compile(r"[A-Z]?[a-z]{2,}|[A-Z]{2,}(?![a-z])")
# What a mutant changes is compiled anew, whatever the clock says.
COMPILE = ".venv/bin/python -m compileall -q --invalidation-mode checked-hash"
# What runs in the grader's sandbox, where nothing records lines, and a line that starts it.
APART = {
    "grading": (
        ("work.py", '"ravenbrick.grading.judge"', "ravenbrick.grading.judge"),
        ("isolation/landlock.py", "str(CONFINEMENT)", "ravenbrick.grading.isolation.confinement"),
    )
}


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
    executed: bool = False  # of Python, built once: only tests that execute a mutant run
    # Of each process that is not recorded: the file that starts it, text of that line, its module.
    apart: tuple[tuple[str, str, str], ...] = ()

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
        """The files of tests with most of a source's words, rare ones above all; none: all.

        A test that runs programs has their words, too, and counts less the more there are; where
        some do, the others judge nothing.
        """
        if not (count and self.test_files):
            return []
        tests = [p for p in self.files(tree, self.tests) if re.match(r"test_|.*\.test\.", p.name)]
        read = {test: self.read_by(test) for test in tests}
        tests = [test for test in tests if len(read[test]) > 1] or tests
        words = {test: _words(read[test]) for test in tests}
        having = Counter(word for found in words.values() for word in found)
        rarity = {word: math.log(len(tests) / n) for word, n in having.items()}
        file = tree / source
        own = _words(path for path in {file, file.with_suffix(".ads")} if path.exists())

        def nearness(test: Path) -> float:
            found = {word: math.log1p(n) * rarity[word] for word, n in words[test].items()}
            length = math.hypot(*found.values()) or 1.0
            shared = sum(math.log1p(own[word]) * rarity[word] * found[word] for word in found)
            return shared / length / len(read[test]) ** 0.25

        return sorted(tests, key=nearness, reverse=True)[:count]

    def command(self, tests: list[Path]) -> str:
        """That runs files of tests; none: all of the room."""
        return " ".join([self.test_files, *map(str, tests)]) if tests else self.test


def digest_of(paths: list[Path]) -> str:
    """One digest of names and contents."""
    content = hashlib.sha256()
    for path in paths:
        content.update(path.name.encode() + b"\0" + path.read_bytes())
    return content.hexdigest()[:16]


def _words(files: Iterable[Path]) -> Counter[str]:
    """How often which word stands in files and their names, without an `s` at its end."""
    texts = (f"{file.stem} {file.read_text('utf-8')}" for file in files)
    return Counter(word.lower().rstrip("s") for text in texts for word in WORD.findall(text))


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
    build = f"{COMPILE} host/src verification/support"
    test = f"{PYTEST} {tests}"
    return Room(name, folder, tests, build, test, executed=True, apart=APART.get(name, ()))


ROOMS = {
    room.name: room
    for room in (
        Room("kernel", "runtime/kernel", "runtime/tests", "make -s -C runtime",
             f"{PYTEST} runtime/tests", PYTEST),
        Room("drivers", "drivers/src", "drivers/tests",
             f"{GPRBUILD} -P drivers/drivers.gpr",
             f"{PYTEST} drivers/tests", PYTEST),
        *map(_crate, CRATES),
        *map(_host, HOST),
        Room("page", "web/src", "web/tests", "cd web && node_modules/.bin/tsc --noEmit",
             VITEST, VITEST),
    )
}  # fmt: skip
