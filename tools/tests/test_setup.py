# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What `tools/setup` says when it cannot go on: it runs here on a copy, with a fake system."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = ("bash", "cat", "dirname", "mkdir", "env", "tail", "grep", "id", "awk", "sort", "head")


def write_command(folder: Path, name: str, body: str) -> None:
    """An executable shell script in the fake PATH."""
    path = folder / name
    path.unlink(missing_ok=True)
    path.write_text(f"#!/bin/bash\n{body}\n")
    path.chmod(0o755)


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A clone on a Debian 12 machine without packages, without sudo, with an ordinary user."""
    (tmp_path / "clone" / "tools").mkdir(parents=True)
    for name in ("setup", "pins.sh"):
        shutil.copy(ROOT / "tools" / name, tmp_path / "clone" / "tools" / name)
    commands = tmp_path / "bin"
    commands.mkdir()
    for name in COMMANDS:
        (commands / name).symlink_to(shutil.which(name) or f"/bin/{name}")
    write_command(commands, "dpkg-query", "exit 1")
    write_command(commands, "id", "echo 1000")
    (tmp_path / "os-release").write_text('ID=debian\nVERSION_ID="12"\n')
    return tmp_path


def run_setup(machine: Path) -> subprocess.CompletedProcess[str]:
    """Run the copy of `tools/setup` with nothing but the fake PATH."""
    environment = {
        "PATH": str(machine / "bin"),
        "HOME": str(machine),
        "RAVENBRICK_OS_RELEASE": str(machine / "os-release"),
    }
    return subprocess.run(
        [str(machine / "clone" / "tools" / "setup")],
        env=environment,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=600,
    )


def test_names_the_system_when_it_is_not_debian_12(machine: Path) -> None:
    """On another distribution the missing packages and the system found are named."""
    (machine / "os-release").write_text('ID=ubuntu\nVERSION_ID="24.04"\n')
    result = run_setup(machine)
    assert result.returncode == 3
    assert "ubuntu 24.04" in result.stderr
    assert "gnat-12-arm-linux-gnueabi" in result.stderr


def test_says_to_run_as_root_when_there_is_no_sudo(machine: Path) -> None:
    """Without root and without sudo the sentence names what to do."""
    result = run_setup(machine)
    assert result.returncode == 4
    assert "there is no sudo" in result.stderr
    assert "Run 'make setup' once as root" in result.stderr


def test_says_so_when_sudo_is_refused(machine: Path) -> None:
    """A sudo that refuses is not taken for a missing package."""
    write_command(machine / "bin", "sudo", "exit 1")
    result = run_setup(machine)
    assert result.returncode == 4
    assert "sudo was refused" in result.stderr


def test_asks_for_the_network_when_package_lists_fail(machine: Path) -> None:
    """A failing apt-get update is explained by its likely cause, with the log's name."""
    write_command(machine / "bin", "id", "echo 0")
    write_command(machine / "bin", "apt-get", "echo 'Temporary failure resolving'; exit 100")
    result = run_setup(machine)
    assert result.returncode == 4
    assert "network connection" in result.stderr
    assert "build/setup/setup.log" in result.stderr


def test_asks_for_the_security_suite_when_the_packaged_rust_is_too_old(machine: Path) -> None:
    """An old cargo whose package is present is upgraded; else it says how to get a newer one."""
    write_command(machine / "bin", "id", "echo 0")
    write_command(machine / "bin", "dpkg-query", "echo ii")
    write_command(machine / "bin", "cargo", "echo 'cargo 1.85.0 (2025-02-20)'")
    write_command(machine / "bin", "apt-get", f'echo "$@" >> {machine}/asked')
    result = run_setup(machine)
    assert result.returncode == 4
    assert "install rustc-web cargo-web" in (machine / "asked").read_text()
    assert "bookworm-security" in result.stderr


def test_is_quick_and_silent_about_installing_when_all_is_there() -> None:
    """On a machine that is set up nothing is installed or built again."""
    result = subprocess.run(
        [str(ROOT / "tools" / "setup")], capture_output=True, text=True, stdin=subprocess.DEVNULL
    )
    assert result.returncode == 0
    assert "installing" not in result.stdout
    assert "building" not in result.stdout
