# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The border around a submission: bubblewrap, else Landlock, or by explicit trust none.

Inside, a program reads the system's programs and the paths that it is given, and writes one folder.
It has no network, and no process of it outlives the first one.
"""

from __future__ import annotations

import functools
import shutil
import subprocess

from ravenbrick.grading.isolation.border import (
    PATH,
    TRUST,
    Bounds,
    Isolation,
    IsolationError,
    Trust,
)
from ravenbrick.grading.isolation.bubblewrap import Bubblewrap, cure_of
from ravenbrick.grading.isolation.landlock import Landlock
from ravenbrick.installation import advice_for_packages

__all__ = [
    "TRUST",
    "Bounds",
    "Isolation",
    "IsolationError",
    "find_isolation",
    "isolation_named",
    "tried",
]

PROBE_S = 20


def tried(isolation: Isolation) -> str:
    """Why a command cannot run in the isolation; empty if it can."""
    with isolation.call(["true"], Bounds(5, 512, 1), [], []) as (command, _folder):
        try:
            done = subprocess.run(
                command, env={"PATH": PATH}, stdin=subprocess.DEVNULL, capture_output=True,
                text=True, timeout=PROBE_S, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return f"{command[0]} does not end"
    said = done.stderr.strip().splitlines() or [f"{command[0]} ends with {done.returncode}"]
    return said[-1] if done.returncode else ""


def _bubblewrap() -> Isolation:
    program = shutil.which("bwrap")
    if program is None:
        raise IsolationError(f"bwrap is not installed; {advice_for_packages(['bubblewrap'])}")
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=False)
    found = Bubblewrap(program, done.stdout.strip() or "bubblewrap")
    if cause := tried(found):
        raise IsolationError(f"{cause}; {cure_of(cause)}")
    return found


@functools.cache
def find_isolation() -> Isolation:
    """The isolation of this machine, tried once; raises `IsolationError` with cause and cure."""
    try:
        return _bubblewrap()
    except IsolationError as error:
        other = Landlock()
        if cause := tried(other):
            raise IsolationError(
                f"submissions cannot be isolated: {error.sentence}; Landlock, which would do "
                f"instead, fails too: {cause}"
            ) from None
        return other


@functools.cache
def isolation_named(name: str) -> Isolation:
    """The isolation that a campaign has chosen, on this machine; raises `IsolationError`."""
    if name == TRUST:
        return Trust()
    return Landlock() if name == Landlock.name else find_isolation()
