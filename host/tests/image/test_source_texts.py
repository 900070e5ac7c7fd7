# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Texts of the sources that an image's debug information names, for the page."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from verification.support.elf_files import make_elf

from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.source_texts import source_texts

TEXT = "void _start(void) { for (;;) ; }\n"
FLAGS = ("-mcpu=arm7tdmi", "-g", "-nostdlib", "-Wl,-Ttext=0x202000")


def built(source: Path) -> ElfImage:
    """An image of one C file."""
    source.parent.mkdir(parents=True, exist_ok=True)
    source.write_text(TEXT)
    elf = source.with_suffix(".elf")
    subprocess.run(["arm-none-eabi-gcc", *FLAGS, source, "-o", elf], check=True)
    return read_image(elf)


pytestmark = pytest.mark.skipif(
    shutil.which("arm-none-eabi-gcc") is None, reason="gcc-arm-none-eabi is not installed"
)


def test_a_source_of_the_project_comes_by_its_path_in_the_debug_information(
    tmp_path: Path,
) -> None:
    """As the page asks for it."""
    source = tmp_path / "robot" / "src" / "main.c"
    image = built(source)
    assert source_texts(image, [tmp_path / "other", tmp_path / "robot"]) == {str(source): TEXT}


def test_a_project_that_was_moved_after_the_build_has_its_sources(tmp_path: Path) -> None:
    """The path below the project's folder counts."""
    source = tmp_path / "here" / "robot" / "src" / "main.c"
    image = built(source)
    (tmp_path / "here").rename(tmp_path / "there")
    assert source_texts(image, [tmp_path / "there" / "robot"]) == {str(source): TEXT}


def test_no_file_outside_the_named_folders_is_given(tmp_path: Path) -> None:
    """Neither beside them, nor through a symbolic link, nor of another kind."""
    image = built(tmp_path / "elsewhere" / "main.c")
    assert source_texts(image, [tmp_path / "robot"]) == {}
    source = tmp_path / "robot" / "main.c"
    image = built(source)
    source.unlink()
    source.symlink_to(tmp_path / "elsewhere" / "main.c")
    assert source_texts(image, [tmp_path / "robot"]) == {}
    secret = tmp_path / "robot" / "robot.toml"
    secret.write_text("secret")
    source.unlink()
    source.symlink_to(secret)
    assert source_texts(image, [tmp_path / "robot"]) == {}


def test_an_image_without_debug_information_has_no_sources(tmp_path: Path) -> None:
    """Nor has one whose debug information is damaged."""
    file = tmp_path / "image.elf"
    file.write_bytes(make_elf())
    assert source_texts(read_image(file), [tmp_path]) == {}
