# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The drivers' objects that projects share, by the real toolchain: who takes them, and when not."""

from __future__ import annotations

import io
import os
import re
import shutil
import tarfile
import time
from pathlib import Path

import pytest
from elftools.elf.elffile import ELFFile
from verification.support.needed_tools import NEEDS_TOOLCHAIN
from verification.support.paths import ROOT

from ravenbrick.image.build import build_image
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.object_folders import COMPILED_WITH, same_objects
from ravenbrick.image.run_time import run_time_library
from ravenbrick.project.robot import read_robot
from ravenbrick.project.templates import create_project

MAIN = """with NXT.Fonts;
procedure Main is
   Seen : NXT.Fonts.Glyph := NXT.Fonts.Shape_Of ('a') with Volatile, Unreferenced;
begin
   null;
end Main;
"""
BUILDER = "package Builder is"
GLOBAL = f'{BUILDER}\n   for Global_Compilation_Switches ("Ada") use ("-fno-omit-frame-pointer");'


@pytest.fixture
def drivers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The sources of the drivers in a tree of its own, with the library of this one."""
    library = run_time_library(Settings.of(read_robot(ROOT / "examples" / "blank"), {}))
    for name in ("tools", "drivers", "examples/blank"):
        ignored = shutil.ignore_patterns("tests", "node_modules")
        shutil.copytree(ROOT / name, tmp_path / "home" / name, ignore=ignored)
    monkeypatch.setenv("RAVENBRICK_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("RAVENBRICK_BUILD", raising=False)
    monkeypatch.setattr("ravenbrick.image.build.run_time_library", lambda _settings: library)
    archives = tmp_path / "library"
    monkeypatch.setattr("ravenbrick.image.object_folders.run_time_home", lambda: archives)
    return tmp_path / "home" / "drivers"


def built(folder: Path, builder: str = BUILDER) -> tuple[list[bytes], set[str]]:
    """What is loaded of a new project, and the units of the drivers that were compiled for it."""
    workspace = create_project(folder, "blank")
    (workspace.project / "src" / "main.adb").write_text(MAIN)
    file = workspace.project / "robot.gpr"
    file.write_text(file.read_text().replace(BUILDER, builder))
    image = build_image(workspace, read_robot(workspace.project), "ram").image
    log = (workspace.build("ram") / "build.log").read_text()
    segments = ELFFile(io.BytesIO(image.content)).iter_segments("PT_LOAD")
    found = re.findall(r"/gnat1 .* -dumpbase (nxt[\w-]*)\.ad[bs] ", log)
    return [s.data() for s in segments], set(found)


@NEEDS_TOOLCHAIN
def test_a_project_takes_what_another_has_compiled_of_the_drivers(
    drivers: Path, tmp_path: Path
) -> None:
    """Until a source changes; then just what depends on it is compiled."""
    first, compiled = built(tmp_path / "first")
    assert {"nxt-fonts", "nxt-lcd", "nxt-avr_io"} <= compiled
    second, compiled = built(tmp_path / "second")
    assert not compiled
    assert second == first
    source = drivers / "src" / "display" / "nxt-fonts.ads"
    source.write_text(source.read_text().replace("'a' => (2#00100000#", "'a' => (2#00111000#"))
    before = time.time() - 10  # units that are compiled in the second of an edit are not kept
    os.utime(source, (before, before))
    changed, compiled = built(tmp_path / "third")
    assert compiled == {"nxt-fonts", "nxt-last_chance"}
    assert changed != first
    assert not built(tmp_path / "fourth")[1]


@pytest.mark.parametrize("record", [None, b"\xff"])
def test_nothing_comes_from_a_damaged_archive(record: bytes | None, tmp_path: Path) -> None:
    """One that is no archive, and one whose record is no text."""
    archive = tmp_path / "objects.tar"
    archive.write_bytes(b"no archive" * 200)
    if record is not None:
        with tarfile.open(archive, "w") as made:
            for name, content in (("nxt.o", b"object"), (COMPILED_WITH, record)):
                member = tarfile.TarInfo(name)
                member.size = len(content)
                made.addfile(member, io.BytesIO(content))
    with same_objects(tmp_path / "objects", {}, archive):
        assert not list((tmp_path / "objects").iterdir())


@NEEDS_TOOLCHAIN
def test_a_project_with_other_switches_for_all_units_compiles_and_keeps_its_own(
    drivers: Path, tmp_path: Path
) -> None:
    """It takes none of the usual ones, and others take none of these."""
    other, compiled = built(tmp_path / "other", GLOBAL)
    assert compiled
    image, again = built(tmp_path / "usual")
    assert again == compiled
    assert image != other
