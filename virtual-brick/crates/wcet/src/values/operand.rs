// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The second operand of an instruction: a constant or a register, perhaps shifted. Elements are
//! shifted by the core's own shifter.

use crate::values::flags::WITH_CARRY;
use crate::values::interval::shifted;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::{shift_by_constant, shift_by_register};
use arm7tdmi::instruction::Operand;

/// Most amounts of a shift that are told apart.
const MAX_AMOUNTS: usize = 64;

pub fn carry_in(state: &State) -> Option<bool> {
    let set = state.flags & WITH_CARRY != 0;
    let clear = state.flags & !WITH_CARRY != 0;
    (set != clear).then_some(set)
}

/// A second operand: its value, and the carry out of the shifter if it is known.
pub struct ShifterOperand {
    /// What is known about the value.
    pub value: Value,
    /// `None`: either.
    pub carry: Option<bool>,
    /// The register that holds the value unshifted.
    pub register: Option<u32>,
}

/// The second operand, with `read` giving the value of each register.
pub fn shifter_operand(
    state: &State,
    operand: Operand,
    read: impl Fn(u32) -> Value,
) -> ShifterOperand {
    let carry = carry_in(state);
    match operand {
        Operand::Constant { value, carry: own } => ShifterOperand {
            value: Value::Constant(value),
            carry: own.or(carry),
            register: None,
        },
        Operand::Shifted {
            register,
            kind: 0,
            amount: 0,
        } => ShifterOperand {
            value: read(register),
            carry,
            register: Some(register),
        },
        Operand::Shifted {
            register,
            kind,
            amount,
        } => shift_constant(&read(register), kind, amount, carry),
        Operand::ShiftedByRegister {
            register,
            kind,
            amount,
        } => shift_by_value(&read(register), kind, &read(amount), carry),
    }
}

const fn unknown_operand() -> ShifterOperand {
    ShifterOperand {
        value: Value::Top,
        carry: None,
        register: None,
    }
}

fn shift_elements(
    value: &Value,
    carry: Option<bool>,
    shift: impl Fn(u32, bool) -> arm7tdmi::alu::Shifted,
) -> ShifterOperand {
    if let (Value::Constant(value), Some(carry)) = (value, carry) {
        let result = shift(*value, carry);
        return ShifterOperand {
            value: Value::Constant(result.value),
            carry: Some(result.carry),
            register: None,
        };
    }
    let Some(elements) = value.elements() else {
        return unknown_operand();
    };
    let carries = carry.map_or(vec![false, true], |known| vec![known]);
    let pairs = elements
        .iter()
        .flat_map(|e| carries.iter().map(|c| (*e, *c)));
    let results: Vec<_> = pairs.map(|(e, c)| shift(e, c)).collect();
    let first = results[0].carry;
    let same = results.iter().all(|result| result.carry == first);
    let values = results.iter().map(|result| result.value).collect();
    ShifterOperand {
        value: Value::of_elements(values).unwrap_or(Value::Top),
        carry: same.then_some(first),
        register: None,
    }
}

fn shift_constant(value: &Value, kind: u32, amount: u32, carry: Option<bool>) -> ShifterOperand {
    let exact = shift_elements(value, carry, |value, carry| {
        shift_by_constant(kind, value, amount, carry)
    });
    if exact.value != Value::Top || amount == 0 {
        return exact;
    }
    ShifterOperand {
        value: shifted(value, kind, amount),
        ..exact
    }
}

/// A value shifted by the amount in a register, each amount for itself if they are few.
fn shift_by_value(value: &Value, kind: u32, amount: &Value, carry: Option<bool>) -> ShifterOperand {
    let Some(amounts) = amount.elements().filter(|all| all.len() <= MAX_AMOUNTS) else {
        return unknown_operand();
    };
    let each = amounts.iter().map(|amount| {
        let exact = shift_elements(value, carry, |value, carry| {
            shift_by_register(kind, value, amount & 0xFF, carry)
        });
        match amount & 0xFF {
            1..=31 if exact.value == Value::Top => ShifterOperand {
                value: shifted(value, kind, amount & 0xFF),
                ..exact
            },
            _ => exact,
        }
    });
    let joined = each.reduce(|a, b| ShifterOperand {
        value: a.value.join(&b.value),
        carry: a.carry.filter(|_| a.carry == b.carry),
        register: None,
    });
    joined.unwrap_or_else(unknown_operand)
}
