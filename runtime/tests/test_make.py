# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A change compiles again what it reaches, and nothing else."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from verification.support.bricks.runtime_programs import RUNTIMES, make_runtime
from verification.support.paths import ROOT


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the run-time's sources beside its library, with the times of all files."""
    make_runtime("arm")
    shutil.copytree(ROOT / "runtime", tmp_path / "runtime")
    (tmp_path / "tools").mkdir()
    shutil.copy2(ROOT / "tools" / "toolchain.mk", tmp_path / "tools")
    shutil.copytree(RUNTIMES["arm"], tmp_path / "build" / "runtime" / "ravenscar")
    return tmp_path


def compiled_after(tree: Path, change: str) -> set[str]:
    """The units that make compiles when a comment is added to a file."""
    objects = sorted((tree / "build" / "runtime" / "ravenscar" / "adalib").glob("*.o"))
    before = {path: path.stat().st_mtime_ns for path in objects}
    with (tree / "runtime" / change).open("a") as file:
        file.write("--  changed\n")
    subprocess.run(["make", "-s", "-C", tree / "runtime"], check=True)
    return {path.stem for path in objects if path.stat().st_mtime_ns != before[path]}


def test_a_body_is_compiled_with_the_units_that_have_it_in_line(tree: Path) -> None:
    """Nobody compiles Check of the supervision in line, but some do so with Make_Ready."""
    assert compiled_after(tree, "kernel/ravenbrick-supervision.adb") == {"ravenbrick-supervision"}
    again = compiled_after(tree, "kernel/ravenbrick-threads.adb")
    assert {"ravenbrick-threads", "ravenbrick-delays", "s-tposen"} <= again
    assert not again & {"a-tags", "ravenbrick-supervision"}


def test_the_users_of_a_specification_are_compiled_again(tree: Path) -> None:
    """Delays and the supervision report failures."""
    again = compiled_after(tree, "kernel/ravenbrick-failures.ads")
    assert {"ravenbrick-failures", "ravenbrick-delays", "ravenbrick-supervision"} <= again
    assert "a-tags" not in again
