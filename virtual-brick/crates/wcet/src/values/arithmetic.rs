// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Arithmetic on what is known about operands. Elements are computed with the core's own adder
//! and shifter.

use crate::inputs::memory_map::MemoryMap;
use crate::values::approximation::approximate;
use crate::values::comparison::Comparison;
use crate::values::flags::{
    distance_flags, logical_flags, order_flags, result_flags, scalar, ANY_FLAGS,
};
use crate::values::interval::without_lowest_one;
use crate::values::operand::{carry_in, ShifterOperand};
use crate::values::relations::Location;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::{shift_by_constant, ROR};
use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand};

/// Most pairs of elements that are computed one by one.
const PAIRS: usize = 1024;

/// Result of an operation with the flags it may set.
pub struct AluResult {
    /// The result.
    pub value: Value,
    /// Possible flags.
    pub flags: u16,
    /// What the flags compare.
    pub comparison: Option<Comparison>,
}

/// Computes an operation.
pub fn compute(
    state: &State,
    map: &MemoryMap,
    processing: &DataProcessing,
    first: Value,
    second: ShifterOperand,
) -> AluResult {
    let operation = processing.operation;
    if let Some((value, flags)) = combined_with_itself(processing, &first) {
        return AluResult {
            value,
            flags,
            comparison: None,
        };
    }
    let carry = carry_in(state);
    let exact = elementwise(state, operation, &first, &second, carry);
    let comparison = compared(operation, &second).map(|right| Comparison {
        left: (Some(processing.first), first.clone()),
        right,
        result: None,
        moved: None,
    });
    let (value, flags) = match exact {
        Some(outcome) => outcome,
        None => {
            let value = match numbers_apart_by_one(state, processing, &second) {
                Some(number) => without_lowest_one(&state.registers[number as usize]),
                None => approximate(map, operation, &first, &second.value),
            };
            let flags = match &comparison {
                Some(comparison) => order_flags(&comparison.left.1, &comparison.right.1),
                None => ANY_FLAGS,
            };
            let flags = flags & result_flags(&value);
            (value, flags)
        }
    };
    let (value, flags) = match known_distance(state, processing, &second) {
        Some(apart) => (Value::Constant(apart), flags & distance_flags(apart as i32)),
        None => (value, flags),
    };
    let flags = flags & span_flags(state, processing, &second);
    AluResult {
        value,
        flags,
        comparison,
    }
}

/// The subtrahend of an operation that compares: adding a constant is subtracting its negative,
/// also for the carry and the overflow, but for zero and for the least number.
fn compared(operation: AluOperation, second: &ShifterOperand) -> Option<(Option<u32>, Value)> {
    match (operation, second.value.constant()) {
        (AluOperation::Cmp | AluOperation::Sub, _) => Some((second.register, second.value.clone())),
        (AluOperation::Cmn | AluOperation::Add, Some(added)) if added << 1 != 0 => {
            Some((None, Value::Constant(added.wrapping_neg())))
        }
        _ => None,
    }
}

/// Flags that the distances between two compared registers allow.
fn span_flags(state: &State, processing: &DataProcessing, second: &ShifterOperand) -> u16 {
    let compares = matches!(processing.operation, AluOperation::Cmp | AluOperation::Sub);
    let found = second.register.filter(|_| compares);
    found
        .and_then(|register| state.span_flags(processing.first, register))
        .unwrap_or(ANY_FLAGS)
}

/// The greater of two registers that differ by one and are combined by `and`.
fn numbers_apart_by_one(
    state: &State,
    processing: &DataProcessing,
    second: &ShifterOperand,
) -> Option<u32> {
    let (a, b) = (processing.first, second.register?);
    let places = [a, b].map(Location::Register);
    let and = processing.operation == AluOperation::And;
    match state
        .relations
        .between(places[0], places[1])
        .filter(|_| and)?
    {
        1 => Some(a),
        u32::MAX => Some(b),
        _ => None,
    }
}

/// What a subtraction of two registers gives that differ by a known distance, whatever they hold.
fn known_distance(
    state: &State,
    processing: &DataProcessing,
    second: &ShifterOperand,
) -> Option<u32> {
    let (from, less) = match processing.operation {
        AluOperation::Sub | AluOperation::Cmp => (processing.first, second.register?),
        AluOperation::Rsb => (second.register?, processing.first),
        _ => return None,
    };
    let [place, other] = [from, less].map(Location::Register);
    if from == less {
        Some(0)
    } else {
        state.relations.between(place, other)
    }
}

