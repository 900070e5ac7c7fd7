# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Which tests of a Python room execute which line, so that others need not run for a mutant.

Each file of tests runs once by itself, unchanged, under coverage.py, its Python children too. What
one test prepares serves others of its file: fixtures, caches, modules. So of a mutant all tests run
of the files that execute it, first those that execute it themselves. What a process executes where
nothing is recorded counts as executed by the tests that start it.
"""

from __future__ import annotations

import ast
import json
import shlex
import subprocess
from bisect import bisect
from dataclasses import asdict, dataclass, field
from itertools import chain
from pathlib import Path

import pytest
from coverage import CoverageData
from ravenbrick.atomic_write import atomic_write

from verification.commands import NoResultError
from verification.mutation.mutants import Mutant
from verification.mutation.recorder import TIMES
from verification.mutation.rooms import Room, digest_of
from verification.mutation.scratch import PATIENCE, Scratch, unchanged_s

__all__ = ["Executed", "File", "statement_lines"]

PYTHON = ".venv/bin/python"
OPTIONS = ("-q", "-ra", "-p", "no:cacheprovider", "-p", "verification.mutation.recorder")
UNKNOWN_NAME = pytest.ExitCode.USAGE_ERROR
# Spawned processes are recorded as well; what forks writes its lines when it ends.
SETTINGS = """[run]
source = {source}
data_file = {data}
parallel = true
patch = subprocess
    _exit
