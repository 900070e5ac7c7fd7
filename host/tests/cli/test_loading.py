# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each command loads what it uses; the program answers quickly where it computes nothing."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.projects import VEHICLE

import ravenbrick.cli
from ravenbrick.cli import VERSION_LINE
from ravenbrick.cli.app import COMMANDS, ELSEWHERE, app

FOLDER = Path(ravenbrick.cli.__file__).parent
LIBRARIES = {"control", "matplotlib"}
LIBRARIES |= {f"scipy.{name}" for name in ("linalg", "optimize", "signal", "sparse")}
SLOW = LIBRARIES | {"scipy.interpolate", "rich", "jinja2", "jsonschema"}
# Without what is only prepared to be loaded.
NAMES = "(n for n, m in sys.modules.items() if m and type(m).__name__ != '_LazyModule')"
PROGRAM = f"""
import atexit, sys
atexit.register(lambda: print(*{NAMES}, file=sys.stderr))
from ravenbrick.cli import main
main()
"""


def called(*words: str, **variables: str) -> tuple[str, set[str]]:
    """What the program prints, and the modules that it has loaded at its end."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words],
        capture_output=True,
        text=True,
        env={**os.environ, **variables},
    )
    return done.stdout, set(done.stderr.splitlines()[-1].split())


def test_every_command_of_a_module_is_listed() -> None:
    """And each stands in the module that is loaded for it."""
    found = {
        name.replace("_", "-"): file.stem
        for file in FOLDER.glob("*.py")
        for name in re.findall(r"^@command\(.*\)\ndef (\w+)_command\(", file.read_text(), re.M)
    }
    assert found == {name: ELSEWHERE.get(name, name) for name in COMMANDS}


def test_the_version_loads_no_command_line_and_is_the_one_of_the_command_line() -> None:
    printed, loaded = called("--version")
    assert printed == CliRunner().invoke(app, ["--version"]).stdout == VERSION_LINE + "\n"
    assert not loaded & {"typer", "numpy", "ravenbrick.errors"}


@pytest.mark.parametrize("words", [[], ["--help"]])
def test_help_lists_every_command_once_and_loads_none(words: list[str]) -> None:
    printed, loaded = called(*words)
    assert [printed.count(f"\n  {name} ") for name in COMMANDS] == [1] * len(COMMANDS)
    assert not loaded & (SLOW | {"numpy"})
    assert {name for name in loaded if name.startswith("ravenbrick.cli.")} == {"ravenbrick.cli.app"}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_command_word_is_completed_without_loading_a_command(shell: str) -> None:
    typed = {"COMP_WORDS": "ravenbrick re", "COMP_CWORD": "1"}
    typed |= {"_TYPER_COMPLETE_ARGS": "ravenbrick re", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    printed, loaded = called(_RAVENBRICK_COMPLETE=f"complete_{shell}", **typed)
    assert "report" in printed and "run" not in printed
    assert not loaded & (SLOW | {"numpy"})


def test_the_options_of_a_command_are_completed() -> None:
    variables = {"_RAVENBRICK_COMPLETE": "complete_bash", "COMP_CWORD": "2"}
    printed, loaded = called(**variables, COMP_WORDS="ravenbrick new --t")
    assert printed.split() == ["--template"]
    assert not loaded & (SLOW | {"numpy"})


def test_completion_is_installed_for_the_shell(tmp_path: Path) -> None:
    """In the user's own files; a shell that reads them completes a command."""
    done = subprocess.run(
        ["bash", "-c", f'{sys.executable} -c "$0" --install-completion; true', PROGRAM],
        capture_output=True,
        text=True,
        env={**os.environ, "HOME": str(tmp_path)},
    )
    assert "completion installed" in done.stdout, done.stderr
    assert (tmp_path / ".bashrc").is_file()


def test_a_reader_that_goes_away_is_no_error() -> None:
    """As in `ravenbrick home | true`."""
    reading, writing = os.pipe()
    os.close(reading)
    program = "from ravenbrick.cli import main; main()"
    command = [sys.executable, "-c", program, "home"]
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True)
    os.close(writing)
    assert done.stderr == ""


def imported(module: str) -> set[str]:
    """The modules that a command's module loads."""
    program = f"import sys, ravenbrick.cli.{module}; print(*{NAMES})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    return set(done.stdout.split())


def test_commands_load_what_they_compute_with() -> None:
    assert not imported("run") & (SLOW | {"elftools"})
    assert not imported("build") & (SLOW | {"elftools", "numpy"})
    assert not imported("design") & SLOW


@pytest.mark.parametrize("name", ["vehicle", "motor-bench"])
def test_c_is_generated_without_loading_a_library_of_pictures_or_control(
    name: str, tmp_path: Path
) -> None:
    """From a whole design script; its simulations come after the C."""
    program = f"""
import runpy, sys
sys.argv = ["design.py", "--generated", {str(tmp_path)!r}]
import ravenbrick.control.design.design as simulations
simulations.encoder_run = lambda *_, **__: sys.exit(print(*{NAMES}))
runpy.run_path("design.py", run_name="__main__")
"""
    folder = VEHICLE.parent / name
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True
    )
    assert (tmp_path / "functional.c").read_bytes() == (
        folder / "generated" / "functional.c"
    ).read_bytes(), done.stderr
    loaded = set(done.stdout.split())
    assert "ravenbrick.codegen" in loaded
    assert not loaded & {"control", "matplotlib", "scipy.signal", "scipy.stats"}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_a_command_loads_no_numerical_library(name: str) -> None:
    """They take two seconds of processor time."""
    printed, loaded = called(name, "--help")
    assert COMMANDS[name].split()[0] in printed
    assert not loaded & SLOW
