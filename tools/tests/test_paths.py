# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""README's command in a folder with blank, quotes and umlaut, reached by a symbolic link."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import virtual_brick
from ravenbrick.sources import brick_digest

from tools.style.tidy import ROOT, tracked_files

PARTS = ("Makefile", "catalogue", "drivers", "host", "runtime", "tools", "virtual-brick")
LONG = "a folder with a long name, as cloud drives have them " * 2


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A checkout that was moved there after its set-up: what was built is taken along."""
    assert virtual_brick.SOURCES == brick_digest(ROOT), "run 'make setup'"
    place = tmp_path / LONG / 'Jürgen\'s "brick"'
    for path in tracked_files():
        name = path.relative_to(ROOT)
        if name.parts[0] in PARTS or name.parts[:2] == ("examples", "vehicle"):
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, place / name)
    shutil.copytree(ROOT / ".venv" / "bin", place / ".venv" / "bin", symlinks=True)
    shutil.copy2(ROOT / ".venv" / "pyvenv.cfg", place / ".venv")
    (place / ".venv" / "lib").symlink_to(ROOT / ".venv" / "lib")
    runtime = Path("build", "runtime")
    shutil.copytree(ROOT / runtime, place / runtime, symlinks=True)
    link = tmp_path / "vehicle tree"
    link.symlink_to(place)
    return link


def test_the_demo_runs_in_a_folder_with_blank_quotes_and_umlaut(tree: Path) -> None:
    """Set-up notices the move; C, Ada and assembly are compiled, the drive is driven."""
    environment = {"PATH": os.environ["PATH"], "HOME": os.environ["HOME"], "LANG": "C.UTF-8"}
    done = subprocess.run(
        ["make", "demo"], cwd=tree, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "Python packages" in done.stdout and "virtual brick " not in done.stdout
    assert (tree / "out" / "vehicle" / "report.html").is_file()
    activated = subprocess.run(
        ["bash", "-c", ". .venv/bin/activate && command -v ravenbrick"],
        cwd=tree,
        capture_output=True,
        text=True,
        check=False,
    )
    assert activated.stdout.strip() == str(tree.resolve() / ".venv" / "bin" / "ravenbrick")
