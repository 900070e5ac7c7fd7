# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`tools/environment.py` on real environments: what it finds wrong, and what it repairs."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from ravenbrick.sources import brick_digest

ROOT = Path(__file__).resolve().parents[2]
ODD = "Räven's brick"
# A package that pip installed to its end.
NUMPY = "numpy-2.4.6.dist-info/INSTALLER"


@pytest.fixture(scope="module")
def pattern(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tree with nothing but an environment."""
    tree = tmp_path_factory.mktemp("pattern")
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", tree / ".venv"], check=True)
    (tree / "tools").mkdir()
    shutil.copy(ROOT / "tools" / "environment.py", tree / "tools")
    package = tree / "host" / "src" / "ravenbrick"
    package.mkdir(parents=True)
    shutil.copy(ROOT / "host" / "src" / "ravenbrick" / "sources.py", package)
    (package / "__init__.py").touch()
    (package / "cli.py").write_text("def main():\n    print('the command')\n")
    (tree / "requirements").write_text("# direct\nnumpy==2.4.6\n")
    site = site_of(tree)
    (site / "pip").mkdir()
    file(site / NUMPY)
    (site / "virtual_brick.py").write_text(f"JIT = False\nSOURCES = '{brick_digest(tree)}'\n")
    assert tool(tree, "check", "requirements") == [":link"]
    tool(tree, "link")
    assert tool(tree, "check", "requirements") == []
    return tree


@pytest.fixture
def tree(pattern: Path, tmp_path: Path) -> Path:
    """A copy that was put in order where it lies, in a folder with blank, quote and umlaut."""
    tree = tmp_path / ODD
    shutil.copytree(pattern, tree, symlinks=True)
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", tree / ".venv"], check=True)
    assert tool(tree, "check", "requirements") == []
    return tree


def file(path: Path) -> None:
    """An empty file in a folder of its own."""
    path.parent.mkdir(parents=True)
    path.touch()


def site_of(tree: Path) -> Path:
    """The folder of the installed packages."""
    (site,) = tree.glob(".venv/lib/python3.*/site-packages")
    return site


def tool(tree: Path, *words: str) -> list[str]:
    """The lines of an answer."""
    done = subprocess.run(
        [tree / ".venv/bin/python", "-I", "tools/environment.py", *words],
        cwd=tree,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_an_environment_that_was_not_made_to_its_end_is_made_again(tree: Path) -> None:
    """The script `activate` is the last that is made."""
    (tree / ".venv" / "bin" / "activate").unlink()
    assert tool(tree, "check", "requirements") == [":all", ":brick"]


def test_a_moved_tree_is_noticed_and_its_command_works_all_the_same(tree: Path) -> None:
    """Only `activate` names the old folder."""
    moved = tree.with_name("moved, ünd also")
    tree.rename(moved)
    assert tool(moved, "check", "requirements") == [":place"]
    command = moved / ".venv" / "bin" / "ravenbrick"
    assert subprocess.run([command], capture_output=True, text=True).stdout == "the command\n"
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", moved / ".venv"], check=True)
    assert tool(moved, "check", "requirements") == []


def test_the_command_works_by_a_symbolic_link_elsewhere(tree: Path) -> None:
    """It looks for its Python beside the file that it is."""
    link = tree.parent / "ravenbrick"
    link.symlink_to(tree / ".venv" / "bin" / "ravenbrick")
    assert subprocess.run([link], capture_output=True, text=True).stdout == "the command\n"


def test_a_worker_process_that_reads_the_command_again_does_not_run_it(tree: Path) -> None:
    """The processes of `ravenbrick sweep` are spawned and read the program by another name."""
    program = tree / ".venv" / "bin" / "ravenbrick"
    code = f"import runpy; runpy.run_path({str(program)!r}, run_name='__mp_main__')"
    python = tree / ".venv" / "bin" / "python"
    assert subprocess.run([python, "-c", code], capture_output=True, text=True).stdout == ""


def test_programs_that_pip_installed_do_not_name_the_folder(tree: Path) -> None:
    """Whichever of its two ways it has named it."""
    bin_folder = tree / ".venv" / "bin"
    python = bin_folder / "python"
    (bin_folder / "plain").write_text("#!/a/.venv/bin/python\nprint(1)\n")
    (bin_folder / "odd").write_text(
        f"#!/bin/sh\n'''exec' \"{python}\" \"$0\" \"$@\"\n' '''\nprint(2)\n"
    )
    tool(tree, "link")
    for name, said in (("plain", "1\n"), ("odd", "2\n")):
        program = bin_folder / name
        program.chmod(0o755)
        assert "/a/" not in program.read_text() and ODD not in program.read_text()
        assert subprocess.run([program], capture_output=True, text=True).stdout == said


@pytest.mark.parametrize("found", [[], ["numpy-2.4.5"], ["numpy-2.4.6", "numpy-2.4.5"]])
def test_a_package_of_another_version_is_installed_again(tree: Path, found: list[str]) -> None:
    """Also where pip was killed between the old and the new one."""
    shutil.rmtree((site_of(tree) / NUMPY).parent)
    for name in found:
        file(site_of(tree) / f"{name}.dist-info" / "INSTALLER")
    assert tool(tree, "check", "requirements") == ["numpy==2.4.6"]


def test_a_package_that_pip_left_half_installed_is_forgotten(tree: Path) -> None:
    """Else pip takes it for installed."""
    (site_of(tree) / NUMPY).unlink()
    assert tool(tree, "check", "requirements") == ["numpy==2.4.6"]
    tool(tree, "forget")
    assert not (site_of(tree) / NUMPY).parent.exists()


def test_a_copied_tree_does_not_run_the_command_of_the_one_it_was_copied_from(tree: Path) -> None:
    """As pip's editable installation would."""
    old = site_of(tree) / "__editable__.ravenbrick-0.1.0.pth"
    old.write_text(f"{ROOT / 'host' / 'src'}\n")
    (site_of(tree) / "ravenbrick.pth").unlink()
    assert tool(tree, "check", "requirements") == [":link"]
    tool(tree, "link")
    assert not old.exists()
    assert tool(tree, "check", "requirements") == []


@pytest.mark.parametrize(
    "content", [None, "", "SOURCES = 'other'\nNATIVE = False\n", "import absent"]
)
def test_a_brick_that_is_absent_broken_or_of_other_sources_is_built(
    tree: Path, content: str | None
) -> None:
    """The module itself says what it was built from."""
    module = site_of(tree) / "virtual_brick.py"
    module.unlink()
    if content is not None:
        module.write_text(content)
    assert tool(tree, "check", "requirements") == [":brick"]


def test_jit_code_is_built_when_asked_for_and_kept(tree: Path) -> None:
    """A later set-up, after a change of the sources, builds it again with JIT code."""
    assert tool(tree, "check", "requirements", "native") == [":brick"]
    module = site_of(tree) / "virtual_brick.py"
    module.write_text(module.read_text().replace("False", "True"))
    assert tool(tree, "check", "requirements", "native") == [":native"]
    (tree / "virtual-brick").mkdir()
    (tree / "virtual-brick" / "Cargo.toml").touch()
    assert tool(tree, "check", "requirements") == [":native", ":brick"]


def test_another_python_is_noticed(tree: Path) -> None:
    """Its packages are elsewhere, so there are none."""
    os.rename(site_of(tree).parent, site_of(tree).parent.with_name("python3.9"))
    assert tool(tree, "check", "requirements") == [
        ":all",
        ":brick",
        ":link",
        ":brick",
        "numpy==2.4.6",
    ]
