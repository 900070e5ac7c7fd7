// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Arithmetic on what is known about operands. Elements are computed with the core's own adder
//! and shifter.

use crate::inputs::memory_map::MemoryMap;
use crate::values::relations::Place;
use crate::values::state::{Comparison, State, ANY_FLAGS};
use crate::values::value::Value;
use arm7tdmi::alu::{add, shift_by_constant, shift_by_register, LSL, LSR, ROR};
use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand};

/// Most pairs of elements that are computed one by one.
const PAIRS: usize = 1024;

/// Combinations of flags in which C is set.
const WITH_CARRY: u16 = 0b1100_1100_1100_1100;

/// A second operand: its value, and the carry out of the shifter if it is known.
pub struct Shifted {
    /// What is known about the value.
    pub value: Value,
    /// `None`: either.
    pub carry: Option<bool>,
    /// The register that holds the value unshifted.
    pub register: Option<u32>,
}

fn carry_in(state: &State) -> Option<bool> {
    let set = state.flags & WITH_CARRY != 0;
    let clear = state.flags & !WITH_CARRY != 0;
    (set != clear).then_some(set)
}

/// The second operand, with `read` giving the value of each register.
pub fn second(state: &State, operand: Operand, read: impl Fn(u32) -> Value) -> Shifted {
    let carry = carry_in(state);
    match operand {
        Operand::Constant { value, carry: own } => Shifted {
            value: Value::Constant(value),
            carry: own.or(carry),
            register: None,
        },
        Operand::Shifted {
            register,
            kind: 0,
            amount: 0,
        } => Shifted {
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
            Some(amount) => each(&read(register), carry, |value, carry| {
                shift_by_register(kind, value, amount & 0xFF, carry)
            }),
            None => unknown(),
        },
    }
}

const fn unknown() -> Shifted {
    Shifted {
        value: Value::Top,
        carry: None,
        register: None,
    }
}

fn each(
    value: &Value,
    carry: Option<bool>,
    shift: impl Fn(u32, bool) -> arm7tdmi::alu::Shifted,
) -> Shifted {
    if let (Value::Constant(value), Some(carry)) = (value, carry) {
        let result = shift(*value, carry);
        return Shifted {
            value: Value::Constant(result.value),
            carry: Some(result.carry),
            register: None,
        };
    }
    let Some(elements) = value.elements() else {
        return unknown();
    };
    let carries = carry.map_or(vec![false, true], |known| vec![known]);
    let pairs = elements
        .iter()
        .flat_map(|e| carries.iter().map(|c| (*e, *c)));
    let results: Vec<_> = pairs.map(|(e, c)| shift(e, c)).collect();
    let first = results[0].carry;
    let same = results.iter().all(|result| result.carry == first);
    let values = results.iter().map(|result| result.value).collect();
    Shifted {
        value: Value::of_elements(values).unwrap_or(Value::Top),
        carry: same.then_some(first),
        register: None,
    }
}

