// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Thumb state: handlers of the formats, arithmetic and branches.

use super::fetch::Handler;
use super::thumb_transfer::{
    load_relative, multiple, push_pop, transfer_constant, transfer_register, transfer_stack,
};
use crate::alu::{
    add, data_operation, shift_by_constant, shift_by_register, Shifted, ADC, ADD, AND, BIC, CMN,
    CMP, EOR, MOV, MVN, ORR, RSB, SBC, SUB, TST,
};
use crate::bus::Bus;
use crate::cost::signed_cycles;
use crate::cpu::{Cpu, Step};
use crate::decode::format::{thumb_format, ConstantOperation, ThumbFormat};

struct Decoder<B>(std::marker::PhantomData<B>);

impl<B: Bus> Decoder<B> {
    /// Handlers by bits 15:6.
    const TABLE: [Handler<B>; 1024] = {
        let mut table = [undefined as Handler<B>; 1024];
        let mut index = 0;
        while index < 1024 {
            table[index] = handler(index as u32);
            index += 1;
        }
        table
    };
}

impl Cpu {
    /// One Thumb instruction: fetch ahead, execute.
    #[inline(always)]
    pub(super) fn execute_thumb<B: Bus>(&mut self, bus: &mut B) -> Step {
        let opcode = self.fetch_ahead_thumb(bus);
        let handler = (&Decoder::<B>::TABLE)[((opcode >> 6) & 0x3FF) as usize];
        handler(self, bus, opcode)
    }

    /// A register in the three bits of `opcode` from `position` up.
    #[inline(always)]
    pub(super) fn low_register(&self, opcode: u32, position: u32) -> u32 {
        self.registers.get((opcode >> position) & 7)
    }
}

/// The handler of the format that an index of the table encodes.
const fn handler<B: Bus>(index: u32) -> Handler<B> {
    match thumb_format(index) {
        ThumbFormat::Shift(kind) => {
            let of_kind: [Handler<B>; 3] = instances!(shift::<B, [0 1 2]>);
            of_kind[kind as usize]
        }
        ThumbFormat::AddSubtract { constant, minus } => match (constant, minus) {
            (false, false) => add_subtract::<B, ADD, false>,
            (false, true) => add_subtract::<B, SUB, false>,
            (true, false) => add_subtract::<B, ADD, true>,
            (true, true) => add_subtract::<B, SUB, true>,
        },
        ThumbFormat::Constant(operation) => match operation {
            ConstantOperation::Move => constant::<B, MOV>,
            ConstantOperation::Compare => constant::<B, CMP>,
            ConstantOperation::Add => constant::<B, ADD>,
            ConstantOperation::Subtract => constant::<B, SUB>,
        },
        ThumbFormat::Register(operation) => register_handler(operation),
        ThumbFormat::HighRegister(operation) => match operation {
            ConstantOperation::Add => high_register::<B, ADD>,
            ConstantOperation::Compare => high_register::<B, CMP>,
            _ => high_register::<B, MOV>,
        },
        ThumbFormat::BranchExchange => branch_and_exchange,
        ThumbFormat::LoadRelative => load_relative,
        ThumbFormat::TransferRegister(kind) => {
            let of_kind: [Handler<B>; 8] = instances!(transfer_register::<B, [0 1 2 3 4 5 6 7]>);
            of_kind[kind as usize]
        }
        ThumbFormat::TransferConstant(kind) => {
            let of_kind: [Handler<B>; 6] = instances!(transfer_constant::<B, [0 1 2 3 4 5]>);
            of_kind[kind as usize]
        }
        ThumbFormat::TransferStack { load: false } => transfer_stack::<B, false>,
        ThumbFormat::TransferStack { load: true } => transfer_stack::<B, true>,
        ThumbFormat::LoadAddress { stack: false } => load_address::<B, 15>,
        ThumbFormat::LoadAddress { stack: true } => load_address::<B, 13>,
        ThumbFormat::AddToStackPointer => add_to_stack_pointer,
        ThumbFormat::PushPop { load: false } => push_pop::<B, false>,
        ThumbFormat::PushPop { load: true } => push_pop::<B, true>,
        ThumbFormat::Multiple { load: false } => multiple::<B, false>,
        ThumbFormat::Multiple { load: true } => multiple::<B, true>,
        ThumbFormat::ConditionalBranch => conditional_branch,
        ThumbFormat::SoftwareInterrupt => software_interrupt,
        ThumbFormat::Branch => branch,
        ThumbFormat::LongBranchPrefix => long_branch_prefix,
        ThumbFormat::LongBranchSuffix => long_branch_suffix,
        ThumbFormat::Undefined => undefined,
    }
}

