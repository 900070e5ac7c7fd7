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

__all__ = ["Counts", "NoResultError", "counts_of", "function_of"]

CRATES = ROOT / "virtual-brick"
Row = dict[str, Any]


class NoResultError(Exception):
    """A command ended without a result; the text has its last lines."""


@dataclass
class Counts:
    """Cases of a suite, those that passed, and those left out: `count` and `reason` each."""

    case_count: int
    passed: int
    excluded: list[Row] = field(default_factory=list)


def _pytest(paths: tuple[str, ...]) -> Counts:
    """Python tests, the long ones too; skipped ones are left out with their reasons."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={report}", *paths]
        everything = {**os.environ, "RAVENBRICK_LONG": "1"}
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=everything)
        if not report.exists():
            raise NoResultError(f"pytest: no report\n{(done.stdout + done.stderr)[-2000:]}")
        cases = list(ElementTree.parse(report).getroot().iter("testcase"))
    skipped = Counter(
        node.get("message", "no reason stated") for c in cases for node in c.findall("skipped")
    )
    failed = [c for c in cases if c.find("failure") is not None or c.find("error") is not None]
    for case in failed:
        print(f"  failed: {case.get('classname')}.{case.get('name')}", file=sys.stderr)
    passed = len(cases) - len(failed) - sum(skipped.values())
    excluded = [{"count": n, "reason": reason} for reason, n in sorted(skipped.items())]
    return Counts(len(cases), passed, excluded)


def _cargo_test(words: str) -> Counts:
    """Tests of a crate: its name and options of `cargo test`."""
    command = ["cargo", "test", "--locked", "-p", *words.split()]
    done = subprocess.run(command, cwd=CRATES, capture_output=True, text=True)
    found = re.findall(r"test result: \S+ (\d+) passed; (\d+) failed", done.stdout)
    passed = sum(int(p) for p, _ in found)
    failed = sum(int(f) for _, f in found)
    if done.returncode != 0 and failed == 0:
        raise NoResultError(f"{' '.join(command)}: did not build\n{done.stderr[-2000:]}")
    return Counts(passed + failed, passed)


def _cargo_example(words: str) -> Counts:
    """The summary that an example of a crate prints as its last line: crate, example, arguments."""
    package, example, *arguments = shlex.split(os.path.expandvars(words))
    command = ["cargo", "run", "--locked", "--quiet", "--release", "-p", package]
    command += ["--example", example, "--manifest-path", str(CRATES / "Cargo.toml"), "--"]
    done = subprocess.run([*command, *arguments], cwd=ROOT, capture_output=True, text=True)
    if not done.stdout.strip():
        raise NoResultError(f"{package}, {example}: no result\n{done.stderr[-2000:]}")
    row = json.loads(done.stdout.strip().splitlines()[-1])
    return Counts(row["case_count"], row["passed"], row.get("excluded", []))


def function_of(name: str) -> Callable[..., Any]:
    """The function that `module:function` names."""
    module, _, function = name.partition(":")
    found: Callable[..., Any] = getattr(importlib.import_module(module), function)
    return found


def counts_of(kind: str, command: str | tuple[str, ...], arguments: tuple[str, ...]) -> Counts:
    """Run one suite; raises `NoResultError`."""
    if kind == "call":
        counts: Counts = function_of(str(command))(*arguments)
        return counts
    if kind == "pytest":
        return _pytest((command,) if isinstance(command, str) else command)
    return {"cargo_test": _cargo_test, "cargo_example": _cargo_example}[kind](str(command))
