// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The second operand of an instruction: a constant or a register, perhaps shifted. Elements are
//! shifted by the core's own shifter.

use crate::values::flags::WITH_CARRY;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::{shift_by_constant, shift_by_register, LSL, LSR};
use arm7tdmi::instruction::Operand;

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
        } => match read(amount).constant() {
            Some(amount) => shift_elements(&read(register), carry, |value, carry| {
                shift_by_register(kind, value, amount & 0xFF, carry)
            }),
            None => unknown_operand(),
        },
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
    if exact.value != Value::Top {
        return exact;
    }
    let (low, high) = value.unsigned();
    let bounded = match (kind, amount) {
        (LSR, 1..) => Value::range(low >> amount, high >> amount),
        (LSL, 1..) if high.leading_zeros() >= amount => Value::range(low << amount, high << amount),
        _ => Value::Top,
    };
    ShifterOperand {
        value: bounded,
        ..exact
    }
}
