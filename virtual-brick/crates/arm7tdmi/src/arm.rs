// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM state: decoding by bits 27:20 and 7:4, data processing, branches and traps.

use crate::alu::{add, rotated_constant, shift_by_constant, shift_by_register, Shifted, Sum};
use crate::arm_transfer::{halfword_transfer, single_transfer, swap};
use crate::arm_transfer::{SIGNED_BYTE, SIGNED_HALFWORD, UNSIGNED_HALFWORD};
use crate::block_transfer::block_data_transfer;
use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::multiply::{multiply, multiply_long};
use crate::registers::psr;
use crate::status::{mrs, msr_constant, msr_register};

/// Executes one instruction, after its condition passed and its first fetch was made.
pub(crate) type Handler<B> = fn(&mut Cpu, &mut B, u32) -> Step;

struct Decoder<B>(std::marker::PhantomData<B>);

impl<B: Bus> Decoder<B> {
    /// Handlers by bits 27:20 (upper eight bits of the index) and 7:4 (lower four).
    const TABLE: [Handler<B>; 4096] = {
        let mut table = [undefined as Handler<B>; 4096];
        let mut index = 0;
        while index < 4096 {
            table[index] = decode(index as u32);
            index += 1;
        }
        table
    };
}

impl Cpu {
    /// One ARM instruction: fetch ahead, test the condition, execute.
    #[inline]
    pub(crate) fn execute_arm<B: Bus>(&mut self, bus: &mut B) -> Step {
        let opcode = self.fetch_ahead_arm(bus);
        if !self.condition_passes(opcode >> 28) {
            self.advance_arm();
            return Step::Instruction;
        }
        let index = ((opcode >> 16) & 0xFF0) | ((opcode >> 4) & 0xF);
        let handler = (&Decoder::<B>::TABLE)[index as usize];
        handler(self, bus, opcode)
    }

    /// Writes the result of an instruction; r15 as destination is a branch in the current state.
    #[inline(always)]
    pub(crate) fn write_result<B: Bus>(&mut self, bus: &mut B, number: u32, value: u32) -> Step {
        if number & 15 == 15 {
            self.branch(bus, value);
        } else {
            self.registers.set(number, value);
        }
        Step::Instruction
    }
}

/// The instance of a handler whose first constant argument equals a value below 32.
macro_rules! instance_of_32 {
    ($value:expr, $handler:ident, $fixed:expr) => {
        instance_of_32!($value, $handler, $fixed, [
            0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
            16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
        ])
    };
    ($value:expr, $handler:ident, $fixed:expr, [$($number:literal)*]) => {
        match $value {
            $($number => $handler::<B, $number, { $fixed }> as Handler<B>,)*
            _ => undefined::<B> as Handler<B>,
        }
    };
}

/// Format of an instruction, from bits 27:20 and 7:4 (DDI 0029E, figure 4-1).
const fn decode<B: Bus>(index: u32) -> Handler<B> {
    let (high, low) = (index >> 4, index & 0xF);
    match (high, low) {
        (0b0001_0010, 0b0001) => branch_and_exchange,
        (0b0000_0000..=0b0000_1111, 0b1001) => decode_multiply(high),
        (0b0001_0000 | 0b0001_0100, 0b1001) => swap,
        (0b0000_0000..=0b0001_1111, 0b1011 | 0b1101 | 0b1111) => decode_halfword(high, low),
        (0b0000_0000..=0b0001_1111, 0b1001) => undefined,
        (0b0001_0000 | 0b0001_0100, 0b0000) => mrs,
        (0b0001_0010 | 0b0001_0110, 0b0000) => msr_register,
        (0b0011_0010 | 0b0011_0110, _) => msr_constant,
        (0b0000_0000..=0b0011_1111, _) => decode_data_processing(high, low),
        (0b0110_0000..=0b0111_1111, _) if low & 1 != 0 => undefined,
        (0b0100_0000..=0b0101_1111, _) => {
            instance_of_32!(high & 0x1F, single_transfer, false)
        }
        (0b0110_0000..=0b0111_1111, _) => {
            instance_of_32!(high & 0x1F, single_transfer, true)
        }
        (0b1000_0000..=0b1001_1111, _) if high & 1 != 0 => block_data_transfer::<B, true>,
        (0b1000_0000..=0b1001_1111, _) => block_data_transfer::<B, false>,
        (0b1010_0000..=0b1010_1111, _) => branch::<B, false>,
        (0b1011_0000..=0b1011_1111, _) => branch::<B, true>,
        (0b1111_0000..=0b1111_1111, _) => software_interrupt,
        _ => undefined,
    }
}

const fn decode_multiply<B: Bus>(high: u32) -> Handler<B> {
    match high >> 1 {
        0b000_0000 => multiply::<B, false>,
        0b000_0001 => multiply::<B, true>,
        0b000_0100 => multiply_long::<B, false, false>,
        0b000_0101 => multiply_long::<B, false, true>,
        0b000_0110 => multiply_long::<B, true, false>,
        0b000_0111 => multiply_long::<B, true, true>,
        _ => undefined,
    }
}

