// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Addition, subtraction and bit masks on addresses and intervals.

use crate::inputs::memory_map::MemoryMap;
use crate::values::interval::combined;
use crate::values::value::Value;
use arm7tdmi::instruction::AluOperation;

/// The result of an operation on operands of too many elements: addresses and intervals.
pub fn approximate(map: &MemoryMap, operation: AluOperation, a: &Value, b: &Value) -> Value {
    match operation {
        AluOperation::Mov => b.clone(),
        AluOperation::Add => sum(map, a, b),
        AluOperation::Sub => difference(map, a, b),
        AluOperation::Rsb => difference(map, b, a),
        AluOperation::And | AluOperation::Bic => bits_cleared(map, operation, a, b),
        _ if are_numbers(map, a, b) || operation == AluOperation::Mvn => combined(operation, a, b),
        _ => Value::Top,
    }
}

/// Farthest that a place in the stack is moved and still known.
const FARTHEST: i32 = 1 << 20;

/// Something with a stack address in it: its frame, if the rest is a number.
fn moved_in_stack(place: &Value) -> Value {
    match place {
        Value::OuterStack => Value::OuterStack,
        _ => Value::StackAny,
    }
}

/// A stack address plus or less a number.
fn moved_by(place: &Value, number: &Value, add: bool) -> Value {
    let (low, high) = number.signed();
    let near = number.bounds().is_some() && low >= -FARTHEST && high <= FARTHEST;
    let Some((first, last)) = place.stack_offsets().filter(|_| near) else {
        return moved_in_stack(place);
    };
    let (low, high) = if add { (low, high) } else { (-high, -low) };
    match (first.checked_add(low), last.checked_add(high)) {
        (Some(first), Some(last)) => Value::stack_between(first, last),
        _ => moved_in_stack(place),
    }
}

/// Is neither an address? What is not known may be one.
fn are_numbers(map: &MemoryMap, a: &Value, b: &Value) -> bool {
    let is_number = |value: &Value| value.bounds().is_some() && map.pointer_region(value).is_none();
    is_number(a) && is_number(b)
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
        (place, number) if place.in_stack() => moved_by(place, number, true),
        (number, place) if place.in_stack() => moved_by(place, number, true),
        _ => match (map.pointer_region(a), map.pointer_region(b)) {
            (Some(region), None) | (None, Some(region)) => Value::Region(region),
            (None, None) if are_numbers(map, a, b) => combined(AluOperation::Add, a, b),
            _ => Value::Top,
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
        (place, other) if place.in_stack() && !other.in_stack() => moved_by(place, other, false),
        _ => match (map.pointer_region(a), map.pointer_region(b)) {
            (Some(region), None) => Value::Region(region),
            (None, None) if are_numbers(map, a, b) => combined(AluOperation::Sub, a, b),
            _ => Value::Top,
        },
    }
}

/// Clearing low bits keeps an address in its region; clearing high ones bounds a number.
fn bits_cleared(map: &MemoryMap, operation: AluOperation, a: &Value, b: &Value) -> Value {
    let (value, mask) = match (a.constant(), b.constant()) {
        (_, Some(mask)) => (a, mask),
        (Some(mask), _) if operation == AluOperation::And => (b, mask),
        _ if a.is_unknown() && b.is_unknown() => return Value::Top,
        _ => return combined(operation, a, b),
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
    combined(AluOperation::And, value, &Value::Constant(mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_the_stack_moves_by_a_small_number_and_is_lost_by_an_unknown_one() {
        let map = MemoryMap::without_wait_states();
        let moved =
            |operation, place: &Value, number: &Value| approximate(&map, operation, place, number);
        let (place, few) = (Value::StackBetween(-16, -12), Value::Range(2, 5));
        let (add, sub) = (AluOperation::Add, AluOperation::Sub);
        assert_eq!(moved(add, &place, &few), Value::StackBetween(-14, -7));
        assert_eq!(moved(add, &few, &place), Value::StackBetween(-14, -7));
        assert_eq!(moved(sub, &place, &few), Value::StackBetween(-21, -14));
        let minus = Value::Signed(-3, 1);
        assert_eq!(
            moved(add, &Value::Stack(0), &minus),
            Value::StackBetween(-3, 1)
        );
        assert_eq!(moved(add, &place, &Value::Top), Value::StackAny);
        assert_eq!(
            moved(add, &place, &Value::Range(0, 1 << 31)),
            Value::StackAny
        );
    }
}
