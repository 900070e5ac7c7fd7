# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page's tests: elements on an imitation of a browser, then headless Chromium."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path

from verification.commands import ROOT, Counts


def suite() -> Counts:
    """Tests of the page, built before; excluded as one case where it cannot be built."""
    built = subprocess.run([str(ROOT / "tools" / "page")], capture_output=True, text=True)
    if built.returncode != 0:
        reason = (built.stderr.strip().splitlines() or ["make page failed"])[-1]
        return Counts(1, 0, [{"count": 1, "reason": reason}])
    count = passed = 0
    for options in ([], ["--config", "vitest.e2e.config.ts"]):
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "report.json"
            command = ["npx", "--no-install", "vitest", "run", *options]
            command += ["--reporter=json", f"--outputFile={report}"]
            subprocess.run(command, cwd=ROOT / "web", capture_output=True, text=True)
            results = json.loads(report.read_text())
        count += results["numTotalTests"]
        passed += results["numPassedTests"]
    return Counts(count, passed)