fn shift_constant(value: &Value, kind: u32, amount: u32, carry: Option<bool>) -> Shifted {
    let exact = each(value, carry, |value, carry| {
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
    Shifted {
        value: bounded,
        ..exact
    }
}

/// Result of an operation with the flags it may set.
pub struct Outcome {
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
    second: Shifted,
) -> Outcome {
    let operation = processing.operation;
    if let Some(value) = with_itself(processing, &first) {
        return Outcome {
            value,
            flags: ANY_FLAGS,
            comparison: None,
        };
    }
    let carry = carry_in(state);
    let exact = elementwise(state, operation, &first, &second, carry);
    let comparison =
        matches!(operation, AluOperation::Cmp | AluOperation::Sub).then(|| Comparison {
            left: (Some(processing.first), first.clone()),
            right: (second.register, second.value.clone()),
            result: None,
            moved: None,
        });
    let (value, flags) = match exact {
        Some(outcome) => outcome,
        None => {
            let value = approximate(map, operation, &first, &second.value);
            let flags = match &comparison {
                Some(comparison) => order_flags(&comparison.left.1, &comparison.right.1),
                None => ANY_FLAGS,
            };
            (value, flags)
        }
    };
    let (value, flags) = match distance(state, processing, &second) {
        Some(apart) => (Value::Constant(apart), flags & distance_flags(apart as i32)),
        None => (value, flags),
    };
    Outcome {
        value,
        flags,
        comparison,
    }
}

/// What a subtraction of two registers gives that differ by a known distance, whatever they hold.
fn distance(state: &State, processing: &DataProcessing, second: &Shifted) -> Option<u32> {
    let (from, less) = match processing.operation {
        AluOperation::Sub | AluOperation::Cmp => (processing.first, second.register?),
        AluOperation::Rsb => (second.register?, processing.first),
        _ => return None,
    };
    let [place, other] = [from, less].map(Place::Register);
    if from == less {
        Some(0)
    } else {
        state.relations.between(place, other)
    }
}

/// A register with itself shifted, as compilers multiply by constants: both hold the same element.
/// `None` where flags are set or the carry is used.
fn with_itself(processing: &DataProcessing, value: &Value) -> Option<Value> {
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
    let carried = extends || uses_carry(operation) || processing.sets_flags;
    if register != processing.first || carried || operation.moves() {
        return None;
    }
    let one = |element: &u32| {
        let shifted = shift_by_constant(kind, *element, amount, false).value;
        scalar(operation, *element, shifted, false).0
    };
    Value::of_elements(value.elements()?.iter().map(one).collect())
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
    second: &Shifted,
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
            logical_flags(state, value, second.carry)
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

/// A difference with the flags it sets.
pub fn difference_flags(a: u32, b: u32) -> (u32, u32) {
    scalar(AluOperation::Cmp, a, b, false)
}

/// One result, with N, Z, C and V as the adder gives them.
fn scalar(operation: AluOperation, a: u32, b: u32, carry: bool) -> (u32, u32) {
    let sum = match operation {
        AluOperation::Sub | AluOperation::Cmp => add(a, !b, true),
        AluOperation::Rsb => add(b, !a, true),
        AluOperation::Add | AluOperation::Cmn => add(a, b, false),
        AluOperation::Adc => add(a, b, carry),
        AluOperation::Sbc => add(a, !b, carry),
        AluOperation::Rsc => add(b, !a, carry),
        AluOperation::And | AluOperation::Tst => add(a & b, 0, false),
        AluOperation::Eor | AluOperation::Teq => add(a ^ b, 0, false),
        AluOperation::Orr => add(a | b, 0, false),
        AluOperation::Mov => add(b, 0, false),
        AluOperation::Bic => add(a & !b, 0, false),
        AluOperation::Mvn => add(!b, 0, false),
    };
    let nz = sum.value >> 31 << 3 | u32::from(sum.value == 0) << 2;
    (
        sum.value,
        nz | u32::from(sum.carry) << 1 | u32::from(sum.overflow),
    )
}

/// N and Z of a value, C from the shifter, V as before.
fn logical_flags(state: &State, value: u32, carry: Option<bool>) -> u16 {
    let nz = value >> 31 << 3 | u32::from(value == 0) << 2;
    let carries = match carry {
        None => u16::MAX,
        Some(true) => WITH_CARRY,
        Some(false) => !WITH_CARRY,
    };
    let without_overflow = if state.flags & 0x5555 != 0 { 0x5555 } else { 0 };
    let with_overflow = if state.flags & 0xAAAA != 0 { 0xAAAA } else { 0 };
    (0b1111 << nz) & carries & (without_overflow | with_overflow)
}

/// Flags that a - b can give.
fn order_flags(a: &Value, b: &Value) -> u16 {
    if let (Value::Based(base, x), Value::Based(other, y)) = (a, b) {
        if base == other {
            return distance_flags(x.wrapping_sub(*y));
        }
    }
    if let (Value::Stack(x), Value::Stack(y)) = (a, b) {
        return distance_flags(x.wrapping_sub(*y));
    }
    let ((a_low, a_high), (b_low, b_high)) = (a.unsigned(), b.unsigned());
    let ((as_low, as_high), (bs_low, bs_high)) = (a.signed(), b.signed());
    (0..16).fold(0, |mask, flags: u32| {
        let (n, z) = (flags & 8 != 0, flags & 4 != 0);
        let (c, v) = (flags & 2 != 0, flags & 1 != 0);
        let equality = if z {
            c && !n && !v && a_low <= b_high && b_low <= a_high
        } else {
            a_low != b_high || b_low != a_high
        };
        let unsigned = if c { a_high >= b_low } else { a_low < b_high };
        let signed = if n == v {
            as_high >= bs_low
        } else {
            as_low < bs_high
        };
        mask | u16::from(equality && unsigned && signed) << flags
    })
}

/// Flags of a difference that is known while its operands are not.
fn distance_flags(distance: i32) -> u16 {
    (0..16).fold(0, |mask, flags: u32| {
        let result = (flags & 8 != 0) == (distance < 0) && (flags & 4 != 0) == (distance == 0);
        let zero = distance != 0 || flags & 3 == 2;
        mask | u16::from(result && zero) << flags
    })
}

fn approximate(map: &MemoryMap, operation: AluOperation, a: &Value, b: &Value) -> Value {
    match operation {
        AluOperation::Mov => b.clone(),
        AluOperation::Add => sum(map, a, b),
        AluOperation::Sub => difference(map, a, b),
        AluOperation::Rsb => difference(map, b, a),
        AluOperation::And | AluOperation::Bic => masked(map, operation, a, b),
        _ => Value::Top,
    }
}

/// Something with a stack address in it: its frame, if the rest is a number.
fn moved_in_stack(place: &Value) -> Value {
    match place {
        Value::OuterStack => Value::OuterStack,
        _ => Value::StackAny,
    }
}

fn sum(map: &MemoryMap, a: &Value, b: &Value) -> Value {
    match (a, b) {
        (Value::Stack(offset), Value::Constant(more))
        | (Value::Constant(more), Value::Stack(offset)) => {
            Value::Stack(offset.wrapping_add(*more as i32))
        }
        (Value::MinusStack(offset), Value::Constant(more))
        | (Value::Constant(more), Value::MinusStack(offset)) => {
            Value::MinusStack(offset.wrapping_add(*more as i32))
        }
        (Value::MinusStack(one), Value::Stack(other))
        | (Value::Stack(other), Value::MinusStack(one)) => {
            Value::Constant(one.wrapping_add(*other) as u32)
        }
        (Value::Based(base, offset), Value::Constant(more))
        | (Value::Constant(more), Value::Based(base, offset))
            if map.pointer_region(&Value::Constant(*more)).is_none() =>
        {
            Value::Based(*base, offset.wrapping_add(*more as i32))
        }
        (place, _) if place.in_stack() => moved_in_stack(place),
        (_, place) if place.in_stack() => moved_in_stack(place),
        _ => match (map.pointer_region(a), map.pointer_region(b)) {
            (Some(region), None) | (None, Some(region)) => Value::Region(region),
            _ => match (a.bounds(), b.bounds()) {
                (Some((p, q)), Some((r, s))) if q.checked_add(s).is_some() => {
                    Value::range(p + r, q + s)
                }
                _ => Value::Top,
            },
        },
    }
}

fn difference(map: &MemoryMap, a: &Value, b: &Value) -> Value {
    match (a, b) {
        (Value::Stack(offset), Value::Constant(less)) => {
            Value::Stack(offset.wrapping_sub(*less as i32))
        }
        (Value::Constant(from), Value::Stack(offset)) => {
            Value::MinusStack((*from as i32).wrapping_sub(*offset))
        }
        (Value::MinusStack(offset), Value::Constant(less)) => {
            Value::MinusStack(offset.wrapping_sub(*less as i32))
        }
        (Value::Stack(one), Value::Stack(other)) => {
            Value::Constant(one.wrapping_sub(*other) as u32)
        }
        (Value::Based(base, offset), Value::Constant(less)) => {
            Value::Based(*base, offset.wrapping_sub(*less as i32))
        }
        (Value::Based(base, x), Value::Based(other, y)) if base == other => {
            Value::Constant(x.wrapping_sub(*y) as u32)
        }
        (place, other) if place.in_stack() && !other.in_stack() => moved_in_stack(place),
        _ => match (map.pointer_region(a), map.pointer_region(b)) {
            (Some(region), None) => Value::Region(region),
            (None, None) => match (a.bounds(), b.bounds()) {
                (Some((p, q)), Some((r, s))) if p >= s => Value::range(p - s, q - r),
                _ => Value::Top,
            },
            _ => Value::Top,
        },
    }
}

/// Clearing low bits keeps an address in its region; clearing high ones bounds a number.
fn masked(map: &MemoryMap, operation: AluOperation, a: &Value, b: &Value) -> Value {
    let (value, mask) = match (a.constant(), b.constant()) {
        (_, Some(mask)) => (a, mask),
        (Some(mask), _) if operation == AluOperation::And => (b, mask),
        _ => return Value::Top,
    };
    let mask = if operation == AluOperation::Bic {
        !mask
    } else {
        mask
    };
    if mask >= 0xFFFF_FF00 {
        if value.in_stack() {
            return moved_in_stack(value);
        }
        if let Some(region) = map.pointer_region(value) {
            return Value::Region(region);
        }
    }
    Value::range(0, mask.min(value.unsigned().1))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let found = with_itself(&fivefold, &Value::Range(0, 255));
        assert_eq!(found, Value::of_elements(fives));
        let other = DataProcessing {
            first: 2,
            ..fivefold
        };
        assert_eq!(with_itself(&other, &Value::Range(0, 255)), None);
    }

    #[test]
    fn registers_that_differ_by_a_distance_give_it_whatever_they_hold() {
        let mut state = State::entry(&std::array::from_fn(|_| Value::Top));
        let [one, other] = [1, 2].map(Place::Register);
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
            let operand = second(&state, compared.second, read);
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
