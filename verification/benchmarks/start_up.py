# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Processor time of the commands that a user waits for, beside the bare interpreter's."""

from __future__ import annotations

import statistics
from collections.abc import Iterator

from verification.benchmarks.child_time import run_timed
from verification.benchmarks.figures import REPEATS, VEHICLE, Figure
from verification.built_examples import ravenbrick
from verification.commands import NoResultError
from verification.support.paths import ROOT

# Whole processes that a user waits for; imports as the command makes them, without threads of BLAS.
ALONE = ["env", "OPENBLAS_NUM_THREADS=1"]
COMPLETION = ["_RAVENBRICK_COMPLETE=complete_bash", "COMP_WORDS=ravenbrick re", "COMP_CWORD=1"]
START_UP = {
    "ravenbrick --version": ["ravenbrick", "--version"],
    "ravenbrick --help": ["ravenbrick", "--help"],
    "completion of a command": ["env", *COMPLETION, "ravenbrick"],
    "import of the command run": [*ALONE, "python", "-c", "import ravenbrick.cli.run"],
    "import of the command build": [*ALONE, "python", "-c", "import ravenbrick.cli.build"],
    "build of the vehicle, nothing changed": ["ravenbrick", "build", str(VEHICLE)],
    "design of the vehicle": ["ravenbrick", "design", str(VEHICLE)],
    "run of the vehicle's drive of 20 s": ["ravenbrick", "run", str(VEHICLE), "drive", "--json"],
}
SCRIPTS = {name: str(ROOT / ".venv" / "bin" / name) for name in ("python", "ravenbrick")}
BARE = {
    "the interpreter alone": ["python", "-c", "pass"],
    "the interpreter with NumPy": ["python", "-c", "import numpy"],
}


def start_up() -> Iterator[Figure]:
    """Seconds of processor time, user and system, beside the bare interpreter's; medians."""
    ravenbrick("build", str(VEHICLE))
    taken: dict[str, list[float]] = {name: [] for name in (*BARE, *START_UP)}
    for _ in range(REPEATS):
        for name, words in (BARE | START_UP).items():
            command = [SCRIPTS.get(word, word) for word in words]
            seconds, code = run_timed(command, 120)
            if code:
                raise NoResultError(f"{' '.join(command)}: ended with {code}")
            taken[name].append(seconds)
    medians = {name: statistics.median(seconds) for name, seconds in taken.items()}
    for name in START_UP:
        for peer in BARE:
            yield Figure(name, medians[name], "s of processor time", peer, medians[peer])
