// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Operands of instructions as operations have them.

use super::data;
use super::run::Register;
use super::transfer;
use crate::instruction::{AluOperation, Instruction, Operand, Operation, Transfer, ALWAYS};

/// Operation and kind of operand of an instruction that always computes flags.
pub(super) fn comparison(instruction: &Instruction, flags: bool) -> Option<(AluOperation, u8)> {
    let Operation::DataProcessing(processing) = &instruction.operation else {
        return None;
    };
    let plain = flags && instruction.condition == ALWAYS && processing.destination != 15;
    (plain && !processing.reads(15))
        .then(|| (processing.operation, operand_parts(processing.second).0))
}

pub(super) fn mode_of(transfer: &Transfer, mode: u8) -> u8 {
    mode | u8::from(transfer.add) * transfer::UP
        | u8::from(transfer.before) * transfer::BEFORE
        | u8::from(transfer.moves_base()) * transfer::WRITE_BACK
}

/// Kind, value, register, amount and mode of a second operand.
pub(super) fn operand_parts(operand: Operand) -> (u8, u32, Register, u8, u8) {
    let none = Register::R0;
    match operand {
        Operand::Constant { value, carry: None } => (data::CONSTANT, value, none, 0, 0),
        Operand::Constant {
            value,
            carry: Some(carry),
        } => (data::CONSTANT_CARRY, value, none, 0, u8::from(carry)),
        Operand::Shifted {
            register,
            kind,
            amount,
        } => {
            let special = match (kind, amount) {
                (0, 0) => data::REGISTER,
                (0, _) => data::LEFT,
                (1, 1..) => data::RIGHT,
                (2, 1..) => data::RIGHT_ARITHMETIC,
                _ => data::ANY_SHIFT,
            };
            (
                special,
                0,
                Register::number(register),
                amount as u8,
                kind as u8,
            )
        }
        Operand::ShiftedByRegister {
            register,
            kind,
            amount,
        } => (
            data::BY_REGISTER,
            0,
            Register::number(register),
            amount as u8,
            kind as u8,
        ),
    }
}
