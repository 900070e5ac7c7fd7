// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Operands of Thumb opcodes, as those of their ARM equivalents (DDI 0029E, chapter 5).

use super::format::{list_and_size, register_access, thumb_format, ConstantOperation, ThumbFormat};
use crate::bus::Width;
use crate::instruction::{
    AluOperation, BlockTransfer, DataProcessing, Multiply, MultiplyKind, Operand, Operation,
    Transfer, ALWAYS,
};

/// A register in the three bits from `position` up.
const fn low(opcode: u32, position: u32) -> u32 {
    opcode >> position & 7
}

const fn format_of(opcode: u32) -> ThumbFormat {
    thumb_format(opcode >> 6 & 0x3FF)
}

/// Condition code of a Thumb opcode.
pub(super) fn condition(opcode: u32) -> u32 {
    match format_of(opcode) {
        ThumbFormat::ConditionalBranch => opcode >> 8 & 15,
        _ => ALWAYS,
    }
}

/// What a Thumb opcode does.
pub(super) fn operation(opcode: u32) -> Operation {
    match format_of(opcode) {
        ThumbFormat::Shift(kind) => {
            let second = Operand::Shifted {
                register: low(opcode, 3),
                kind,
                amount: opcode >> 6 & 0x1F,
            };
            alu(AluOperation::Mov, low(opcode, 0), 0, second)
        }
        ThumbFormat::AddSubtract { constant, minus } => add_subtract(opcode, constant, minus),
        ThumbFormat::Constant(operation) => {
            let register = low(opcode, 8);
            let second = Operand::constant(opcode & 0xFF);
            alu(simple(operation), register, register, second)
        }
        ThumbFormat::Register(operation) => register_operation(opcode, operation),
        ThumbFormat::HighRegister(operation) => high_register(opcode, operation),
        ThumbFormat::BranchExchange => Operation::BranchExchange {
            register: opcode >> 3 & 15,
        },
        ThumbFormat::LoadAddress { stack: false } => Operation::LoadAddress {
            destination: low(opcode, 8),
            offset: 4 * (opcode & 0xFF),
        },
        ThumbFormat::LoadAddress { stack: true } => {
            let second = Operand::constant(4 * (opcode & 0xFF));
            without_flags(AluOperation::Add, low(opcode, 8), 13, second)
        }
        ThumbFormat::AddToStackPointer => {
            let operation = if opcode & 0x80 == 0 {
                AluOperation::Add
            } else {
                AluOperation::Sub
            };
            without_flags(operation, 13, 13, Operand::constant(4 * (opcode & 0x7F)))
        }
        ThumbFormat::ConditionalBranch => Operation::Branch {
            offset: (i32::from(opcode as u8 as i8) << 1) as u32,
            link: false,
        },
        ThumbFormat::Branch => Operation::Branch {
            offset: ((opcode << 21) as i32 >> 20) as u32,
            link: false,
        },
        ThumbFormat::LongBranchPrefix => Operation::LongBranchPrefix {
            offset: ((opcode << 21) as i32 >> 9) as u32,
        },
        ThumbFormat::LongBranchSuffix => Operation::LongBranchSuffix {
            offset: 2 * (opcode & 0x7FF),
        },
        ThumbFormat::SoftwareInterrupt => Operation::SoftwareInterrupt,
        ThumbFormat::Undefined => Operation::Undefined,
        format => memory_operation(opcode, format),
    }
}

fn memory_operation(opcode: u32, format: ThumbFormat) -> Operation {
    match format {
        ThumbFormat::LoadRelative => {
            let offset = Operand::constant(4 * (opcode & 0xFF));
            transfer((true, Width::Word, false), low(opcode, 8), 15, offset)
        }
        ThumbFormat::TransferRegister(kind) => {
            let offset = Operand::register(low(opcode, 6));
            let access = register_access(kind);
            transfer(access, low(opcode, 0), low(opcode, 3), offset)
        }
        ThumbFormat::TransferConstant(kind) => {
            let (width, size) = match kind >> 1 {
                0 => (Width::Word, 4),
                1 => (Width::Byte, 1),
                _ => (Width::Halfword, 2),
            };
            let offset = Operand::constant(size * (opcode >> 6 & 0x1F));
            let access = (kind & 1 != 0, width, false);
            transfer(access, low(opcode, 0), low(opcode, 3), offset)
        }
        ThumbFormat::TransferStack { load } => {
            let offset = Operand::constant(4 * (opcode & 0xFF));
            transfer((load, Width::Word, false), low(opcode, 8), 13, offset)
        }
        ThumbFormat::PushPop { load } => {
            let extra = match (opcode & 0x100 != 0, load) {
                (false, _) => 0,
                (true, false) => 1 << 14,
                (true, true) => 1 << 15,
            };
            block(load, 13, (opcode & 0xFF) | extra)
        }
        ThumbFormat::Multiple { load } => block(load, low(opcode, 8), opcode & 0xFF),
        _ => Operation::Undefined,
    }
}

