# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A command whose process is there before its words, and the scripts that it runs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from verification.support.needed_tools import NEEDS_TOOLCHAIN

from ravenbrick import subprocesses
from ravenbrick.project.templates import create_project
from ravenbrick.studio.runner import RAVENBRICK
from ravenbrick.subprocesses import run_script

SCRIPT = """
import sys
from pathlib import Path
print(__name__, sys.argv[1:], Path(__file__).resolve().parent == Path.cwd())
{end}
"""

# The prepared command line, which prints at its end what it loaded after it was prepared.
WATCHED = """
import atexit, json, sys
from ravenbrick.cli import prepared
prepared.prepare()
before = set(sys.modules)
atexit.register(lambda: print(json.dumps(sorted(set(sys.modules) - before))))
prepared.main()
"""


def prepared(line: str) -> subprocess.CompletedProcess[str]:
    """The prepared command line after this first line of input."""
    return subprocess.run(RAVENBRICK, input=line, capture_output=True, text=True, check=False)


def test_a_prepared_command_takes_its_words_from_its_input() -> None:
    """It answers as the command line, with its exit codes."""
    done = prepared(json.dumps(["build", "nowhere", "--json"]) + "\n")
    plain = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
    other = subprocess.run(
        [*plain, "build", "nowhere", "--json"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (other.returncode, other.stdout)
    assert not json.loads(done.stdout)["ok"]


def test_a_prepared_command_without_words_does_nothing() -> None:
    """Nobody needs it any more."""
    done = prepared("")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@NEEDS_TOOLCHAIN
def test_a_prepared_command_has_loaded_what_its_build_needs(tmp_path: Path) -> None:
    """After its words it loads modules of Python itself at most, as others take long."""
    project = create_project(tmp_path / "robot", "blank").project
    line = json.dumps(["build", str(project), "--json"])
    done = subprocess.run(
        [sys.executable, "-c", WATCHED], input=line, capture_output=True, text=True, check=True
    )
    late = json.loads(done.stdout.splitlines()[-1])
    assert [name for name in late if name.split(".")[0] not in sys.stdlib_module_names] == []


@pytest.mark.parametrize("end", ["", "sys.exit(3)", "raise ValueError('no motor')"])
def test_a_script_in_a_copy_of_a_process_does_what_it_does_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: str
) -> None:
    """Exit code, what it printed, and the last line and the place of its error."""
    (tmp_path / "design.py").write_text(SCRIPT.format(end=end))
    words = ["design.py", "--results", "x.json"]
    alone = run_script(words, tmp_path)
    monkeypatch.setattr(subprocesses, "scripts_share_libraries", True)
    copied = run_script(words, tmp_path)
    assert copied.returncode == alone.returncode
    first, last = alone.stdout.splitlines()[0], alone.stdout.splitlines()[-1]
    assert copied.stdout.splitlines()[0] == first == "__main__ ['--results', 'x.json'] True"
    assert copied.stdout.splitlines()[-1] == last
    if "raise" in end:
        assert 'design.py", line 5' in copied.stdout and 'design.py", line 5' in alone.stdout
