# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site and the studio in a browser."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from verification.commands import Counts, NoResultError
from verification.support.paths import ROOT

Case = dict[str, Any]
NO_FIREFOX = "no second browser: install the Debian package firefox-esr"


def in_browser() -> Counts:
    """The tests of `web/e2e/site` on the site that `make docs` builds."""
    made = subprocess.run(["make", "--no-print-directory", "docs"], cwd=ROOT, stdout=sys.stderr)
    if made.returncode != 0:
        raise NoResultError("make docs: the site was not built")
    return counts_of_site(_reported(ROOT / "tools" / "page", "site"))


def studio() -> Counts:
    """The tests of the studio in `web/e2e`."""
    return counts_of_studio(_reported("npm", "--prefix", "web", "run", "e2e", "--", "studio"))


def _reported(*command: str | Path) -> list[Case]:
    """The cases of a run of Vitest."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        options = ["--reporter=default", "--reporter=json", f"--outputFile={report}"]
        subprocess.run([*command, *options], cwd=ROOT, stdout=sys.stderr, check=False)
        if not report.exists():
            raise NoResultError(f"{' '.join(map(str, command))}: no report")
        files = json.loads(report.read_text("utf-8"))["testResults"]
    return [case for file in files for case in file["assertionResults"]]


def _counts(cases: list[Case], reason: str, measured: list[str]) -> Counts:
    """Of Vitest's cases; `reason` is why some were left out."""
    failed = [case["fullName"] for case in cases if case["status"] == "failed"]
    passed = sum(case["status"] == "passed" for case in cases)
    left_out = len(cases) - passed - len(failed)
    excluded: list[dict[str, Any]] = [{"count": left_out, "reason": reason}] if left_out else []
    return Counts(len(cases), passed, excluded, failed, measured)


def counts_of_site(cases: list[Case]) -> Counts:
    """Of the cases, and the loads of the first page."""
    loads = [case["meta"]["firstRobot"] for case in cases if "firstRobot" in case.get("meta", {})]
    return _counts(cases, NO_FIREFOX, [_loads(loads)] if loads else [])


def counts_of_studio(cases: list[Case]) -> Counts:
    """Of the cases, and how long the brick takes to move after an edit."""
    edits = [case["meta"]["edit"] for case in cases if "edit" in case.get("meta", {})]
    return _counts(cases, "skipped", [f"after Ctrl+S: {edit}" for edit in edits])


def _loads(loads: list[dict[str, float]]) -> str:
    """When the first robot moves with each processor, and what is loaded until then."""
    quick, *slow = sorted(loads, key=lambda load: load["rate"])
    parts = [f"the first page's robot moves after {quick['seconds']:.1f} s with this processor"]
    parts += [
        f"after {load['seconds']:.1f} s with one {load['rate']:g} times slower, as a phone's"
        for load in slow
    ]
    return f"{', '.join(parts)}; {quick['bytes'] / 1e6:.2f} MB are loaded until then, packed"
