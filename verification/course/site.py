# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site in a browser, with and without a network."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

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
    tests = [test for file in files for test in file["assertionResults"]]
    failed = [test["fullName"] for test in tests if test["status"] == "failed"]
    passed = sum(test["status"] == "passed" for test in tests)
    left_out = len(tests) - passed - len(failed)
    reason = "a scenario with a peer or a monitor, which the page does not have"
    excluded = [{"count": left_out, "reason": reason}] if left_out else []
    return Counts(len(tests), passed, excluded, failed)
