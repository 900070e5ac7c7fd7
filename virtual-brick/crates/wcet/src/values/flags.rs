// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Sets of the condition flags N, Z, C and V: bit n of a set stands for the combination n (NZCV as
//! a number). Results of single elements come from the core's own adder.

use crate::values::value::Value;
use arm7tdmi::alu::add;
use arm7tdmi::condition_passes;
use arm7tdmi::instruction::AluOperation;

/// Every combination of N, Z, C and V.
pub const ANY_FLAGS: u16 = 0xFFFF;

/// Combinations of flags in which C is set.
pub const WITH_CARRY: u16 = 0b1100_1100_1100_1100;

/// Combinations of flags for which each condition passes.
const PASSING: [u16; 16] = {
    let mut table = [0; 16];
    let mut index = 0;
    while index < 256 {
        let (condition, flags) = (index / 16, index % 16);
        if condition_passes(condition as u32, flags as u32) {
            table[condition] |= 1 << flags;
        }
        index += 1;
    }
    table
};

/// Combinations of flags for which a condition passes.
pub fn passing(condition: u32) -> u16 {
    PASSING.get(condition as usize).copied().unwrap_or(0)
}

/// A difference with the flags it sets.
pub fn difference_flags(a: u32, b: u32) -> (u32, u32) {
    scalar(AluOperation::Cmp, a, b, false)
}

/// One result, with N, Z, C and V as the adder gives them.
pub fn scalar(operation: AluOperation, a: u32, b: u32, carry: bool) -> (u32, u32) {
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
pub fn logical_flags(before: u16, value: u32, carry: Option<bool>) -> u16 {
    let nz = value >> 31 << 3 | u32::from(value == 0) << 2;
    let carries = match carry {
        None => u16::MAX,
        Some(true) => WITH_CARRY,
        Some(false) => !WITH_CARRY,
    };
    let without_overflow = if before & 0x5555 != 0 { 0x5555 } else { 0 };
    let with_overflow = if before & 0xAAAA != 0 { 0xAAAA } else { 0 };
    (0b1111 << nz) & carries & (without_overflow | with_overflow)
}

/// Flags whose N and Z a result allows, whatever operation it comes from.
pub fn result_flags(value: &Value) -> u16 {
    let (low, high) = value.signed();
    let zero = value.clone().within(0, 0).is_some();
    (0..16).fold(0, |mask, flags: u32| {
        let possible = match (flags & 8 != 0, flags & 4 != 0) {
            (true, true) => false,
            (true, false) => low < 0,
            (false, true) => zero,
            (false, false) => high > 0,
        };
        mask | u16::from(possible) << flags
    })
}

/// Flags that a - b can give.
pub fn order_flags(a: &Value, b: &Value) -> u16 {
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
pub fn distance_flags(distance: i32) -> u16 {
    (0..16).fold(0, |mask, flags: u32| {
        let result = (flags & 8 != 0) == (distance < 0) && (flags & 4 != 0) == (distance == 0);
        let zero = distance != 0 || flags & 3 == 2;
        mask | u16::from(result && zero) << flags
    })
}