fn simple(operation: ConstantOperation) -> AluOperation {
    match operation {
        ConstantOperation::Move => AluOperation::Mov,
        ConstantOperation::Compare => AluOperation::Cmp,
        ConstantOperation::Add => AluOperation::Add,
        ConstantOperation::Subtract => AluOperation::Sub,
    }
}

fn alu(operation: AluOperation, destination: u32, first: u32, second: Operand) -> Operation {
    Operation::DataProcessing(DataProcessing {
        operation,
        sets_flags: true,
        destination,
        first,
        second,
    })
}

/// An operation that leaves the flags alone.
fn without_flags(
    operation: AluOperation,
    destination: u32,
    first: u32,
    second: Operand,
) -> Operation {
    Operation::DataProcessing(DataProcessing {
        operation,
        sets_flags: false,
        destination,
        first,
        second,
    })
}

fn add_subtract(opcode: u32, constant: bool, minus: bool) -> Operation {
    let second = if constant {
        Operand::constant(opcode >> 6 & 7)
    } else {
        Operand::register(low(opcode, 6))
    };
    let operation = if minus {
        AluOperation::Sub
    } else {
        AluOperation::Add
    };
    alu(operation, low(opcode, 0), low(opcode, 3), second)
}

/// Format 4: two operands, the first also the destination.
fn register_operation(opcode: u32, code: u32) -> Operation {
    let (destination, source) = (low(opcode, 0), low(opcode, 3));
    let operation = match code {
        0x0 => AluOperation::And,
        0x1 => AluOperation::Eor,
        0x2..=0x4 => return shift_by_register(code - 2, destination, source),
        0x5 => AluOperation::Adc,
        0x6 => AluOperation::Sbc,
        0x7 => return shift_by_register(3, destination, source),
        0x8 => AluOperation::Tst,
        0x9 => return alu(AluOperation::Rsb, destination, source, Operand::constant(0)),
        0xA => AluOperation::Cmp,
        0xB => AluOperation::Cmn,
        0xC => AluOperation::Orr,
        0xD => return multiply(destination, source),
        0xE => AluOperation::Bic,
        _ => AluOperation::Mvn,
    };
    alu(
        operation,
        destination,
        destination,
        Operand::register(source),
    )
}

fn shift_by_register(kind: u32, register: u32, amount: u32) -> Operation {
    let second = Operand::ShiftedByRegister {
        register,
        kind,
        amount,
    };
    alu(AluOperation::Mov, register, 0, second)
}

/// The multiplier is the old destination.
fn multiply(destination: u32, source: u32) -> Operation {
    Operation::Multiply(Multiply {
        kind: MultiplyKind {
            long: false,
            signed: true,
            accumulate: false,
        },
        destination,
        low: None,
        multiplicand: source,
        multiplier: destination,
        addend: None,
        sets_flags: true,
    })
}

/// Format 5; only CMP sets flags.
fn high_register(opcode: u32, operation: ConstantOperation) -> Operation {
    let destination = (opcode & 7) | (opcode >> 4 & 8);
    Operation::DataProcessing(DataProcessing {
        operation: simple(operation),
        sets_flags: operation == ConstantOperation::Compare,
        destination,
        first: destination,
        second: Operand::register(opcode >> 3 & 15),
    })
}

fn transfer(
    (load, width, signed): (bool, Width, bool),
    register: u32,
    base: u32,
    offset: Operand,
) -> Operation {
    Operation::Transfer(Transfer {
        load,
        width,
        signed,
        register,
        base,
        offset,
        add: true,
        before: true,
        write_back: false,
    })
}

/// POP and LDMIA go up from the base, PUSH down, STMIA up; all write back.
fn block(load: bool, base: u32, encoded: u32) -> Operation {
    let (list, size_bytes) = list_and_size(encoded);
    let up = load || base != 13;
    Operation::BlockTransfer(BlockTransfer {
        load,
        base,
        list,
        size_bytes,
        before: !up,
        up,
        write_back: true,
        status: false,
    })
}