/// A register with itself shifted, as compilers multiply by constants: both hold the same element.
/// `None` where the carry is used or the shifter sets it. The value and the flags.
fn combined_with_itself(processing: &DataProcessing, value: &Value) -> Option<(Value, u16)> {
    let operation = processing.operation;
    let Operand::Shifted {
        register,
        kind,
        amount,
    } = processing.second
    else {
        return None;
    };
    let extends = kind == ROR && amount == 0;
    let shifter_carry = processing.sets_flags && is_logical(operation);
    let carried = extends || uses_carry(operation) || shifter_carry;
    if register != processing.first || carried || operation.moves() {
        return None;
    }
    let one = |element: &u32| {
        let shifted = shift_by_constant(kind, *element, amount, false).value;
        scalar(operation, *element, shifted, false)
    };
    let each: Vec<(u32, u32)> = value.elements()?.iter().map(one).collect();
    let flags = each
        .iter()
        .fold(0, |flags, (_, more)| flags | 1_u16 << more);
    let values = each.into_iter().map(|(value, _)| value).collect();
    Some((Value::of_elements(values)?, flags))
}

const fn is_logical(operation: AluOperation) -> bool {
    matches!(
        operation,
        AluOperation::And
            | AluOperation::Eor
            | AluOperation::Tst
            | AluOperation::Teq
            | AluOperation::Orr
            | AluOperation::Mov
            | AluOperation::Bic
            | AluOperation::Mvn
    )
}

const fn uses_carry(operation: AluOperation) -> bool {
    matches!(
        operation,
        AluOperation::Adc | AluOperation::Sbc | AluOperation::Rsc
    )
}

fn elementwise(
    state: &State,
    operation: AluOperation,
    first: &Value,
    second: &ShifterOperand,
    carry: Option<bool>,
) -> Option<(Value, u16)> {
    let moves = operation.moves();
    let carry = if uses_carry(operation) {
        carry
    } else {
        Some(false)
    };
    let one = |a: u32, b: u32, carry: bool| {
        let (value, sum_flags) = scalar(operation, a, b, carry);
        let flags = if is_logical(operation) {
            logical_flags(state.flags, value, second.carry)
        } else {
            1 << sum_flags
        };
        (value, flags)
    };
    let known = if moves { Some(0) } else { first.constant() };
    if let (Some(a), Some(b), Some(carry)) = (known, second.value.constant(), carry) {
        let (value, flags) = one(a, b, carry);
        return Some((Value::Constant(value), flags));
    }
    let left = if moves { vec![0] } else { first.elements()? };
    let right = second.value.elements()?;
    if left.len() * right.len() > PAIRS {
        return None;
    }
    let carries = carry.map_or(vec![false, true], |known| vec![known]);
    let (mut values, mut flags) = (Vec::new(), 0);
    for a in &left {
        for b in &right {
            for carry in &carries {
                let (value, more) = one(*a, *b, *carry);
                values.push(value);
                flags |= more;
            }
        }
    }
    Some((Value::of_elements(values)?, flags))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::operand::shifter_operand;
    use arm7tdmi::alu::LSL;

    #[test]
    fn a_register_and_itself_shifted_hold_the_same_element() {
        let fivefold = DataProcessing {
            operation: AluOperation::Add,
            sets_flags: false,
            destination: 3,
            first: 3,
            second: Operand::Shifted {
                register: 3,
                kind: LSL,
                amount: 2,
            },
        };
        let fives = (0..=255).map(|element| 5 * element).collect();
        let found = combined_with_itself(&fivefold, &Value::Range(0, 255));
        assert_eq!(found.map(|(value, _)| value), Value::of_elements(fives));
        let other = DataProcessing {
            first: 2,
            ..fivefold
        };
        assert_eq!(combined_with_itself(&other, &Value::Range(0, 255)), None);
    }

    #[test]
    fn registers_that_differ_by_a_distance_give_it_whatever_they_hold() {
        let mut state = State::entry(&std::array::from_fn(|_| Value::Top));
        let [one, other] = [1, 2].map(Location::Register);
        state.relations.note(other, one, 4);
        let less = |first, register| {
            let compared = DataProcessing {
                operation: AluOperation::Cmp,
                sets_flags: true,
                destination: 0,
                first,
                second: Operand::register(register),
            };
            let read = |number: u32| state.registers[number as usize].clone();
            let operand = shifter_operand(&state, compared.second, read);
            let map = MemoryMap::without_wait_states();
            compute(&state, &map, &compared, read(first), operand)
        };
        assert_eq!(less(2, 1).value, Value::Constant(4));
        assert_eq!(less(1, 2).value, Value::Constant(4_u32.wrapping_neg()));
        // Negative and not zero, carry and overflow as may be.
        assert_eq!(less(1, 2).flags, 0b1111 << 8);
        assert_eq!(less(2, 2).flags, 1 << 0b0110);
    }
}
