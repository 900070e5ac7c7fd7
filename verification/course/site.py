# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site in a browser, with and without a network."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from verification.commands import Counts, NoResultError
from verification.support.paths import ROOT


def in_browser() -> Counts:
    """The tests of `web/e2e/site` on the site that `make docs` builds."""
    made = subprocess.run(["make", "--no-print-directory", "docs"], cwd=ROOT, stdout=sys.stderr)
    if made.returncode != 0:
        raise NoResultError("make docs: the site was not built")
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        options = ["--reporter=default", "--reporter=json", f"--outputFile={report}"]
        subprocess.run([ROOT / "tools" / "page", "site", *options], stdout=sys.stderr, check=False)
        if not report.exists():
            raise NoResultError("tools/page site: no report")
        files = json.loads(report.read_text("utf-8"))["testResults"]
    return counts_of_site([test for file in files for test in file["assertionResults"]])


def counts_of_site(tests: list[dict[str, Any]]) -> Counts:
    """Of Vitest's report, and the loads of the first page."""
    failed = [test["fullName"] for test in tests if test["status"] == "failed"]
    passed = sum(test["status"] == "passed" for test in tests)
    left_out = len(tests) - passed - len(failed)
    reason = "a scenario with a peer or a monitor, which the page does not have"
    excluded: list[dict[str, Any]] = [{"count": left_out, "reason": reason}] if left_out else []
    loads = [test["meta"]["firstRobot"] for test in tests if "firstRobot" in test.get("meta", {})]
    return Counts(len(tests), passed, excluded, failed, [_loads(loads)] if loads else [])


def _loads(loads: list[dict[str, float]]) -> str:
    """When the first robot moves with each processor, and what is loaded until then."""
    quick, *slow = sorted(loads, key=lambda load: load["rate"])
    parts = [f"the first page's robot moves after {quick['seconds']:.1f} s with this processor"]
    parts += [
        f"after {load['seconds']:.1f} s with one {load['rate']:g} times slower, as a phone's"
        for load in slow
    ]
    return f"{', '.join(parts)}; {quick['bytes'] / 1e6:.2f} MB are loaded until then, packed"
