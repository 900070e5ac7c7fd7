// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Thumb state: loads and stores.

use super::block_transfer::Block;
use crate::bus::{Bus, Cycle, Width};
use crate::cpu::{Cpu, Step};
use crate::decode::format::{list_and_size, register_access};

/// Format 6: LDR Rd, [PC, #offset] from a word address.
pub(super) fn load_relative<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let base = cpu.registers.pc() & !3;
    let address = base.wrapping_add(4 * (opcode & 0xFF));
    transfer_item(cpu, bus, (opcode >> 8, true), address, (Width::Word, false))
}

/// Formats 7 and 8: base and offset in registers; `KIND` is bits 11:9.
pub(super) fn transfer_register<B: Bus, const KIND: u32>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let (base, offset) = (cpu.low_register(opcode, 3), cpu.low_register(opcode, 6));
    let address = base.wrapping_add(offset);
    let (load, width, signed) = register_access(KIND);
    transfer_item(cpu, bus, (opcode, load), address, (width, signed))
}

/// Formats 9 and 10: base register and a 5-bit offset in units of the width; the lowest bit of
/// `KIND` tells a load.
pub(super) fn transfer_constant<B: Bus, const KIND: u32>(
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
    transfer_item(cpu, bus, (opcode, KIND & 1 != 0), address, (width, false))
}

/// Loads or stores the register in the lowest bits of the opcode.
#[inline(always)]
fn transfer_item<B: Bus>(
    cpu: &mut Cpu,
    bus: &mut B,
    (opcode, load): (u32, bool),
    address: u32,
    (width, signed): (Width, bool),
) -> Step {
    if load {
        let loaded = cpu.load_item(bus, address, width, signed);
        cpu.advance_thumb();
        cpu.finish_load(bus, opcode & 7, loaded)
    } else {
        let value = cpu.low_register(opcode, 0);
        cpu.advance_thumb();
        let stored = bus.write(address, width, value, Cycle::Nonsequential);
        cpu.finish_store(bus, stored)
    }
}

/// Format 11: relative to SP.
pub(super) fn transfer_stack<B: Bus, const LOAD: bool>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let address = cpu.registers.get(13).wrapping_add(4 * (opcode & 0xFF));
    transfer_item(cpu, bus, (opcode >> 8, LOAD), address, (Width::Word, false))
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
