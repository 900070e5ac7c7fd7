# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`tools/setup` on a copy with a fake system: what it says when it cannot go on, and repairs."""

from __future__ import annotations

import os
import select
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = (
    "awk bash cat chmod cp cut dirname env flock getent grep head id mkdir mktemp mv rm setpriv "
    "sleep sort stat tail touch"
).split()
# A Python that knows what the set-up asks of it. Where there is a file `hold`, pip waits until it
# is gone.
PYTHON = """
case "$*" in
*"-m venv"*) mkdir -p "$CLONE/.venv/bin"; cp "$0" "$CLONE/.venv/bin/python" ;;
*"environment.py check"*)
    [[ -e "$CLONE/.venv/numpy" ]] || echo "numpy==1"
    [[ -e "$CLONE/.venv/virtual_brick.abi3.so" ]] || echo ":brick" ;;
*"-m pip install"*)
    touch "$MACHINE/pip-began"
    while [[ -e "$MACHINE/hold" ]]; do sleep 0.02; done
    touch "$CLONE/.venv/numpy" ;;
*sysconfig*) echo "$CLONE/.venv" ;;
*brick_digest*) echo 123 ;;
esac
"""
CARGO = """
[[ $1 != --version ]] || { echo "cargo 1.99.0"; exit; }
mkdir -p "$CLONE/virtual-brick/target/release"
touch "$CLONE/virtual-brick/target/release/libvirtual_brick.so"
"""
LONGEST_S = 60


def write_command(folder: Path, name: str, body: str) -> None:
    """An executable shell script in the fake PATH."""
    path = folder / name
    path.unlink(missing_ok=True)
    path.write_text(f"#!/bin/bash\n{body}\n")
    path.chmod(0o755)


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A clone on a Debian 12 machine without packages, without sudo, with an ordinary user."""
    clone = tmp_path / "clone"
    (clone / "tools").mkdir(parents=True)
    for name in ("setup", "pins.sh", "as_owner"):
        shutil.copy(ROOT / "tools" / name, clone / "tools" / name)
    commands = tmp_path / "bin"
    commands.mkdir()
    for name in COMMANDS:
        (commands / name).symlink_to(shutil.which(name) or f"/bin/{name}")
    write_command(commands, "dpkg-query", "exit 1")
    write_command(commands, "id", "echo 1000")
    write_command(commands, "python", PYTHON)
    write_command(commands, "cargo", CARGO)
    write_command(commands, "make", "exit 0")
    with (clone / "tools" / "pins.sh").open("a") as pins:
        pins.write(f"PYTHON={commands}/python\n")
    (tmp_path / "os-release").write_text('ID=debian\nVERSION_ID="12"\n')
    return tmp_path


def start_setup(machine: Path, *words: str) -> subprocess.Popen[str]:
    """Begin the copy of `tools/setup` with nothing but the fake PATH."""
    environment = {
        "PATH": str(machine / "bin"),
        "HOME": str(machine),
        "MACHINE": str(machine),
        "CLONE": str(machine / "clone"),
        "RAVENBRICK_OS_RELEASE": str(machine / "os-release"),
    }
    return subprocess.Popen(
        [str(machine / "clone" / "tools" / "setup"), *words],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        stdin=subprocess.DEVNULL,
    )


def run_setup(machine: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run it to its end."""
    with start_setup(machine, *words) as process:
        out, err = process.communicate(timeout=LONGEST_S)
        return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def install_all(machine: Path, *but: str) -> None:
    """All Debian packages are there, except some."""
    pins = ROOT / "tools" / "pins.sh"
    but_pattern = "|".join(but) or "none"
    write_command(
        machine / "bin",
        "dpkg-query",
        f'. {pins}; for p in "${{DEBIAN_PACKAGES[@]}}" "${{DEVELOP_PACKAGES[@]}}"; do\n'
        f'[[ $p =~ ^({but_pattern})$ ]] || echo "ii  $p"; done',
    )


@contextmanager
def held(machine: Path) -> Iterator[None]:
    """pip began and goes on afterwards, also when the test fails."""
    try:
        await_file(machine / "pip-began")
        yield
    finally:
        (machine / "hold").unlink(missing_ok=True)


