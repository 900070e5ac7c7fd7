// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Formats of the two instruction sets: the one place where encodings are told apart. The core's
//! handler tables and [`crate::instruction`] are both built on it.

use crate::bus::Width;

/// Formats of ARM state (DDI 0029E, figure 4-1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArmFormat {
    BranchExchange,
    Multiply { accumulate: bool },
    MultiplyLong { signed: bool, accumulate: bool },
    Swap,
    HalfwordTransfer(HalfwordTransfer),
    Mrs,
    MsrRegister,
    MsrConstant,
    DataProcessing(OperandKind),
    SingleTransfer { register_offset: bool },
    BlockTransfer { load: bool },
    Branch { link: bool },
    SoftwareInterrupt,
    Undefined,
}

/// Signed stores do not exist; stores have the halfword pattern only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HalfwordTransfer {
    Store,
    Load,
    LoadSignedByte,
    LoadSigned,
}

/// Second operand of a data processing instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OperandKind {
    Constant,
    ShiftByConstant,
    ShiftByRegister,
}

/// Bits 27:20 and 7:4 of an ARM opcode as one number below 4096.
#[inline(always)]
pub(crate) const fn arm_index(opcode: u32) -> u32 {
    ((opcode >> 16) & 0xFF0) | ((opcode >> 4) & 0xF)
}

/// Format of the ARM opcodes with this index.
pub(crate) const fn arm_format(index: u32) -> ArmFormat {
    let (high, low) = (index >> 4, index & 0xF);
    match (high, low) {
        (0b0001_0010, 0b0001) => ArmFormat::BranchExchange,
        (0b0000_0000..=0b0000_1111, 0b1001) => multiply_format(high),
        (0b0001_0000 | 0b0001_0100, 0b1001) => ArmFormat::Swap,
        (0b0000_0000..=0b0001_1111, 0b1011 | 0b1101 | 0b1111) => halfword_format(high, low),
        (0b0000_0000..=0b0001_1111, 0b1001) => ArmFormat::Undefined,
        (0b0001_0000 | 0b0001_0100, 0b0000) => ArmFormat::Mrs,
        (0b0001_0010 | 0b0001_0110, 0b0000) => ArmFormat::MsrRegister,
        (0b0011_0010 | 0b0011_0110, _) => ArmFormat::MsrConstant,
        (0b0000_0000..=0b0011_1111, _) => data_processing_format(high, low),
        (0b0110_0000..=0b0111_1111, _) if low & 1 != 0 => ArmFormat::Undefined,
        (0b0100_0000..=0b0111_1111, _) => ArmFormat::SingleTransfer {
            register_offset: high & 0b10_0000 != 0,
        },
        (0b1000_0000..=0b1001_1111, _) => ArmFormat::BlockTransfer {
            load: high & 1 != 0,
        },
        (0b1010_0000..=0b1011_1111, _) => ArmFormat::Branch {
            link: high & 0b1_0000 != 0,
        },
        (0b1111_0000..=0b1111_1111, _) => ArmFormat::SoftwareInterrupt,
        _ => ArmFormat::Undefined,
    }
}

const fn multiply_format(high: u32) -> ArmFormat {
    match high >> 1 {
        0b000_0000 => ArmFormat::Multiply { accumulate: false },
        0b000_0001 => ArmFormat::Multiply { accumulate: true },
        0b000_0100..=0b000_0111 => ArmFormat::MultiplyLong {
            signed: high & 0b100 != 0,
            accumulate: high & 0b10 != 0,
        },
        _ => ArmFormat::Undefined,
    }
}

const fn halfword_format(high: u32, low: u32) -> ArmFormat {
    ArmFormat::HalfwordTransfer(match (high & 1 != 0, low) {
        (false, 0b1011) => HalfwordTransfer::Store,
        (true, 0b1011) => HalfwordTransfer::Load,
        (true, 0b1101) => HalfwordTransfer::LoadSignedByte,
        (true, 0b1111) => HalfwordTransfer::LoadSigned,
        _ => return ArmFormat::Undefined,
    })
}

/// The compare operations without S belong to the status and branch-exchange formats.
const fn data_processing_format(high: u32, low: u32) -> ArmFormat {
    if high & 0b1_1001 == 0b1_0000 {
        return ArmFormat::Undefined;
    }
    ArmFormat::DataProcessing(if high & 0b10_0000 != 0 {
        OperandKind::Constant
    } else if low & 1 == 0 {
        OperandKind::ShiftByConstant
    } else {
        OperandKind::ShiftByRegister
    })
}

