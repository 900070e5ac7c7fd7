# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick studio`: its page is served to who has the address, and Ctrl-C ends it."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from verification.support.projects import VEHICLE

from ravenbrick.errors import ExitCode

COMMAND = (sys.executable, "-c", "from ravenbrick.cli import main; main()", "studio")


def test_the_address_with_its_token_serves_the_page() -> None:
    words = [*COMMAND, str(VEHICLE), "--port", "0", "--no-browser", "--json"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as done:
        try:
            assert done.stderr is not None
            found = re.search(r"(http://127\.0\.0\.1:\d+/)[\w-]+/", done.stderr.readline())
            assert found is not None
            with urllib.request.urlopen(found[0], timeout=60) as page:
                assert b"<title>" in page.read()
            with pytest.raises(urllib.error.HTTPError):
                urllib.request.urlopen(found[1], timeout=60)
        finally:
            done.send_signal(signal.SIGINT)
            done.communicate(timeout=60)
    assert done.returncode == ExitCode.INTERRUPTED


def test_a_folder_without_a_robot_is_refused(tmp_path: Path) -> None:
    words = [*COMMAND, str(tmp_path), "--port", "0", "--no-browser"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == ExitCode.PROJECT_FILE and "robot.toml" in done.stderr
