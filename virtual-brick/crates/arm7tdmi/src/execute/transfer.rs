// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM state: single data transfers, halfword and signed transfers, swap.

use crate::alu::shift_by_constant;
use crate::bus::{Abort, Bus, Cycle, Width};
use crate::cpu::{Cpu, Step};

/// Kinds of the halfword format, from its S and H bits.
pub(super) const UNSIGNED_HALFWORD: u8 = 0b01;
pub(super) const SIGNED_BYTE: u8 = 0b10;
pub(super) const SIGNED_HALFWORD: u8 = 0b11;

const LOAD: u8 = 1 << 0;
const WRITE_BACK: u8 = 1 << 1;
const BYTE: u8 = 1 << 2;
const UP: u8 = 1 << 3;
const BEFORE: u8 = 1 << 4;

/// Base and offset of a transfer resolved by its addressing mode.
struct Addressing {
    /// Where the transfer takes place.
    address: u32,
    /// New value of the base register, if it is written back.
    base: Option<u32>,
}

/// `bits` holds P, U and W at the places of the constants above. Post-indexing always writes
/// back; its W bit asks for a user-mode access, which this bus does not distinguish.
#[inline(always)]
fn addressing(bits: u8, base: u32, offset: u32) -> Addressing {
    let moved = if bits & UP != 0 {
        base.wrapping_add(offset)
    } else {
        base.wrapping_sub(offset)
    };
    let before = bits & BEFORE != 0;
    Addressing {
        address: if before { moved } else { base },
        base: (!before || bits & WRITE_BACK != 0).then_some(moved),
    }
}

impl Cpu {
    /// Reads an item at any address. A word arrives rotated so that the addressed byte comes
    /// lowest, a halfword from an odd address rotated by a byte, a signed one as its upper byte.
    #[inline(always)]
    pub(super) fn load_item<B: Bus>(
        &self,
        bus: &mut B,
        address: u32,
        width: Width,
        signed: bool,
    ) -> Result<u32, Abort> {
        let item = bus.read(address, width, Cycle::Nonsequential)?;
        Ok(match (width, signed) {
            (Width::Word, _) => item.rotate_right(8 * (address & 3)),
            (Width::Halfword, false) => item.rotate_right(8 * (address & 1)),
            (Width::Halfword, true) => (item as u16 as i16 >> (8 * (address & 1))) as u32,
            (Width::Byte, false) => item,
            (Width::Byte, true) => item as u8 as i8 as u32,
        })
    }

    /// Third cycle of a load, and the register write unless the access was aborted.
    #[inline(always)]
    pub(super) fn finish_load<B: Bus>(
        &mut self,
        bus: &mut B,
        destination: u32,
        loaded: Result<u32, Abort>,
    ) -> Step {
        bus.internal(1);
        match loaded {
            Ok(value) => self.write_result(bus, destination, value),
            Err(Abort) => self.enter_data_abort(bus),
        }
    }

    /// End of a store: the next fetch is non-sequential.
    #[inline(always)]
    pub(super) fn finish_store<B: Bus>(&mut self, bus: &mut B, stored: Result<(), Abort>) -> Step {
        self.next_fetch_is_nonsequential();
        match stored {
            Ok(()) => Step::Instruction,
            Err(Abort) => self.enter_data_abort(bus),
        }
    }

    /// Write-back. With r15 as base it has no defined meaning and is left out.
    #[inline(always)]
    fn write_base(&mut self, number: u32, base: Option<u32>) {
        match base {
            Some(base) if number & 15 != 15 => self.registers.set(number, base),
            _ => {}
        }
    }
}

/// LDR, STR, LDRB, STRB; `BITS` is bits 24:20 (P U B W L).
pub(super) fn single_transfer<B: Bus, const REGISTER_OFFSET: bool, const BITS: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let offset = if REGISTER_OFFSET {
        let value = cpu.registers.get(opcode);
        let amount = (opcode >> 7) & 0x1F;
        shift_by_constant(opcode >> 5, value, amount, cpu.carry()).value
    } else {
        opcode & 0xFFF
    };
    let width = if BITS & BYTE != 0 {
        Width::Byte
    } else {
        Width::Word
    };
    let (base, register) = (opcode >> 16, opcode >> 12);
    let target = addressing(BITS, cpu.registers.get(base), offset);
    cpu.advance_arm();
    if BITS & LOAD != 0 {
        let loaded = cpu.load_item(bus, target.address, width, false);
        cpu.write_base(base, target.base);
        cpu.finish_load(bus, register, loaded)
    } else {
        let value = cpu.registers.get(register);
        let stored = bus.write(target.address, width, value, Cycle::Nonsequential);
        cpu.write_base(base, target.base);
        cpu.finish_store(bus, stored)
    }
}

/// LDRH, STRH, LDRSB, LDRSH.
pub(super) fn halfword_transfer<B: Bus, const IS_LOAD: bool, const KIND: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let offset = if opcode & (1 << 22) != 0 {
        ((opcode >> 4) & 0xF0) | (opcode & 0x0F)
    } else {
        cpu.registers.get(opcode)
    };
    let bits = ((opcode >> 20) & 0x1F) as u8;
    let (base, register) = (opcode >> 16, opcode >> 12);
    let target = addressing(bits, cpu.registers.get(base), offset);
    cpu.advance_arm();
    if IS_LOAD {
        let (width, signed) = match KIND {
            UNSIGNED_HALFWORD => (Width::Halfword, false),
            SIGNED_BYTE => (Width::Byte, true),
            _ => (Width::Halfword, true),
        };
        let loaded = cpu.load_item(bus, target.address, width, signed);
        cpu.write_base(base, target.base);
        cpu.finish_load(bus, register, loaded)
    } else {
        let value = cpu.registers.get(register);
        let width = Width::Halfword;
        let stored = bus.write(target.address, width, value, Cycle::Nonsequential);
        cpu.write_base(base, target.base);
        cpu.finish_store(bus, stored)
    }
}

/// SWP and SWPB: S + 2N + I. An aborted read suppresses the write.
pub(super) fn swap<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let address = cpu.registers.get(opcode >> 16);
    cpu.advance_arm();
    let value = cpu.registers.get(opcode);
    let width = if opcode & (1 << 22) != 0 {
        Width::Byte
    } else {
        Width::Word
    };
    let loaded = cpu.load_item(bus, address, width, false);
    let exchanged = loaded.and_then(|old| {
        bus.write(address, width, value, Cycle::Nonsequential)?;
        Ok(old)
    });
    cpu.finish_load(bus, opcode >> 12, exchanged)
}
