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

/// Something with a stack address in it: its frame, if the rest is a number.
fn moved_in_stack(place: &Value) -> Value {
    match place {
        Value::OuterStack => Value::OuterStack,
        _ => Value::StackAny,
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
        (place, _) if place.in_stack() => moved_in_stack(place),
        (_, place) if place.in_stack() => moved_in_stack(place),
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
        (place, other) if place.in_stack() && !other.in_stack() => moved_in_stack(place),
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