def await_file(path: Path) -> None:
    """Wait until another process made the file."""
    end = time.monotonic() + LONGEST_S
    while not path.exists():
        assert time.monotonic() < end, f"{path.name} does not come"
        time.sleep(0.01)


def test_names_the_system_when_it_is_not_debian_12(machine: Path) -> None:
    """On another distribution the missing packages and the system found are named."""
    (machine / "os-release").write_text('ID=ubuntu\nVERSION_ID="24.04"\n')
    result = run_setup(machine)
    assert result.returncode == 3
    assert "ubuntu 24.04" in result.stderr
    assert "gnat-12-arm-linux-gnueabi" in result.stderr


def test_without_root_exactly_the_missing_packages_are_one_command(machine: Path) -> None:
    """A user gets a line to copy, and no advice that leaves files of root in the tree."""
    install_all(machine, "gprbuild", "gcc-arm-none-eabi")
    result = run_setup(machine)
    assert result.returncode == 4
    first, _, command, *_ = result.stderr.split("\n")
    assert first == (
        "setup: 2 Debian packages are missing; install them as root, then run this again:"
    )
    assert command.strip() == ("apt-get install --no-install-recommends gcc-arm-none-eabi gprbuild")
    assert "make setup" not in result.stderr


def test_packages_of_tests_are_asked_for_by_tests_only(machine: Path) -> None:
    """`make demo` does not need them."""
    install_all(machine, "gappa", "nbc")
    assert run_setup(machine).returncode == 0
    result = run_setup(machine, "develop")
    assert result.returncode == 4
    wanted = "--no-install-recommends gappa nbc"
    assert f"{wanted} nodejs npm rust-web-clippy rustfmt-web\n" in result.stderr
    for command in ("npm", "cargo-clippy"):
        write_command(machine / "bin", command, "exit 0")
    assert f"{wanted}\n" in run_setup(machine, "develop").stderr


def test_an_own_rust_without_clippy_is_left_as_it_is(machine: Path) -> None:
    """Debian's clippy does not fit it; its owner is told what to install."""
    install_all(machine)
    for command in ("npm", "rustup"):
        write_command(machine / "bin", command, "exit 0")
    result = run_setup(machine, "develop")
    assert result.returncode == 4
    assert "run 'rustup component add clippy rustfmt'" in result.stderr


def test_where_sudo_is_refused_the_command_is_one_with_sudo(machine: Path) -> None:
    """A sudo that refuses is not taken for a missing package."""
    write_command(machine / "bin", "sudo", "exit 1")
    result = run_setup(machine)
    assert result.returncode == 4
    assert "\n    sudo apt-get install --no-install-recommends gnat-12" in result.stderr


@pytest.mark.parametrize("letter", [":", "$", "\\", "#", "%"])
def test_a_path_that_the_tools_cannot_handle_is_told_at_once(machine: Path, letter: str) -> None:
    """Before anything is installed."""
    (machine / "clone").rename(machine / f"my {letter} clone")
    (machine / "clone").symlink_to(machine / f"my {letter} clone")
    result = run_setup(machine)
    assert result.returncode == 2
    assert result.stderr.startswith("setup: the path of the tree, '")
    assert f"contains '{letter}', which" in result.stderr
    assert "move the tree" in result.stderr


def test_asks_for_the_network_when_package_lists_fail(machine: Path) -> None:
    """A failing apt-get update is explained by its likely cause, with the log's name."""
    write_command(machine / "bin", "id", "echo 0")
    write_command(machine / "bin", "apt-get", "echo 'Temporary failure resolving'; exit 100")
    result = run_setup(machine)
    assert result.returncode == 4
    assert "network connection" in result.stderr
    log = result.stderr.partition("whole output is in ")[2].strip().rstrip(".")
    assert "Temporary failure resolving" in Path(log).read_text()
    assert not (machine / "clone" / "build").exists()


def test_asks_for_the_security_suite_when_the_packaged_rust_is_too_old(machine: Path) -> None:
    """An old cargo whose package is present is upgraded; else it says how to get a newer one."""
    write_command(machine / "bin", "id", "echo 0")
    install_all(machine)
    write_command(machine / "bin", "cargo", "echo 'cargo 1.85.0 (2025-02-20)'")
    write_command(machine / "bin", "apt-get", f'echo "$@" >> {machine}/asked')
    result = run_setup(machine)
    assert result.returncode == 4
    assert "rustc-web cargo-web" in (machine / "asked").read_text()
    assert "bookworm-security" in result.stderr


