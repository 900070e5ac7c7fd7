# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from verification.support.elf_files import make_elf

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.memory import memory_report
from ravenbrick.project.robot import Robot
from ravenbrick.trace.recording import Thread
from ravenbrick.trace.stacks import with_stacks


def _written(folder: Path, content: bytes) -> Path:
    path = folder / "some.elf"
    path.write_bytes(content)
    return path


def _image(folder: Path, **sizes: Any) -> ElfImage:
    return read_image(_written(folder, make_elf(**sizes)))


def test_sections_and_symbols_of_an_image_are_read(tmp_path: Path) -> None:
    """Sizes by kind, the entry and the symbols' addresses are those of the file."""
    image = _image(tmp_path, text_size=100, data_size=20, bss_size=300)
    assert [image.size_of(kind) for kind in ("text", "data", "bss")] == [100, 20, 300]
    assert image.symbols["vehicle_setpoint_right"].address == 0x202000 + 120 + 4
    assert (image.kind, image.entry) == ("ram", 0x202000)


def test_a_flash_image_is_recognised(tmp_path: Path) -> None:
    """The entry tells where the image runs."""
    assert _image(tmp_path, base=0x100000).kind == "flash"


def test_a_missing_image_says_how_to_build_it(tmp_path: Path) -> None:
    """The sentence ends with what to do."""
    with pytest.raises(ImageFileError, match="no such image; build it with 'ravenbrick build'"):
        read_image(tmp_path / "absent.elf")


@pytest.mark.parametrize("share", [0.0, 0.03, 0.08, 0.2, 0.5, 0.8, 0.99])
def test_an_image_cut_anywhere_is_refused(tmp_path: Path, share: float) -> None:
    """Every truncation is noticed."""
    whole = make_elf()
    path = _written(tmp_path, whole[: int(share * len(whole))])
    with pytest.raises(ImageFileError, match=r"truncated|not an ELF file"):
        read_image(path)


def test_no_truncation_to_any_length_passes(tmp_path: Path) -> None:
    """Byte by byte."""
    whole = make_elf()
    for length in range(len(whole)):
        with pytest.raises(ImageFileError):
            read_image(_written(tmp_path, whole[:length]))


def test_an_image_for_another_processor_is_refused(tmp_path: Path) -> None:
    """An x86 program is not for the brick."""
    with pytest.raises(ImageFileError, match=r"is for machine 62, not for ARM"):
        read_image(_written(tmp_path, make_elf(machine=62)))


def test_an_image_too_large_for_ram_is_refused(tmp_path: Path) -> None:
    """The sentence has the number of bytes that are too many."""
    with pytest.raises(ImageFileError, match="is 80 bytes too large for the RAM"):
        _image(tmp_path, text_size=64, data_size=16, bss_size=57_344)


def test_an_image_where_no_memory_is_is_refused(tmp_path: Path) -> None:
    """The sentence names the address."""
    with pytest.raises(ImageFileError, match="0x20000000, where the brick has no memory"):
        _image(tmp_path, base=0x2000_0000)


def test_the_memory_report_adds_up(tmp_path: Path, robot: Robot) -> None:
    """A RAM image uses text, data and bss of the 57344 bytes; a flash image text and data."""
    report = memory_report(_image(tmp_path, text_size=100, data_size=20, bss_size=300), robot)
    assert (report.used, report.available) == (420, 57_344)
    flash = _image(tmp_path, base=0x100000, text_size=100, data_size=20, bss_size=300)
    assert memory_report(flash, robot).used == 120


def test_the_memory_report_sums_the_link_map_by_part(tmp_path: Path, robot: Robot) -> None:
    """Each input section is counted for the part of the program that it comes from."""
    (robot.directory / "generated").mkdir()
    (robot.directory / "generated" / "functional.c").touch()
    image = _image(tmp_path)
    image.path.with_suffix(".map").write_text(
        "Discarded input sections\n\n .text 0x00000000 0x1000 drivers/gone.o\n\n"
        "Linker script and memory map\n\n"
        " .text.a         0x00202000       0x20 /t/build/runtime/adalib/librt.a(a.o)\n"
        " .text.very_long_name_of_a_section\n"
        "                0x00202020       0x10 /t/build/drivers/objects/nxt.o\n"
        " .bss            0x00203000       0x40 /t/build/vehicle/objects/arm/tasks.o\n"
        " .text.step      0x00202040       0x18 libvehicle.a(functional.o)\n"
        " .rodata.x       0x00202030        0x8 /usr/lib/gcc/libgcc.a(_udivsi3.o)\n"
    )
    assert memory_report(image, robot).parts == {
        "application": {"text": 0, "data": 0, "bss": 64},
        "compiler's library": {"text": 8, "data": 0, "bss": 0},
        "drivers": {"text": 16, "data": 0, "bss": 0},
        "generated C": {"text": 24, "data": 0, "bss": 0},
        "run-time": {"text": 32, "data": 0, "bss": 0},
    }


def test_stacks_keep_the_highest_mark_of_all_runs(tmp_path: Path, robot: Robot) -> None:
    """A later run with less use does not lower the mark."""
    report = memory_report(_image(tmp_path), robot)
    report = with_stacks(report, [Thread("control_task", 2, 4096, 900)])
    report = with_stacks(report, [Thread("control_task", 2, 4096, 800)])
    control = next(task for task in report.tasks if task.name == "control_task")
    assert (control.storage_size_bytes, control.used_bytes) == (4096, 900)
    assert [task.name for task in report.tasks if task.used_bytes is None] == [
        "coprocessor_task",
        "display_task",
    ]
