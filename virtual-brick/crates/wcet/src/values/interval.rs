// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Arithmetic on intervals of integers, reduced to 32 bits: a result is exact as an interval of the
//! integers and becomes one of words if it wraps around as a whole.

use crate::values::value::Value;
use arm7tdmi::alu::{ASR, LSL, LSR};
use arm7tdmi::instruction::AluOperation;

const MODULUS: i128 = 1 << 32;

impl Value {
    /// The words that are equal to an integer of an interval modulo 2^32; `Top` for most of them.
    pub fn of_interval(low: i128, high: i128) -> Self {
        if high - low >= MODULUS {
            return Self::Top;
        }
        let turns = low.div_euclid(MODULUS) * MODULUS;
        let (low, high) = (low - turns, high - turns);
        if high < MODULUS {
            return Self::range(low as u32, high as u32);
        }
        match (i32::try_from(low - MODULUS), i32::try_from(high - MODULUS)) {
            (Ok(low), Ok(high)) => Self::Signed(low, high),
            _ => Self::Top,
        }
    }

    /// The integers between which a number lies, signed or unsigned, whichever are closer.
    pub fn interval(&self) -> (i128, i128) {
        let (low, high) = self.unsigned();
        let (least, most) = self.signed();
        let unsigned = (i128::from(low), i128::from(high));
        let signed = (i128::from(least), i128::from(most));
        if signed.1 - signed.0 < unsigned.1 - unsigned.0 {
            signed
        } else {
            unsigned
        }
    }

    /// The signed or the unsigned integers of a word.
    pub fn integers(&self, signed: bool) -> (i128, i128) {
        if signed {
            let (low, high) = self.signed();
            (i128::from(low), i128::from(high))
        } else {
            let (low, high) = self.unsigned();
            (i128::from(low), i128::from(high))
        }
    }

    /// Ones only where `mask` has some, and at most `most` of them.
    pub fn bits(mask: u32, most: u32) -> Self {
        let most = most.min(mask.count_ones());
        match (mask, most) {
            (_, 0) => Self::Constant(0),
            (u32::MAX, 32) => Self::Top,
            _ if most == mask.count_ones() && ones_up_to(mask) == mask => Self::range(0, mask),
            _ => Self::Bits(mask, most),
        }
    }

    /// Where ones may be.
    pub fn possible_ones(&self) -> u32 {
        match self {
            Self::Bits(mask, _) => *mask,
            _ => match (self.elements(), self.bounds()) {
                (Some(all), _) => all.iter().fold(0, |a, b| a | b),
                (None, Some((_, high))) => ones_up_to(high),
                _ => u32::MAX,
            },
        }
    }

    /// Most ones among the bits.
    pub fn most_ones(&self) -> u32 {
        match (self, self.elements()) {
            (Self::Bits(_, most), _) => *most,
            (_, Some(all)) => all.iter().map(|e| e.count_ones()).max().unwrap_or(0),
            _ => self.possible_ones().count_ones(),
        }
    }

    /// The same without one number, where that is at an end of what is known.
    pub fn without(&self, number: u32) -> Option<Self> {
        if let Some(elements) = self.elements() {
            return Self::of_elements(elements.into_iter().filter(|e| *e != number).collect());
        }
        let (low, high) = match self {
            Self::Range(low, high) => (i128::from(*low), i128::from(*high)),
            Self::Signed(low, high) => (i128::from(*low), i128::from(*high)),
            _ => return Some(self.clone()),
        };
        let is_number = |end: i128| end as u32 == number;
        Some(if is_number(low) || is_number(high) {
            Self::of_interval(
                low + i128::from(is_number(low)),
                high - i128::from(is_number(high)),
            )
        } else {
            self.clone()
        })
    }
}

