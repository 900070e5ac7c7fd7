# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick doctor` tries what other commands need and says how to install what is missing."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
import virtual_brick
from typer.testing import CliRunner

from ravenbrick import __version__, installation
from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode

ROOT = Path(__file__).resolve().parents[3]
INSTALL = "run 'apt-get install --no-install-recommends"
GNAT, LINKER = "arm-linux-gnueabi-gcc-12", "arm-none-eabi-gcc"


def doctor(code: ExitCode = ExitCode.TOOL_MISSING) -> str:
    """Run the command; the sentence that it ends with, or its table when all is well."""
    result = CliRunner().invoke(app, ["doctor"], env={"COLUMNS": "200"})
    assert result.exit_code == code, result.output
    return result.stderr.split("\n")[0] if code else result.stdout


@pytest.fixture
def commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of programs in front of the PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")
    return folder


def script(folder: Path, name: str, body: str) -> None:
    """A program of the shell."""
    (folder / name).write_text(f"#!/bin/sh\n{body}\n")
    (folder / name).chmod(0o755)


@pytest.mark.skipif(shutil.which(GNAT) is None, reason="the cross toolchain is not installed")
def test_a_complete_machine_has_a_compiler_a_linker_and_the_module() -> None:
    """Each is tried, not only found."""
    table = doctor(ExitCode.OK)
    for line in (rf"{GNAT} +ok +GNAT 12\.\S+ for arm-", rf"{LINKER} +ok +GCC", "links"):
        assert re.search(line, table), line
    assert re.search(rf"Python module virtual_brick +ok +{re.escape(__version__)}", table)


def test_one_command_installs_all_missing_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    """The packages are those that the set-up installs."""
    monkeypatch.setenv("PATH", "")
    sentence = doctor()
    assert sentence.startswith("ravenbrick: missing: ")
    (line,) = re.findall(
        r"run 'apt-get install --no-install-recommends ([^']+)' as root$", sentence
    )
    assert {"gprbuild", "gnat-12-arm-linux-gnueabi", "libnewlib-arm-none-eabi"} <= set(line.split())
    pins = (ROOT / "tools" / "pins.sh").read_text().split()
    assert set(line.split()) <= set(pins)


def test_a_compiler_without_ada_is_no_compiler(commands: Path) -> None:
    """The package of the C compiler alone has the same program."""
    script(commands, GNAT, "echo \"cc: fatal error: cannot execute 'gnat1'\" >&2; exit 1")
    assert doctor().endswith(f"{INSTALL} gnat-12-arm-linux-gnueabi' as root")
    result = CliRunner().invoke(app, ["doctor"])
    assert f"{GNAT}: does not work: cc: fatal error: cannot execute 'gnat1'" in result.stderr


def test_another_gnat_is_refused(commands: Path) -> None:
    """The run-time's sources are those of GNAT 12."""
    script(
        commands,
        GNAT,
        f'case "$*" in *-dumpfullversion*) echo 13.2.0;; *) exec /usr/bin/{GNAT} "$@";; esac',
    )
    doctor()
    result = CliRunner().invoke(app, ["doctor"])
    assert "is GNAT 13.2.0 for arm-linux-gnueabi; it must be GNAT 12 for ARM" in result.stderr


def test_a_linker_without_the_c_library_names_its_package(commands: Path) -> None:
    """Debian only recommends the C library beside the linker."""
    missing = "ld: cannot find -lm: No such file or directory"
    script(
        commands,
        LINKER,
        f'case "$*" in *-lm*) echo "{missing}" >&2; exit 1;; *) exec /usr/bin/{LINKER} "$@";; esac',
    )
    assert doctor().endswith(f"{INSTALL} libnewlib-arm-none-eabi' as root")


@pytest.mark.parametrize("fact", ["__version__", "SOURCES"])
def test_a_module_of_another_version_is_told(monkeypatch: pytest.MonkeyPatch, fact: str) -> None:
    """In a checkout the set-up builds the right one, elsewhere the wheel has it."""
    monkeypatch.setattr(virtual_brick, fact, "0.0.1")
    assert doctor() == "ravenbrick: missing: Python module virtual_brick; run 'make setup'"
    if fact == "__version__":
        monkeypatch.setattr(installation, "PACKAGE", Path("/usr/lib/python3/ravenbrick"))
        wheel = f"install the wheel of ravenbrick {__version__} again"
        assert wheel in doctor() and "make" not in doctor()


def test_an_absent_python_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what pyproject.toml asks for."""
    requirements = ["no-such-package>=2", "not-asked-for; extra == 'export'"]
    monkeypatch.setattr("importlib.metadata.requires", lambda _name: requirements)
    monkeypatch.setattr("ravenbrick.cli.doctor.PACKAGE", Path("/no/checkout"))
    assert doctor() == "ravenbrick: missing: Python package no-such-package; run 'make setup'"
