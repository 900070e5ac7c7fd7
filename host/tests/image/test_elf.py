# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import pytest
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection
from verification.support.elf_files import make_elf
from verification.support.projects import VEHICLE

from ravenbrick.errors import ImageFileError
from ravenbrick.image.elf import ElfImage, read_image
from ravenbrick.image.memory import memory_report
from ravenbrick.project.robot import Robot
from ravenbrick.project.workspace import Workspace
from ravenbrick.trace.recording import Thread
from ravenbrick.trace.stacks import with_stacks

VEHICLE_ELF = Workspace.of(VEHICLE).image("ram", "vehicle")


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


def _altered(content: bytes) -> bytes:
    """Another load address, a segment with bytes that is not loaded, an undefined symbol."""
    elf, changed = ELFFile(io.BytesIO(content)), bytearray(content)
    empty, loaded, stack = (elf["e_phoff"] + elf["e_phentsize"] * n for n in range(3))
    assert changed[empty + 16 : empty + 20] == bytes(4)
    changed[loaded + 13] += 0x10
    changed[stack + 16] = 16
    symbols = elf.get_section_by_name(".symtab")
    assert isinstance(symbols, SymbolTableSection)
    defined = next(
        n for n, s in enumerate(symbols.iter_symbols()) if s["st_info"].type == "STT_FUNC"
    )
    section = symbols["sh_offset"] + symbols["sh_entsize"] * defined + 14
    changed[section : section + 2] = bytes(2)
    return bytes(changed)


@pytest.mark.skipif(not VEHICLE_ELF.is_file(), reason="the vehicle is not built")
@pytest.mark.parametrize("altered", [False, True])
def test_an_image_is_read_as_pyelftools_reads_it(tmp_path: Path, altered: bool) -> None:
    """A library that we did not write."""
    content = VEHICLE_ELF.read_bytes()
    image = read_image(_written(tmp_path, _altered(content) if altered else content))
    assert (image.content == content) != altered
    elf = ELFFile(io.BytesIO(image.content))
    found = [section for section in elf.iter_sections() if section["sh_flags"] & 2]
    expected = [(s.name, s["sh_addr"], s["sh_size"]) for s in found if s["sh_size"]]
    assert [(s.name, s.address, s.size) for s in image.sections] == sorted(
        expected, key=lambda section: section[1]
    )
    symbols = {
        symbol.name: (symbol["st_value"], symbol["st_size"])
        for table in elf.iter_sections()
        if isinstance(table, SymbolTableSection)
        for symbol in table.iter_symbols()
        if symbol.name and symbol["st_shndx"] != "SHN_UNDEF"
    }
    assert {name: (s.address, s.size) for name, s in image.symbols.items()} == symbols
    segments = [s for s in elf.iter_segments("PT_LOAD") if s["p_filesz"]]
    assert image.loaded_parts() == [(s["p_paddr"], s.data()) for s in segments]
    for segment in segments:
        last = segment["p_vaddr"] + segment["p_filesz"] - 2
        assert image.bytes_at(segment["p_vaddr"] + 4, 8) == segment.data()[4:12]
        assert image.bytes_at(last, 8) == segment.data()[-2:]


@pytest.mark.parametrize("place", [42, 46])
def test_tables_with_entries_of_another_size_are_damaged(tmp_path: Path, place: int) -> None:
    """The two sizes of the file's header."""
    whole = bytearray(make_elf())
    whole[place : place + 2] = (8).to_bytes(2, "little")
    with pytest.raises(ImageFileError, match="is damaged"):
        read_image(_written(tmp_path, bytes(whole)))


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