"""
# What a test executes depends on these and on its own file.
READ = ("host/src", "verification/support")
SPARE_S = 10
TIMES_USUAL = 5


def statement_lines(source: str, line: int) -> range:
    """The lines of the statement at a line; of one that holds others, those before the first.

    A line of a table need not have code of its own.
    """
    starts = {1, source.count("\n") + 2}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.match_case):
            starts.add(node.pattern.lineno)
        elif isinstance(node, (ast.stmt, ast.excepthandler)):
            decorators: list[ast.expr] = getattr(node, "decorator_list", [])
            starts.add(min(part.lineno for part in (node, *decorators)))
    ordered = sorted(starts)
    at = bisect(ordered, line)
    return range(ordered[at - 1], ordered[at])


@dataclass
class File:
    """A file of tests: the processor time of each test, and who executes which lines.

    `lines` has a source's lines with the tests that execute them; the empty name is for what is
    executed outside a test, or in a child. `digest` is of what was run.
    """

    path: str
    digest: str
    used_s: dict[str, float]
    lines: dict[str, dict[str, list[str]]] = field(default_factory=dict)


class Executed:
    """The files of tests of a room, after a run of each in the scratch copy, which is kept."""

    def __init__(self, room: Room, scratch: Scratch, limit_s: float) -> None:
        self.room, self.scratch, self.limit_s = room, scratch, limit_s
        self.list = scratch.folder / "tests.txt"
        self._server: subprocess.Popen[str] | None = None
        self.read = [path for folder in READ for path in room.files(scratch.tree, folder)]
        tests = room.files(scratch.tree, room.tests)
        self.files = [self._file(path) for path in tests if path.name.startswith("test_")]
        for starter, line, module in room.apart:
            self._count_apart(f"{room.sources}/{starter}", line, module)

    def _file(self, path: Path) -> File:
        """Raises `NoResultError` when a test fails, or all are skipped."""
        inside = path.relative_to(self.scratch.tree / self.room.tests)
        kept = (self.scratch.folder / "executed" / inside).with_suffix(".json")
        kept.parent.mkdir(parents=True, exist_ok=True)
        digest = digest_of([path, *self.read])
        if kept.is_file():
            file = File(**json.loads(kept.read_text("utf-8")))
            if file.digest == digest:
                return file
        file = self._recorded(str(path.relative_to(self.scratch.tree)), digest)
        atomic_write(kept, json.dumps(asdict(file)))
        return file

    def _recorded(self, name: str, digest: str) -> File:
        folder, tree = self.scratch.folder, self.scratch.tree
        settings, times, data = (folder / name for name in ("coverage.ini", "times.json", "lines"))
        settings.write_text(SETTINGS.format(source=tree / self.room.sources, data=data))
        for old in folder.glob("lines.*"):
            old.unlink()
        command = (
            f"{PYTHON} -m coverage run --rcfile={settings} -m pytest {shlex.join((*OPTIONS, name))}"
        )
        unchanged_s(self.scratch, f"export {TIMES}='{times}'; {command}", self.limit_s, name)
        file = File(name, digest, json.loads(times.read_text("utf-8")))
        for one in sorted(folder.glob("lines.*")):
            found = CoverageData(str(one))
            found.read()
            for source in sorted(found.measured_files()):
                lines = file.lines.setdefault(str(Path(source).relative_to(tree)), {})
                for line, names in found.contexts_by_lineno(source).items():
                    lines[str(line)] = sorted({*lines.get(str(line), ()), *names})
        return file

    def _count_apart(self, starter: str, text: str, module: str) -> None:
        """Count each line that a process may execute as executed by the tests that start it."""
        source = (self.scratch.tree / starter).read_text("utf-8")
        starts = statement_lines(source, source[: source.index(text)].count("\n") + 1)
        loaded = self._loaded_by(module)
        for file in self.files:
            lines = file.lines.get(starter, {})
            names = [lines[str(line)] for line in starts if str(line) in lines]
            for name, count in loaded.items() if names else ():
                lines = file.lines.setdefault(name, {})
                for line in map(str, range(1, count + 1)):
                    lines[line] = sorted({*lines.get(line, ()), *chain(*names)})

    def _loaded_by(self, module: str) -> dict[str, int]:
        """The room's sources that a module loads, with the number of their lines."""
        files = "*(vars(m).get('__file__') for m in list(sys.modules.values()))"
        program = f"import sys, {module}; print({files}, sep='\\n')"
        loads, _ = self.scratch.run(f'{PYTHON} -c "{program}"', self.limit_s)
        places = set(self.scratch.log.read_text().splitlines())
        sources = self.room.files(self.scratch.tree, self.room.sources)
        found = [path for path in sources if str(path) in places]
        if not (loads and found):
            raise NoResultError(f"{self.room.name}, nothing changed: '{module}' is not loaded")
        tree = self.scratch.tree
        return {str(p.relative_to(tree)): len(p.read_text("utf-8").splitlines()) for p in found}

    def tests(self, mutant: Mutant, source: str) -> list[str]:
        """Those that can notice a mutant of this source, most promising first.

        Where no test executes the statement itself, as of a constant, the first are those that
        execute something of its module.
        """
        lines = [str(line) for line in statement_lines(source, mutant.line)]
        first: list[tuple[float, list[str]]] = []
        later: list[tuple[float, list[str]]] = []
        for file in self.files:
            executed = file.lines.get(mutant.file, {})
            if not any(line in executed for line in lines):
                continue
            own = {name for line in lines for name in executed.get(line, ())} - {""}
            own = own or {name for names in executed.values() for name in names} - {""}
            for tests, group in ((own, first), (file.used_s.keys() - own, later)):
                ordered = sorted(tests, key=lambda test: (file.used_s[test], test))
                group.append((sum(file.used_s[test] for test in ordered), ordered))
        return [test for _, tests in [*sorted(first), *sorted(later)] for test in tests]

    def passed(self, tests: list[str]) -> tuple[bool, float]:
        """Run tests until one fails; the processor time that they took.

        A mutant may give a test another name: then whole files run.
        """
        files = [file for file in self.files if not file.used_s.keys().isdisjoint(tests)]
        self.list.write_text("".join(f"{test}\n" for test in tests), encoding="utf-8")
        code, used_s = self._run(f"@{self.list}", files=files)
        if code == UNKNOWN_NAME:
            code, more_s = self._run(*(file.path for file in files), files=files)
            used_s += more_s
        self.scratch.used_s += used_s
        return code == 0, used_s

    def _run(self, *tests: str, files: list[File]) -> tuple[int, float]:
        if self._server is None:
            self._server = self.scratch.server(f"{PYTHON} -m verification.mutation.forks")
        longest_s = max(max(file.used_s.values()) for file in files)
        all_s = sum(sum(file.used_s.values()) for file in files)
        request = {
            "arguments": ["-x", *OPTIONS, *tests],
            "log": str(self.scratch.log),
            "limit_s": SPARE_S + TIMES_USUAL * longest_s,
            "wait_s": PATIENCE * (SPARE_S + TIMES_USUAL * all_s),
        }
        assert self._server.stdin and self._server.stdout
        self._server.stdin.write(json.dumps(request) + "\n")
        self._server.stdin.flush()
        answer = json.loads(self._server.stdout.readline() or "null")
        if answer is None:
            raise NoResultError(f"{self.room.name}: the process that runs the tests has ended")
        return answer["code"], answer["used_s"]