/// Format 4, by bits 9:6.
const fn register_handler<B: Bus>(operation: u32) -> Handler<B> {
    match operation {
        0x0 => two_registers::<B, AND>,
        0x1 => two_registers::<B, EOR>,
        0x2 => shift_register::<B, 0>,
        0x3 => shift_register::<B, 1>,
        0x4 => shift_register::<B, 2>,
        0x5 => two_registers::<B, ADC>,
        0x6 => two_registers::<B, SBC>,
        0x7 => shift_register::<B, 3>,
        0x8 => two_registers::<B, TST>,
        0x9 => two_registers::<B, RSB>,
        0xA => two_registers::<B, CMP>,
        0xB => two_registers::<B, CMN>,
        0xC => two_registers::<B, ORR>,
        0xD => multiply,
        0xE => two_registers::<B, BIC>,
        _ => two_registers::<B, MVN>,
    }
}

/// Format 1: LSL, LSR, ASR by a constant.
fn shift<B: Bus, const KIND: u32>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let value = cpu.low_register(opcode, 3);
    let Shifted { value, carry } =
        shift_by_constant(KIND, value, (opcode >> 6) & 0x1F, cpu.carry());
    cpu.registers.set(opcode & 7, value);
    cpu.set_nzc(value, carry);
    cpu.advance_thumb();
    Step::Instruction
}

/// A data processing operation that sets flags; C stays where it is logical.
#[inline(always)]
fn process<const OPERATION: u8>(cpu: &mut Cpu, destination: u32, a: u32, b: u32) -> Step {
    let (sum, logical) = data_operation(OPERATION, a, b, cpu.carry());
    if logical {
        cpu.set_nz(sum.value);
    } else {
        cpu.set_nzcv(sum);
    }
    if !matches!(OPERATION, TST | CMP | CMN) {
        cpu.registers.set(destination, sum.value);
    }
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 2: ADD and SUB of a register or a 3-bit constant.
fn add_subtract<B: Bus, const OPERATION: u8, const CONSTANT: bool>(
    cpu: &mut Cpu,
    _bus: &mut B,
    opcode: u32,
) -> Step {
    let b = if CONSTANT {
        (opcode >> 6) & 7
    } else {
        cpu.low_register(opcode, 6)
    };
    process::<OPERATION>(cpu, opcode & 7, cpu.low_register(opcode, 3), b)
}

/// Format 3: MOV, CMP, ADD, SUB with an 8-bit constant.
fn constant<B: Bus, const OPERATION: u8>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let register = (opcode >> 8) & 7;
    process::<OPERATION>(cpu, register, cpu.registers.get(register), opcode & 0xFF)
}

/// Format 4: operations on two registers. NEG is RSB from zero.
fn two_registers<B: Bus, const OPERATION: u8>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let (a, b) = (cpu.low_register(opcode, 0), cpu.low_register(opcode, 3));
    let (a, b) = if OPERATION == RSB { (b, 0) } else { (a, b) };
    process::<OPERATION>(cpu, opcode & 7, a, b)
}