def test_an_empty_tree_is_set_up_and_then_nothing_is_done_again(machine: Path) -> None:
    """Each part says what it did."""
    install_all(machine)
    first = run_setup(machine)
    assert first.returncode == 0, first.stderr
    assert "Python packages      1 installed" in first.stdout
    assert "virtual brick        built" in first.stdout
    second = run_setup(machine)
    assert second.stdout.split("\n")[1].startswith("  all is there")


@pytest.mark.parametrize("lost", [".venv", ".venv/bin/python", ".venv/numpy", "build"])
def test_what_was_lost_is_made_again(machine: Path, lost: str) -> None:
    """No record of what was done before is believed."""
    install_all(machine)
    run_setup(machine)
    path = machine / "clone" / lost
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    assert run_setup(machine).returncode == 0
    assert (machine / "clone" / ".venv" / "bin" / "python").is_file()
    assert (machine / "clone" / ".venv" / "numpy").is_file()
    assert (machine / "clone" / ".venv" / "virtual_brick.abi3.so").is_file()


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
def test_a_set_up_that_was_killed_goes_on_next_time(machine: Path, by: signal.Signals) -> None:
    """In the middle of pip's work, which goes on only when the set-up could not stop it."""
    install_all(machine)
    (machine / "hold").touch()
    with start_setup(machine) as process, held(machine):
        process.send_signal(by)
        assert process.wait(LONGEST_S) != 0
    assert run_setup(machine).returncode == 0
    assert (machine / "clone" / ".venv" / "virtual_brick.abi3.so").is_file()


def test_of_two_set_ups_one_waits_and_says_so(machine: Path) -> None:
    """They would overwrite each other's files."""
    install_all(machine)
    (machine / "hold").touch()
    with start_setup(machine), held(machine), start_setup(machine) as second, held(machine):
        assert second.stdout is not None
        waiting = "another set-up of this tree is running"
        said = ""
        while waiting not in said and select.select([second.stdout], [], [], LONGEST_S)[0]:
            piece = os.read(second.stdout.fileno(), 1000).decode()
            assert piece, f"it ended after {said!r}"
            said += piece
        assert waiting in said
        (machine / "hold").unlink()
        assert second.wait(LONGEST_S) == 0


@pytest.mark.skipif(os.getuid() != 0, reason="only root can work in the tree of another user")
def test_root_leaves_nothing_of_its_own_in_the_tree_of_a_user(machine: Path) -> None:
    """It installs the packages; all else is done as the tree's owner."""
    user = 12_345
    for folder in machine.parents[:3]:
        folder.chmod(folder.stat().st_mode | 0o055)
    for path in (machine, *machine.rglob("*")):
        os.chown(path, user, user, follow_symlinks=False)
    (machine / "bin" / "id").unlink()
    (machine / "bin" / "id").symlink_to(shutil.which("id") or "/usr/bin/id")
    install_all(machine)
    (machine / "bin" / "dpkg-query").rename(machine / "dpkg-query")
    install_all(machine, "gprbuild")
    asked = 'cp "$MACHINE/dpkg-query" "$MACHINE/bin"; (id -u; echo "$@") >>"$MACHINE/asked"'
    write_command(machine / "bin", "apt-get", asked)
    result = run_setup(machine)
    assert result.returncode == 0, result.stderr
    words = (machine / "asked").read_text().split()
    assert (words[0], words[-2:]) == ("0", ["install", "gprbuild"])
    made = list((machine / "clone").rglob("*"))
    assert machine / "clone" / ".venv" / "numpy" in made
    assert {path.lstat().st_uid for path in made} == {user}


def test_is_quick_and_silent_about_installing_when_all_is_there() -> None:
    """On a machine that is set up nothing is installed or built again."""
    result = subprocess.run(
        [str(ROOT / "tools" / "setup")], capture_output=True, text=True, stdin=subprocess.DEVNULL
    )
    assert result.returncode == 0
    assert len(result.stdout.split("\n")) == 3, result.stdout