/// Formats of Thumb state (DDI 0029E, figure 5-1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ThumbFormat {
    /// Format 1; the kind of shift.
    Shift(u32),
    AddSubtract {
        constant: bool,
        minus: bool,
    },
    /// Format 3.
    Constant(ConstantOperation),
    /// Format 4; bits 9:6.
    Register(u32),
    /// Format 5; never `Subtract`.
    HighRegister(ConstantOperation),
    BranchExchange,
    LoadRelative,
    /// Formats 7 and 8; bits 11:9.
    TransferRegister(u32),
    /// Formats 9 and 10: twice the width (word, byte, halfword), plus one for a load.
    TransferConstant(u32),
    TransferStack {
        load: bool,
    },
    LoadAddress {
        stack: bool,
    },
    AddToStackPointer,
    PushPop {
        load: bool,
    },
    Multiple {
        load: bool,
    },
    ConditionalBranch,
    SoftwareInterrupt,
    Branch,
    LongBranchPrefix,
    LongBranchSuffix,
    Undefined,
}

/// Operations of formats 3 and 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConstantOperation {
    Move,
    Compare,
    Add,
    Subtract,
}

/// Format of the Thumb opcodes whose bits 15:6 are `index`.
pub(crate) const fn thumb_format(index: u32) -> ThumbFormat {
    let load = index & 0b10_0000 != 0;
    match index >> 5 {
        0b00000..=0b00010 => ThumbFormat::Shift(index >> 5),
        0b00011 => ThumbFormat::AddSubtract {
            constant: index & 0b1_0000 != 0,
            minus: index & 0b1000 != 0,
        },
        0b00100 => ThumbFormat::Constant(ConstantOperation::Move),
        0b00101 => ThumbFormat::Constant(ConstantOperation::Compare),
        0b00110 => ThumbFormat::Constant(ConstantOperation::Add),
        0b00111 => ThumbFormat::Constant(ConstantOperation::Subtract),
        0b01000 => register_format(index & 0x1F),
        0b01001 => ThumbFormat::LoadRelative,
        0b01010 | 0b01011 => ThumbFormat::TransferRegister((index >> 3) & 7),
        0b01100..=0b10001 => ThumbFormat::TransferConstant((index >> 5) - 0b01100),
        0b10010 | 0b10011 => ThumbFormat::TransferStack { load },
        0b10100 => ThumbFormat::LoadAddress { stack: false },
        0b10101 => ThumbFormat::LoadAddress { stack: true },
        0b10110 | 0b10111 => stack_format(index),
        0b11000 | 0b11001 => ThumbFormat::Multiple { load },
        0b11010 | 0b11011 => conditional_format(index),
        0b11100 => ThumbFormat::Branch,
        0b11110 => ThumbFormat::LongBranchPrefix,
        0b11111 => ThumbFormat::LongBranchSuffix,
        _ => ThumbFormat::Undefined,
    }
}

/// Formats 4 and 5, by bits 10:6.
const fn register_format(operation: u32) -> ThumbFormat {
    match operation {
        0x00..=0x0F => ThumbFormat::Register(operation),
        0x10..=0x13 => ThumbFormat::HighRegister(ConstantOperation::Add),
        0x14..=0x17 => ThumbFormat::HighRegister(ConstantOperation::Compare),
        0x18..=0x1B => ThumbFormat::HighRegister(ConstantOperation::Move),
        _ => ThumbFormat::BranchExchange,
    }
}

/// Formats 13 and 14.
const fn stack_format(index: u32) -> ThumbFormat {
    match index >> 2 {
        0b1011_0000 => ThumbFormat::AddToStackPointer,
        0b1011_0100 | 0b1011_0101 => ThumbFormat::PushPop { load: false },
        0b1011_1100 | 0b1011_1101 => ThumbFormat::PushPop { load: true },
        _ => ThumbFormat::Undefined,
    }
}

/// Formats 16 and 17: condition 14 has no meaning, 15 is SWI.
const fn conditional_format(index: u32) -> ThumbFormat {
    match (index >> 2) & 15 {
        0xE => ThumbFormat::Undefined,
        0xF => ThumbFormat::SoftwareInterrupt,
        _ => ThumbFormat::ConditionalBranch,
    }
}

/// List and size in bytes of a register list: an empty one transfers r15 and moves the base by
/// sixteen words.
#[inline]
pub(crate) const fn list_and_size(list: u32) -> (u32, u32) {
    match list & 0xFFFF {
        0 => (1 << 15, 0x40),
        list => (list, 4 * list.count_ones()),
    }
}

/// Formats 7 and 8: load, width and sign by bits 11:9.
#[inline(always)]
pub(crate) const fn register_access(kind: u32) -> (bool, Width, bool) {
    match kind {
        0 => (false, Width::Word, false),
        1 => (false, Width::Halfword, false),
        2 => (false, Width::Byte, false),
        3 => (true, Width::Byte, true),
        4 => (true, Width::Word, false),
        5 => (true, Width::Halfword, false),
        6 => (true, Width::Byte, false),
        _ => (true, Width::Halfword, true),
    }
}
