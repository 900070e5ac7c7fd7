# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A function of an ARM image run by an emulator without hardware around it."""

from __future__ import annotations

from pathlib import Path

from verification.support.codegen.c_build import START


def run_on_arm(unicorn, image: Path, entry: str):  # type: ignore[no-untyped-def]
    """Call `entry` of the image; returns a reader of 32-bit variables by name."""
    from elftools.elf.elffile import ELFFile
    from unicorn.arm_const import UC_ARM_REG_LR, UC_ARM_REG_SP

    machine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_ARM)
    machine.mem_map(0x0020_0000, 0x40_0000)
    with image.open("rb") as file:
        elf = ELFFile(file)
        for segment in elf.iter_segments("PT_LOAD"):
            machine.mem_write(segment["p_paddr"], segment.data())
        symbols = {
            symbol.name: symbol["st_value"]
            for symbol in elf.get_section_by_name(".symtab").iter_symbols()
        }
    finish = START - 0x1000
    machine.reg_write(UC_ARM_REG_SP, 0x005F_FFF0)
    machine.reg_write(UC_ARM_REG_LR, finish)
    machine.emu_start(symbols[entry], finish)
    return lambda name: int.from_bytes(machine.mem_read(symbols[name], 4), "little")
