// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! ARM state: handlers of the formats, data processing, branches and traps.

use super::block_transfer::block_data_transfer;
use super::fetch::Handler;
use super::multiply::{multiply, multiply_long};
use super::status::{mrs, msr_constant, msr_register};
use super::transfer::{halfword_transfer, single_transfer, swap};
use super::transfer::{SIGNED_BYTE, SIGNED_HALFWORD, UNSIGNED_HALFWORD};
use crate::alu::{data_operation, rotated_constant, shift_by_constant, shift_by_register, Shifted};
use crate::bus::Bus;
use crate::cpu::{Cpu, Step};
use crate::decode::format::{arm_format, arm_index, ArmFormat, HalfwordTransfer, OperandKind};
use crate::registers::psr;

struct Decoder<B>(std::marker::PhantomData<B>);

impl<B: Bus> Decoder<B> {
    /// Handlers by bits 27:20 (upper eight bits of the index) and 7:4 (lower four).
    const TABLE: [Handler<B>; 4096] = {
        let mut table = [undefined as Handler<B>; 4096];
        let mut index = 0;
        while index < 4096 {
            table[index] = handler(index as u32);
            index += 1;
        }
        table
    };
}

impl Cpu {
    /// One ARM instruction: fetch ahead, test the condition, execute.
    #[inline(always)]
    pub(super) fn execute_arm<B: Bus>(&mut self, bus: &mut B) -> Step {
        let opcode = self.fetch_ahead_arm(bus);
        if !self.condition_passes(opcode >> 28) {
            self.advance_arm();
            return Step::Instruction;
        }
        let index = arm_index(opcode);
        let handler = (&Decoder::<B>::TABLE)[index as usize];
        handler(self, bus, opcode)
    }
}

/// The handler of the format that an index of the table encodes.
const fn handler<B: Bus>(index: u32) -> Handler<B> {
    match arm_format(index) {
        ArmFormat::BranchExchange => branch_and_exchange,
        ArmFormat::Multiply { accumulate: false } => multiply::<B, false>,
        ArmFormat::Multiply { accumulate: true } => multiply::<B, true>,
        ArmFormat::MultiplyLong { signed, accumulate } => match (signed, accumulate) {
            (false, false) => multiply_long::<B, false, false>,
            (false, true) => multiply_long::<B, false, true>,
            (true, false) => multiply_long::<B, true, false>,
            (true, true) => multiply_long::<B, true, true>,
        },
        ArmFormat::Swap => swap,
        ArmFormat::HalfwordTransfer(transfer) => match transfer {
            HalfwordTransfer::Store => halfword_transfer::<B, false, UNSIGNED_HALFWORD>,
            HalfwordTransfer::Load => halfword_transfer::<B, true, UNSIGNED_HALFWORD>,
            HalfwordTransfer::LoadSignedByte => halfword_transfer::<B, true, SIGNED_BYTE>,
            HalfwordTransfer::LoadSigned => halfword_transfer::<B, true, SIGNED_HALFWORD>,
        },
        ArmFormat::Mrs => mrs,
        ArmFormat::MsrRegister => msr_register,
        ArmFormat::MsrConstant => msr_constant,
        ArmFormat::DataProcessing(kind) => {
            let of_operation = match kind {
                OperandKind::Constant => data_processing_handlers::<B, CONSTANT>(),
                OperandKind::ShiftByConstant => data_processing_handlers::<B, SHIFT_BY_CONSTANT>(),
                OperandKind::ShiftByRegister => data_processing_handlers::<B, SHIFT_BY_REGISTER>(),
            };
            of_operation[(index >> 4 & 0x1F) as usize]
        }
        ArmFormat::SingleTransfer { register_offset } => {
            let of_bits = if register_offset {
                single_transfer_handlers::<B, true>()
            } else {
                single_transfer_handlers::<B, false>()
            };
            of_bits[(index >> 4 & 0x1F) as usize]
        }
        ArmFormat::BlockTransfer { load: false } => block_data_transfer::<B, false>,
        ArmFormat::BlockTransfer { load: true } => block_data_transfer::<B, true>,
        ArmFormat::Branch { link: false } => branch::<B, false>,
        ArmFormat::Branch { link: true } => branch::<B, true>,
        ArmFormat::SoftwareInterrupt => software_interrupt,
        ArmFormat::Undefined => undefined,
    }
}

const fn data_processing_handlers<B: Bus, const KIND: u8>() -> [Handler<B>; 32] {
    instances!(data_processing::<B, KIND, [
        0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
    ]>)
}

const fn single_transfer_handlers<B: Bus, const REGISTER_OFFSET: bool>() -> [Handler<B>; 32] {
    instances!(single_transfer::<B, REGISTER_OFFSET, [
        0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
    ]>)
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
fn data_processing<B: Bus, const KIND: u8, const OPERATION: u8>(
    cpu: &mut Cpu,
    bus: &mut B,
    opcode: u32,
) -> Step {
    let Shifted { value: b, carry } = operand::<B, KIND>(cpu, bus, opcode);
    let a = cpu.registers.get(opcode >> 16);
    if KIND != SHIFT_BY_REGISTER {
        cpu.advance_arm();
    }
    let (sum, logical) = data_operation(OPERATION >> 1, a, b, cpu.carry());
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
pub(super) fn undefined<B: Bus>(cpu: &mut Cpu, bus: &mut B, _opcode: u32) -> Step {
    cpu.enter_undefined(bus)
}

impl Cpu {
    /// Branch that takes the state from bit 0 of `target`.
    pub(super) fn exchange<B: Bus>(&mut self, bus: &mut B, target: u32) {
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
