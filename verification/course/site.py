# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site: built without a warning, each link inside it followed, searchable."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

from tools.docs.site_links import check_site
from verification.commands import Counts
from verification.support.paths import ROOT

NO_SPHINX = "Sphinx is not installed: 'make docs' installs it"
OUTSIDE = "leads out of the site; not followed, the build needs no network"


def suite() -> Counts:
    """Links, those that are right (none when the build warns), and what was left out."""
    if importlib.util.find_spec("sphinx") is None:
        return Counts(1, 0, [{"count": 1, "reason": NO_SPHINX}])
    with tempfile.TemporaryDirectory() as folder:
        site = Path(folder) / "html"
        command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
        built = subprocess.run([*command, "docs", str(site)], cwd=ROOT)
        report = check_site(site)
        whole = built.returncode == 0 and (site / "searchindex.js").is_file()
    count = report.followed + len(report.outside)
    passed = report.followed - len(report.broken) if whole else 0
    return Counts(count, passed, [{"count": len(report.outside), "reason": OUTSIDE}])
