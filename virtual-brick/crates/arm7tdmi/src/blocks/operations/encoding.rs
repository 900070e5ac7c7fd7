// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! How operands and addressing modes are encoded in an operation.

use super::run::{Op, Register};
use crate::blocks::bus::BlockBus;
use crate::bus::Width;
use crate::instruction::{BlockTransfer, Operand, Transfer};

/// Kinds of second operand that have handlers of their own.
pub(in crate::blocks) const CONSTANT: u8 = 0;
/// A constant whose rotation gives the carry in bit 0 of the mode.
pub(in crate::blocks) const CONSTANT_CARRY: u8 = 1;
pub(in crate::blocks) const REGISTER: u8 = 2;
/// Shifts by 1 to 31.
pub(in crate::blocks) const LEFT: u8 = 3;
pub(in crate::blocks) const RIGHT: u8 = 4;
pub(in crate::blocks) const RIGHT_ARITHMETIC: u8 = 5;
/// Any other shift by a constant, of the kind in the mode.
pub(in crate::blocks) const ANY_SHIFT: u8 = 6;
/// By the third register.
pub(in crate::blocks) const BY_REGISTER: u8 = 7;

/// How the address of a transfer is computed.
pub(in crate::blocks) const FIXED: u8 = 0;
/// `first` plus the value.
pub(in crate::blocks) const OFFSET: u8 = 1;
/// `first` plus `second` shifted left by the amount.
pub(in crate::blocks) const INDEXED: u8 = 2;
/// As the bits of the mode tell.
pub(in crate::blocks) const GENERAL: u8 = 3;
/// The value plus `second` shifted left by the amount: a table behind r15.
pub(in crate::blocks) const RELATIVE: u8 = 4;

/// Bits of the mode.
pub(in crate::blocks) const UP: u8 = 1 << 0;
pub(in crate::blocks) const BEFORE: u8 = 1 << 1;
pub(in crate::blocks) const WRITE_BACK: u8 = 1 << 2;
pub(in crate::blocks) const REGISTER_OFFSET: u8 = 1 << 3;
/// Position of the kind of shift.
pub(in crate::blocks) const SHIFT: u8 = 4;

/// Items of a transfer.
pub(in crate::blocks) const WORD: u8 = 0;
pub(in crate::blocks) const BYTE: u8 = 1;
pub(in crate::blocks) const HALFWORD: u8 = 2;
pub(in crate::blocks) const SIGNED_BYTE: u8 = 3;
pub(in crate::blocks) const SIGNED_HALFWORD: u8 = 4;

pub(in crate::blocks) const fn width(item: u8) -> Width {
    match item {
        WORD => Width::Word,
        BYTE | SIGNED_BYTE => Width::Byte,
        _ => Width::Halfword,
    }
}

/// The value that a register receives.
#[inline(always)]
pub(in crate::blocks) const fn extended(item: u8, value: u32) -> u32 {
    match item {
        SIGNED_BYTE => value as u8 as i8 as u32,
        SIGNED_HALFWORD => value as u16 as i16 as u32,
        _ => value,
    }
}

/// A multiple transfer in the value of an operation: the list, then what is added to the base for
/// the first address, and what for its new value.
pub(in crate::blocks) const fn packed(block: &BlockTransfer) -> u32 {
    let size = block.size_bytes as i32;
    let (lowest, moved) = if block.up { (0, size) } else { (-size, -size) };
    let start = if block.before == block.up {
        lowest + 4
    } else {
        lowest
    };
    let moved = if block.write_back { moved } else { 0 };
    block.list | (start as u32 & 0xFF) << 16 | (moved as u32) << 24
}

/// The mode of general addressing.
pub(in crate::blocks) fn mode_of(transfer: &Transfer, mode: u8) -> u8 {
    let bit = |condition: bool, bit: u8| if condition { bit } else { 0 };
    mode | bit(transfer.add, UP)
        | bit(transfer.before, BEFORE)
        | bit(transfer.moves_base(), WRITE_BACK)
}

/// A second operand as the fields of an operation.
pub(in crate::blocks) struct EncodedOperand {
    pub kind: u8,
    pub value: u32,
    pub register: Register,
    pub amount: u8,
    pub mode: u8,
}

impl EncodedOperand {
    pub fn of(operand: Operand) -> Self {
        let of_kind = |kind| Self {
            kind,
            value: 0,
            register: Register::R0,
            amount: 0,
            mode: 0,
        };
        let of_register = |operand_kind, register, kind, amount| Self {
            register: Register::number(register),
            amount: amount as u8,
            mode: kind as u8,
            ..of_kind(operand_kind)
        };
        match operand {
            Operand::Constant { value, carry } => Self {
                value,
                mode: u8::from(carry == Some(true)),
                ..of_kind(carry.map_or(CONSTANT, |_| CONSTANT_CARRY))
            },
            Operand::Shifted {
                register,
                kind,
                amount,
            } => {
                let operand_kind = match (kind, amount) {
                    (0, 0) => REGISTER,
                    (0, _) => LEFT,
                    (1, 1..) => RIGHT,
                    (2, 1..) => RIGHT_ARITHMETIC,
                    _ => ANY_SHIFT,
                };
                of_register(operand_kind, register, kind, amount)
            }
            Operand::ShiftedByRegister {
                register,
                kind,
                amount,
            } => of_register(BY_REGISTER, register, kind, amount),
        }
    }
}

impl<B: BlockBus> Op<B> {
    /// The third register is that of a shift's amount.
    pub fn set_operand(&mut self, operand: &EncodedOperand) {
        self.value = operand.value;
        self.second = operand.register;
        self.third = Register::number(u32::from(operand.amount));
        self.amount = operand.amount;
        self.mode = operand.mode;
    }
}
