// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Operands of ARM opcodes (DDI 0029E, chapter 4).

use super::format::{
    arm_format, arm_index, list_and_size, ArmFormat, HalfwordTransfer, OperandKind,
};
use crate::alu::rotated_constant;
use crate::bus::Width;
use crate::instruction::{
    AluOperation, BlockTransfer, DataProcessing, Multiply, MultiplyKind, Operand, Operation,
    Transfer,
};

const fn field(opcode: u32, position: u32) -> u32 {
    opcode >> position & 15
}

const fn flag(opcode: u32, position: u32) -> bool {
    opcode >> position & 1 != 0
}

/// What an ARM opcode does when its condition passes.
pub(super) fn operation(opcode: u32) -> Operation {
    match arm_format(arm_index(opcode)) {
        ArmFormat::BranchExchange => Operation::BranchExchange {
            register: field(opcode, 0),
        },
        ArmFormat::Multiply { accumulate } => multiply(opcode, accumulate),
        ArmFormat::MultiplyLong { signed, accumulate } => multiply_long(opcode, signed, accumulate),
        ArmFormat::Swap => Operation::Swap {
            byte: flag(opcode, 22),
            destination: field(opcode, 12),
            source: field(opcode, 0),
            base: field(opcode, 16),
        },
        ArmFormat::HalfwordTransfer(kind) => halfword_transfer(opcode, kind),
        ArmFormat::Mrs => Operation::ReadStatus {
            destination: field(opcode, 12),
            saved: flag(opcode, 22),
        },
        ArmFormat::MsrRegister => write_status(opcode, false),
        ArmFormat::MsrConstant => write_status(opcode, true),
        ArmFormat::DataProcessing(kind) => data_processing(opcode, kind),
        ArmFormat::SingleTransfer { register_offset } => single_transfer(opcode, register_offset),
        ArmFormat::BlockTransfer { load } => block_transfer(opcode, load),
        ArmFormat::Branch { link } => Operation::Branch {
            offset: ((opcode << 8) as i32 >> 6) as u32,
            link,
        },
        ArmFormat::SoftwareInterrupt => Operation::SoftwareInterrupt,
        ArmFormat::Undefined => Operation::Undefined,
    }
}

fn write_status(opcode: u32, constant: bool) -> Operation {
    let operand = if constant {
        let rotated = rotated_constant(opcode & 0xFF, field(opcode, 8), false);
        Operand::constant(rotated.value)
    } else {
        Operand::Shifted {
            register: field(opcode, 0),
            kind: 0,
            amount: 0,
        }
    };
    Operation::WriteStatus {
        saved: flag(opcode, 22),
        control: flag(opcode, 16),
        flags: flag(opcode, 19),
        operand,
    }
}

const fn shifted(opcode: u32) -> Operand {
    Operand::Shifted {
        register: field(opcode, 0),
        kind: opcode >> 5 & 3,
        amount: opcode >> 7 & 0x1F,
    }
}

fn data_processing(opcode: u32, kind: OperandKind) -> Operation {
    let second = match kind {
        OperandKind::Constant => {
            let rotation = field(opcode, 8);
            let rotated = rotated_constant(opcode & 0xFF, rotation, false);
            Operand::Constant {
                value: rotated.value,
                carry: (rotation != 0).then_some(rotated.carry),
            }
        }
        OperandKind::ShiftByConstant => shifted(opcode),
        OperandKind::ShiftByRegister => Operand::ShiftedByRegister {
            register: field(opcode, 0),
            kind: opcode >> 5 & 3,
            amount: field(opcode, 8),
        },
    };
    Operation::DataProcessing(DataProcessing {
        operation: AluOperation::ALL[field(opcode, 21) as usize],
        sets_flags: flag(opcode, 20),
        destination: field(opcode, 12),
        first: field(opcode, 16),
        second,
    })
}

fn multiply(opcode: u32, accumulate: bool) -> Operation {
    Operation::Multiply(Multiply {
        kind: MultiplyKind {
            long: false,
            signed: true,
            accumulate,
        },
        destination: field(opcode, 16),
        low: None,
        multiplicand: field(opcode, 0),
        multiplier: field(opcode, 8),
        addend: accumulate.then_some(field(opcode, 12)),
        sets_flags: flag(opcode, 20),
    })
}

fn multiply_long(opcode: u32, signed: bool, accumulate: bool) -> Operation {
    Operation::Multiply(Multiply {
        kind: MultiplyKind {
            long: true,
            signed,
            accumulate,
        },
        destination: field(opcode, 16),
        low: Some(field(opcode, 12)),
        multiplicand: field(opcode, 0),
        multiplier: field(opcode, 8),
        addend: None,
        sets_flags: flag(opcode, 20),
    })
}

/// Post-indexing always writes back.
fn transfer(opcode: u32, load: bool, width: Width, signed: bool, offset: Operand) -> Operation {
    let before = flag(opcode, 24);
    Operation::Transfer(Transfer {
        load,
        width,
        signed,
        register: field(opcode, 12),
        base: field(opcode, 16),
        offset,
        add: flag(opcode, 23),
        before,
        write_back: !before || flag(opcode, 21),
    })
}

fn single_transfer(opcode: u32, register_offset: bool) -> Operation {
    let offset = if register_offset {
        shifted(opcode)
    } else {
        Operand::constant(opcode & 0xFFF)
    };
    let width = if flag(opcode, 22) {
        Width::Byte
    } else {
        Width::Word
    };
    transfer(opcode, flag(opcode, 20), width, false, offset)
}

fn halfword_transfer(opcode: u32, kind: HalfwordTransfer) -> Operation {
    let offset = if flag(opcode, 22) {
        Operand::constant((opcode >> 4 & 0xF0) | (opcode & 0x0F))
    } else {
        Operand::register(field(opcode, 0))
    };
    let (load, width, signed) = match kind {
        HalfwordTransfer::Store => (false, Width::Halfword, false),
        HalfwordTransfer::Load => (true, Width::Halfword, false),
        HalfwordTransfer::LoadSignedByte => (true, Width::Byte, true),
        HalfwordTransfer::LoadSigned => (true, Width::Halfword, true),
    };
    transfer(opcode, load, width, signed, offset)
}

fn block_transfer(opcode: u32, load: bool) -> Operation {
    let (list, size_bytes) = list_and_size(opcode);
    Operation::BlockTransfer(BlockTransfer {
        load,
        base: field(opcode, 16),
        list,
        size_bytes,
        before: flag(opcode, 24),
        up: flag(opcode, 23),
        write_back: flag(opcode, 21),
        status: flag(opcode, 22),
    })
}
