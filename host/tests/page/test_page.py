# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The page's own tests, when what they need is there: elements, and one drive in Chromium."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

WEB = Path(__file__).resolve().parents[3] / "web"
BUNDLE = WEB.parent / "build" / "page" / "index.html"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")

pytestmark = pytest.mark.skipif(
    not (WEB / "node_modules" / "vitest").is_dir() or not (WEB / "generated").is_dir(),
    reason="the page's tools are not installed; 'make page' installs them",
)


def passes(*words: str) -> None:
    """Run vitest; its output when it fails."""
    command = ["npx", "--no-install", "vitest", "run", *words]
    done = subprocess.run(command, cwd=WEB, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-1000:]


def test_the_elements_of_the_page_behave() -> None:
    """On an imitation of a browser."""
    passes()


@pytest.mark.skipif(not BUNDLE.is_file(), reason="the page is not built; 'make page' builds it")
@pytest.mark.skipif(
    not any(shutil.which(name) for name in BROWSERS),
    reason="no Chromium is installed (Debian package chromium)",
)
def test_a_drive_in_the_browser_is_the_drive_of_the_command_line() -> None:
    """The first of the end-to-end tests; 'make conformance' runs them all."""
    passes("--config", "vitest.e2e.config.ts", "-t", "sample")