/// Signed stores do not exist; stores have the halfword pattern only.
const fn decode_halfword<B: Bus>(high: u32, low: u32) -> Handler<B> {
    match (high & 1 != 0, low) {
        (false, 0b1011) => halfword_transfer::<B, false, UNSIGNED_HALFWORD>,
        (true, 0b1011) => halfword_transfer::<B, true, UNSIGNED_HALFWORD>,
        (true, 0b1101) => halfword_transfer::<B, true, SIGNED_BYTE>,
        (true, 0b1111) => halfword_transfer::<B, true, SIGNED_HALFWORD>,
        _ => undefined,
    }
}

/// The compare operations without S belong to the status and branch-exchange formats.
const fn decode_data_processing<B: Bus>(high: u32, low: u32) -> Handler<B> {
    let operation = high & 0x1F;
    if operation & 0b11001 == 0b10000 {
        return undefined;
    }
    if high & 0b10_0000 != 0 {
        instance_of_32!(operation, data_processing, CONSTANT)
    } else if low & 1 == 0 {
        instance_of_32!(operation, data_processing, SHIFT_BY_CONSTANT)
    } else {
        instance_of_32!(operation, data_processing, SHIFT_BY_REGISTER)
    }
}

const CONSTANT: u8 = 0;
const SHIFT_BY_CONSTANT: u8 = 1;
const SHIFT_BY_REGISTER: u8 = 2;

/// Second operand. A shift by register takes an internal cycle: the amount is read before it,
/// the other operands after it, when r15 has advanced.
#[inline(always)]
fn operand<B: Bus, const KIND: u8>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Shifted {
    let carry = cpu.carry();
    match KIND {
        CONSTANT => rotated_constant(opcode & 0xFF, (opcode >> 8) & 0xF, carry),
        SHIFT_BY_CONSTANT => {
            let value = cpu.registers.get(opcode);
            let amount = (opcode >> 7) & 0x1F;
            shift_by_constant(opcode >> 5, value, amount, carry)
        }
        _ => {
            let amount = cpu.registers.get(opcode >> 8) & 0xFF;
            bus.internal(1);
            cpu.advance_arm();
            let value = cpu.registers.get(opcode);
            shift_by_register(opcode >> 5, value, amount, carry)
        }
    }
}

/// Data processing; `OPERATION` is bits 24:20: the operation and the S bit.
fn data_processing<B: Bus, const OPERATION: u8, const KIND: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let Shifted { value: b, carry } = operand::<B, KIND>(cpu, bus, opcode);
    let a = cpu.registers.get(opcode >> 16);
    if KIND != SHIFT_BY_REGISTER {
        cpu.advance_arm();
    }
    let carry_in = cpu.carry();
    let (sum, logical) = match OPERATION >> 1 {
        0x0 | 0x8 => (of_value(a & b), true),
        0x1 | 0x9 => (of_value(a ^ b), true),
        0x2 | 0xA => (add(a, !b, true), false),
        0x3 => (add(b, !a, true), false),
        0x4 | 0xB => (add(a, b, false), false),
        0x5 => (add(a, b, carry_in), false),
        0x6 => (add(a, !b, carry_in), false),
        0x7 => (add(b, !a, carry_in), false),
        0xC => (of_value(a | b), true),
        0xD => (of_value(b), true),
        0xE => (of_value(a & !b), true),
        _ => (of_value(!b), true),
    };
    let destination = opcode >> 12;
    let compares = OPERATION & 0b11000 == 0b10000;
    if OPERATION & 1 != 0 {
        if logical {
            cpu.set_nzc(sum.value, carry);
        } else {
            cpu.set_nzcv(sum);
        }
        if destination & 15 == 15 {
            cpu.restore_status();
        }
    }
    if compares {
        return Step::Instruction;
    }
    cpu.write_result(bus, destination, sum.value)
}

#[inline(always)]
const fn of_value(value: u32) -> Sum {
    Sum {
        value,
        carry: false,
        overflow: false,
    }
}

/// B and BL: 2S + N.
fn branch<B: Bus, const LINK: bool>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let offset = ((opcode << 8) as i32 >> 6) as u32;
    let pc = cpu.registers.pc();
    if LINK {
        cpu.registers.set(14, pc.wrapping_sub(4));
    }
    cpu.branch_arm(bus, pc.wrapping_add(offset));
    Step::Instruction
}

/// BX: bit 0 of the target selects the state.
fn branch_and_exchange<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let target = cpu.registers.get(opcode);
    cpu.exchange(bus, target);
    Step::Instruction
}

/// SWI: 2S + N.
fn software_interrupt<B: Bus>(cpu: &mut Cpu, bus: &mut B, _opcode: u32) -> Step {
    cpu.enter_software_interrupt(bus)
}

/// Everything without meaning, and every coprocessor instruction: no coprocessor answers.
pub(crate) fn undefined<B: Bus>(cpu: &mut Cpu, bus: &mut B, _opcode: u32) -> Step {
    cpu.enter_undefined(bus)
}

impl Cpu {
    /// Branch that takes the state from bit 0 of `target`.
    pub(crate) fn exchange<B: Bus>(&mut self, bus: &mut B, target: u32) {
        let status = self.registers.status();
        if target & 1 == 0 {
            self.registers.set_flags(status & !psr::T);
            self.branch_arm(bus, target);
        } else {
            self.registers.set_flags(status | psr::T);
            self.branch_thumb(bus, target);
        }
    }
}