/// Least and greatest product of two intervals.
pub fn product(a: (i128, i128), b: (i128, i128)) -> (i128, i128) {
    let corners = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    let (low, high) = (corners.iter().min(), corners.iter().max());
    (low.copied().unwrap_or(0), high.copied().unwrap_or(0))
}

/// A number shifted by a constant from 1 to 31.
pub fn shifted(value: &Value, kind: u32, amount: u32) -> Value {
    if let Some(elements) = value.elements().filter(|_| kind == LSL) {
        let moved = elements.iter().map(|element| element << amount);
        return Value::of_elements(moved.collect()).unwrap_or(Value::Top);
    }
    let ((low, high), (least, most)) = (value.unsigned(), value.signed());
    match kind {
        LSR => match value {
            Value::Bits(mask, most) => Value::bits(mask >> amount, *most),
            _ => Value::range(low >> amount, high >> amount),
        },
        ASR => Value::of_interval(i128::from(least >> amount), i128::from(most >> amount)),
        LSL => {
            let (low, high) = value.interval();
            let bits = || Value::bits(value.possible_ones() << amount, value.most_ones());
            match Value::of_interval(low << amount, high << amount) {
                Value::Top => bits(),
                moved => moved,
            }
        }
        _ => Value::Top,
    }
}

/// Sum, difference or logical combination of two numbers.
pub fn combined(operation: AluOperation, a: &Value, b: &Value) -> Value {
    let ((low, high), (from, to)) = (a.interval(), b.interval());
    let (most_a, most_b) = (a.unsigned().1, b.unsigned().1);
    let all_bits = ones_up_to(most_a | most_b);
    match operation {
        AluOperation::Add => Value::of_interval(low + from, high + to),
        AluOperation::Sub => Value::of_interval(low - to, high - from),
        AluOperation::Rsb => Value::of_interval(from - high, to - low),
        AluOperation::And => {
            let ones = a.most_ones().min(b.most_ones());
            match a.possible_ones() & b.possible_ones() {
                mask if mask.count_ones() > ones => Value::bits(mask, ones),
                mask => Value::range(0, mask.min(most_a).min(most_b)),
            }
        }
        AluOperation::Bic => Value::range(0, most_a),
        AluOperation::Orr => Value::range(a.unsigned().0.max(b.unsigned().0), all_bits),
        AluOperation::Eor => Value::range(0, all_bits),
        AluOperation::Mvn => Value::of_interval(-1 - to, -1 - from),
        _ => Value::Top,
    }
}

/// All bits up to the highest one of a number.
const fn ones_up_to(most: u32) -> u32 {
    match most.leading_zeros() {
        32 => 0,
        zeros => u32::MAX >> zeros,
    }
}

/// A number without its lowest one: the number and itself less one have all others in common.
pub fn without_lowest_one(value: &Value) -> Value {
    Value::bits(value.possible_ones(), value.most_ones().saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_that_wraps_as_a_whole_is_signed_and_one_around_the_sign_is_not_known() {
        assert_eq!(Value::of_interval(-5, 10), Value::Signed(-5, 10));
        assert_eq!(
            Value::of_interval(MODULUS - 5, MODULUS + 10),
            Value::Signed(-5, 10)
        );
        assert_eq!(
            Value::of_interval(-5, -2),
            Value::Range(u32::MAX - 4, u32::MAX - 1)
        );
        assert_eq!(Value::of_interval(-1, MODULUS / 2), Value::Top);
        assert_eq!(Value::of_interval(0, MODULUS), Value::Top);
    }

    #[test]
    fn each_number_without_its_lowest_one_has_one_less_until_none_is_left() {
        let mut value = Value::Top;
        for _ in 0..32 {
            assert_ne!(value, Value::Constant(0));
            value = without_lowest_one(&value);
        }
        assert_eq!(value, Value::Constant(0));
    }

    #[test]
    fn products_take_the_signs_of_all_corners() {
        assert_eq!(product((-3, 5), (-7, 2)), (-35, 21));
    }
}