/// Format 4: shifts by a register, S + I.
fn shift_register<B: Bus, const KIND: u32>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    bus.internal(1);
    let (value, amount) = (cpu.low_register(opcode, 0), cpu.low_register(opcode, 3));
    let Shifted { value, carry } = shift_by_register(KIND, value, amount & 0xFF, cpu.carry());
    cpu.registers.set(opcode & 7, value);
    cpu.set_nzc(value, carry);
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 4: MUL, whose multiplier is the old destination. C and V keep their values.
fn multiply<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let multiplier = cpu.low_register(opcode, 0);
    let value = multiplier.wrapping_mul(cpu.low_register(opcode, 3));
    bus.internal(signed_cycles(multiplier));
    cpu.registers.set(opcode & 7, value);
    cpu.set_nz(value);
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 5: ADD, CMP, MOV between any registers; only CMP sets flags.
fn high_register<B: Bus, const OPERATION: u8>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let destination = (opcode & 7) | ((opcode >> 4) & 8);
    let (a, b) = (
        cpu.registers.get(destination),
        cpu.registers.get(opcode >> 3),
    );
    cpu.advance_thumb();
    match OPERATION {
        ADD => cpu.write_result(bus, destination, a.wrapping_add(b)),
        MOV => cpu.write_result(bus, destination, b),
        _ => {
            cpu.set_nzcv(add(a, !b, true));
            Step::Instruction
        }
    }
}

/// Format 5: BX.
fn branch_and_exchange<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let target = cpu.registers.get(opcode >> 3);
    cpu.exchange(bus, target);
    Step::Instruction
}

/// Format 12: ADD Rd, PC (as a word address) or SP.
fn load_address<B: Bus, const BASE: u32>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let base = match BASE {
        15 => cpu.registers.pc() & !3,
        _ => cpu.registers.get(BASE),
    };
    let value = base.wrapping_add(4 * (opcode & 0xFF));
    cpu.registers.set((opcode >> 8) & 7, value);
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 13: ADD SP, plus or minus a word offset.
fn add_to_stack_pointer<B: Bus>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let (pointer, offset) = (cpu.registers.get(13), 4 * (opcode & 0x7F));
    let moved = if opcode & 0x80 == 0 {
        pointer.wrapping_add(offset)
    } else {
        pointer.wrapping_sub(offset)
    };
    cpu.registers.set(13, moved);
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 16: 2S + N when taken, else S.
fn conditional_branch<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    if cpu.condition_passes(opcode >> 8) {
        let offset = (i32::from(opcode as u8 as i8) << 1) as u32;
        cpu.branch_thumb(bus, cpu.registers.pc().wrapping_add(offset));
    } else {
        cpu.advance_thumb();
    }
    Step::Instruction
}

/// Format 17.
fn software_interrupt<B: Bus>(cpu: &mut Cpu, bus: &mut B, _opcode: u32) -> Step {
    cpu.enter_software_interrupt(bus)
}

/// Format 18.
fn branch<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let offset = ((opcode << 21) as i32 >> 20) as u32;
    cpu.branch_thumb(bus, cpu.registers.pc().wrapping_add(offset));
    Step::Instruction
}

/// Format 19, first half: the upper part of the offset goes to LR.
fn long_branch_prefix<B: Bus>(cpu: &mut Cpu, _bus: &mut B, opcode: u32) -> Step {
    let offset = ((opcode << 21) as i32 >> 9) as u32;
    let partial = cpu.registers.pc().wrapping_add(offset);
    cpu.registers.set(14, partial);
    cpu.advance_thumb();
    Step::Instruction
}

/// Format 19, second half: branch, with the return address and bit 0 set in LR.
fn long_branch_suffix<B: Bus>(cpu: &mut Cpu, bus: &mut B, opcode: u32) -> Step {
    let target = cpu.registers.get(14).wrapping_add(2 * (opcode & 0x7FF));
    let following = cpu.registers.pc().wrapping_sub(2);
    cpu.registers.set(14, following | 1);
    cpu.branch_thumb(bus, target);
    Step::Instruction
}

fn undefined<B: Bus>(cpu: &mut Cpu, bus: &mut B, _opcode: u32) -> Step {
    cpu.enter_undefined(bus)
}
