// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Thumb state: loads and stores.

use super::block_transfer::Block;
use crate::bus::{Abort, Bus, Cycle, Width};
use crate::cpu::{Cpu, Step};
use crate::decode::format::list_and_size;

impl Cpu {
    /// Store of a register with the r15 advance and cycles common to all store formats.
    #[inline(always)]
    fn thumb_store<B: Bus>(&mut self, bus: &mut B, address: u32, width: Width, value: u32) -> Step {
        self.advance_thumb();
        let stored = bus.write(address, width, value, Cycle::Nonsequential);
        self.finish_store(bus, stored)
    }

    #[inline(always)]
    fn thumb_load<B: Bus>(
        &mut self,
        bus: &mut B,
        destination: u32,
        loaded: Result<u32, Abort>,
    ) -> Step {
        self.advance_thumb();
        self.finish_load(bus, destination & 7, loaded)
    }
}

/// Format 6: LDR Rd, [PC, #offset] from a word address.
pub(super) fn load_relative<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let base = cpu.registers.pc() & !3;
    let loaded = cpu.load_word(bus, base.wrapping_add(4 * (opcode & 0xFF)));
    cpu.thumb_load(bus, opcode >> 8, loaded)
}

/// Formats 7 and 8: base and offset in registers; `KIND` is bits 11:9.
pub(super) fn transfer_register<B: Bus, const KIND: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let (base, offset) = (cpu.low_register(opcode, 3), cpu.low_register(opcode, 6));
    let address = base.wrapping_add(offset);
    let value = cpu.low_register(opcode, 0);
    match KIND {
        0b000 => cpu.thumb_store(bus, address, Width::Word, value),
        0b001 => cpu.thumb_store(bus, address, Width::Halfword, value),
        0b010 => cpu.thumb_store(bus, address, Width::Byte, value),
        _ => {
            let loaded = match KIND {
                0b011 => cpu.load_signed_byte(bus, address),
                0b100 => cpu.load_word(bus, address),
                0b101 => cpu.load_halfword(bus, address),
                0b110 => cpu.load_byte(bus, address),
                _ => cpu.load_signed_halfword(bus, address),
            };
            cpu.thumb_load(bus, opcode, loaded)
        }
    }
}

/// Bits B and L of format 9 continue with the halfword pair of format 10.
pub(super) const HALFWORD_CONSTANT: u8 = 0b100;

/// Formats 9 and 10: base register and a 5-bit offset in units of the width; the lowest bit of
/// `KIND` tells a load.
pub(super) fn transfer_constant<B: Bus, const KIND: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let (width, size) = match KIND >> 1 {
        0b00 => (Width::Word, 4),
        0b01 => (Width::Byte, 1),
        _ => (Width::Halfword, 2),
    };
    let offset = size * ((opcode >> 6) & 0x1F);
    let address = cpu.low_register(opcode, 3).wrapping_add(offset);
    if KIND & 1 == 0 {
        let value = cpu.low_register(opcode, 0);
        return cpu.thumb_store(bus, address, width, value);
    }
    let loaded = match width {
        Width::Word => cpu.load_word(bus, address),
        Width::Byte => cpu.load_byte(bus, address),
        Width::Halfword => cpu.load_halfword(bus, address),
    };
    cpu.thumb_load(bus, opcode, loaded)
}

/// Format 11: relative to SP.
pub(super) fn transfer_stack<B: Bus, const LOAD: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let address = cpu.registers.get(13).wrapping_add(4 * (opcode & 0xFF));
    if LOAD {
        let loaded = cpu.load_word(bus, address);
        cpu.thumb_load(bus, opcode >> 8, loaded)
    } else {
        let value = cpu.low_register(opcode, 8);
        cpu.thumb_store(bus, address, Width::Word, value)
    }
}

/// Format 14: PUSH with LR, POP with PC. POP to PC stays in Thumb state.
pub(super) fn push_pop<B: Bus, const LOAD: bool>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let extra = match (opcode & 0x100 != 0, LOAD) {
        (false, _) => 0,
        (true, false) => 1 << 14,
        (true, true) => 1 << 15,
    };
    let (list, size) = list_and_size((opcode & 0xFF) | extra);
    let pointer = cpu.registers.get(13);
    let pushed = pointer.wrapping_sub(size);
    let popped = pointer.wrapping_add(size);
    let (start, end) = if LOAD {
        (pointer, popped)
    } else {
        (pushed, pushed)
    };
    run_block::<B, LOAD>(cpu, bus, 13, list, start, end)
}

/// Format 15: LDMIA and STMIA with write-back.
pub(super) fn multiple<B: Bus, const LOAD: bool>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let (list, size) = list_and_size(opcode & 0xFF);
    let base = (opcode >> 8) & 7;
    let start = cpu.registers.get(base);
    run_block::<B, LOAD>(cpu, bus, base, list, start, start.wrapping_add(size))
}

#[inline(always)]
fn run_block<B: Bus, const LOAD: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    base: u32,
    list: u32,
    start: u32,
    end: u32,
) -> Step {
    let block = Block {
        base,
        list,
        start,
        end_base: Some(end),
        user_bank: false,
        restores_status: false,
    };
    cpu.advance_thumb();
    if LOAD {
        cpu.load_block(bus, &block)
    } else {
        cpu.store_block(bus, &block)
    }
}
