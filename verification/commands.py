# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The four kinds of commands of a suite, each from its entry to counts."""

from __future__ import annotations

import importlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from verification.support.paths import ROOT

__all__ = ["Counts", "NoResultError", "NotRunError", "counts_of", "function_of"]

CRATES = ROOT / "virtual-brick"
Row = dict[str, Any]


class NoResultError(Exception):
    """A command ended without a result; the text has its last lines."""


@dataclass
class Counts:
    """Cases of a suite, those that passed, and those left out: `count` and `reason` each.

    `failures` has a line for each case that failed, as far as the suite knows which; `measured` a
    sentence for what was measured beside the cases and not judged.
    """

    case_count: int
    passed: int
    excluded: list[Row] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    measured: list[str] = field(default_factory=list)

    @property
    def judged(self) -> int:
        """Cases that were not left out."""
        return self.case_count - sum(e["count"] for e in self.excluded)


class NotRunError(Exception):
    """Nothing could be judged on this machine; the text says what is absent.

    `held` is what the suite itself keeps of an earlier day, `date`.
    """

    def __init__(self, reason: str, held: Counts | None = None, date: str = "") -> None:
        super().__init__(reason)
        self.held, self.date = held, date


def _pytest(paths: tuple[str, ...]) -> Counts:
    """Python tests, the long ones too; skipped ones are left out with their reasons."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        command = [sys.executable, "-m", "pytest", "-v", f"--junitxml={report}", *paths]
        everything = {**os.environ, "RAVENBRICK_LONG": "1"}
        subprocess.run(command, cwd=ROOT, stdout=sys.stderr, env=everything)
        if not report.exists():
            raise NoResultError(f"pytest {' '.join(paths)}: no report")
        cases = list(ElementTree.parse(report).getroot().iter("testcase"))
    skipped = Counter(
        node.get("message", "no reason stated") for c in cases for node in c.findall("skipped")
    )
    failures = [
        f"{case.get('classname')}.{case.get('name')}: {node.get('message', '').strip()}"
        for case in cases
        for node in [*case.findall("failure"), *case.findall("error")][:1]
    ]
    passed = len(cases) - len(failures) - sum(skipped.values())
    excluded = [{"count": n, "reason": reason} for reason, n in sorted(skipped.items())]
    return Counts(len(cases), passed, excluded, failures)


def _cargo_test(words: str) -> Counts:
    """Tests of a crate: its name and options of `cargo test`."""
    command = ["cargo", "test", "--locked", "--no-fail-fast", "-p", *words.split()]
    done = subprocess.run(command, cwd=CRATES, stdout=subprocess.PIPE, text=True)
    print(done.stdout, file=sys.stderr)
    found = re.findall(r"test result: \S+ (\d+) passed; (\d+) failed", done.stdout)
    passed = sum(int(p) for p, _ in found)
    failed = sum(int(f) for _, f in found)
    if done.returncode != 0 and failed == 0:
        raise NoResultError(f"{' '.join(command)}: did not build")
    failures = re.findall(r"^test (.*) \.\.\. FAILED$", done.stdout, re.MULTILINE)
    return Counts(passed + failed, passed, failures=failures)


def _cargo_example(words: str) -> Counts:
    """The summary that an example of a crate prints as its last line: crate, example, arguments."""
    package, example, *arguments = shlex.split(os.path.expandvars(words))
    command = ["cargo", "run", "--locked", "--quiet", "--release", "-p", package]
    command += ["--example", example, "--manifest-path", str(CRATES / "Cargo.toml"), "--"]
    done = subprocess.run([*command, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if not done.stdout.strip():
        raise NoResultError(f"{package}, {example}: no result, exit code {done.returncode}")
    row = json.loads(done.stdout.strip().splitlines()[-1])
    return Counts(row["case_count"], row["passed"], row.get("excluded", []))


def function_of(name: str) -> Callable[..., Any]:
    """The function that `module:function` names."""
    module, _, function = name.partition(":")
    found: Callable[..., Any] = getattr(importlib.import_module(module), function)
    return found


def counts_of(kind: str, command: str | tuple[str, ...], arguments: tuple[str, ...]) -> Counts:
    """Run one suite. Raises `NoResultError`, also when no case ran, and `NotRunError`."""
    counts: Counts
    if kind == "call":
        counts = function_of(str(command))(*arguments)
    elif kind == "pytest":
        counts = _pytest((command,) if isinstance(command, str) else command)
    else:
        counts = {"cargo_test": _cargo_test, "cargo_example": _cargo_example}[kind](str(command))
    if counts.case_count == 0:
        raise NoResultError("no case ran")
    if counts.judged == 0:
        raise NotRunError("; ".join(str(e["reason"]) for e in counts.excluded))
    return counts
