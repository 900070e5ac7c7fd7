// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Divisions by constants, which compilers turn into a long product with a reciprocal and a shift
//! (Granlund and Montgomery, *Division by invariant integers using multiplication*, 1994). A
//! register is known as a quotient, a multiple of it or the sign of the number that was divided,
//! so a remainder has its bounds whatever the number is.
//!
//! These rules are methods of `State`, which keeps what they find, so each file knows the other.

use crate::values::relations::Location;
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::alu::{ASR, LSL, LSR};
use arm7tdmi::instruction::{AluOperation, DataProcessing, Multiply, Operand};

/// What a register holds of a number n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// n.
    Number,
    /// -1 if n is negative, else 0.
    Sign,
    /// The upper word of n times a factor.
    Upper(i64),
    /// n divided by the first, towards minus infinity, of a negative n one less even if exact.
    Floor(u32),
    /// n divided by the first, towards zero, times the second modulo 2^32.
    Multiple(u32, u32),
}

/// A register that holds a part of the number which was multiplied at `source`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quotient {
    /// The register.
    pub register: u32,
    /// Address of the multiplication.
    source: u32,
    /// n is a signed number.
    signed: bool,
    /// What n may be.
    number: Value,
    /// What the register holds.
    pub part: Part,
}

/// The divisor d of which a factor is the reciprocal: n * factor / 2^(32 + shift), rounded down, is
/// n / d rounded down for each n of 32 bits, or with a sign and n below zero, `Part::Floor`. With
/// e = factor * d - 2^(32 + shift) the quotient exceeds n / d by n * e / (d * 2^(32 + shift)).
/// That is less than 1 / d if e is at most 2^shift, or twice that for 31 bits and a sign.
pub fn divisor(factor: i64, shift: u32, signed: bool) -> Option<u32> {
    let (power, factor) = (1_i128 << (32 + shift), i128::from(factor));
    if factor <= 0 {
        return None;
    }
    let divisor = (power + factor - 1) / factor;
    let excess = factor * divisor - power;
    let most = 1_i128 << (shift + u32::from(signed));
    let fits = divisor > 1 && 0 < excess && excess <= most;
    fits.then(|| u32::try_from(divisor).ok()).flatten()
}

/// A part shifted by a constant; 0 stands for 32 where it is not LSL.
fn shifted(part: Part, signed: bool, kind: u32, amount: u32) -> Option<Part> {
    match (part, kind, amount) {
        (part, LSL, 0) => Some(part),
        (Part::Number, ASR, 31) if signed => Some(Part::Sign),
        (Part::Upper(factor), ASR, 1..) if signed => divisor(factor, amount, true).map(Part::Floor),
        (Part::Upper(factor), LSR, 1..) if !signed => {
            divisor(factor, amount, false).map(|divisor| Part::Multiple(divisor, 1))
        }
        (Part::Multiple(divisor, factor), LSL, _) => {
            Some(Part::Multiple(divisor, factor.wrapping_shl(amount)))
        }
        _ => None,
    }
}

fn added(a: Part, b: Part, signed: bool) -> Option<Part> {
    match (a, b) {
        (Part::Upper(factor), Part::Number) | (Part::Number, Part::Upper(factor))
            if signed && factor < 0 =>
        {
            Some(Part::Upper(factor + (1 << 32)))
        }
        (Part::Multiple(d, k), Part::Multiple(e, l)) if d == e => {
            Some(Part::Multiple(d, k.wrapping_add(l)))
        }
        _ => None,
    }
}

fn subtracted(a: Part, b: Part) -> Option<Part> {
    match (a, b) {
        (Part::Floor(divisor), Part::Sign) => Some(Part::Multiple(divisor, 1)),
        (Part::Upper(factor), Part::Sign) => {
            divisor(factor, 0, true).map(|divisor| Part::Multiple(divisor, 1))
        }
        (Part::Multiple(d, k), Part::Multiple(e, l)) if d == e => {
            Some(Part::Multiple(d, k.wrapping_sub(l)))
        }
        _ => None,
    }
}

/// Quotient, towards zero, and remainder of a number and a constant that is not zero.
pub fn divided(number: &Value, divisor: u32, signed: bool) -> (Value, Value) {
    let (low, high) = number.integers(signed);
    let divisor = i128::from(divisor);
    let quotient = Value::of_interval(low / divisor, high / divisor);
    let most = divisor - 1;
    (
        quotient,
        Value::of_interval(low.clamp(-most, 0), high.clamp(0, most)),
    )
}

impl Quotient {
    /// What the register holds, as far as it is a quotient.
    fn value(&self) -> Option<Value> {
        match self.part {
            Part::Multiple(divisor, 1) => Some(divided(&self.number, divisor, self.signed).0),
            _ => None,
        }
    }

    /// What is known of this number and another one that were both divided at one place.
    pub fn join(&self, other: &Self, join: impl Fn(&Value, &Value) -> Value) -> Option<Self> {
        let same = (self.register, self.source, self.signed, self.part)
            == (other.register, other.source, other.signed, other.part);
        same.then(|| Self {
            number: join(&self.number, &other.number),
            ..self.clone()
        })
    }
}

impl State {
    fn quotient_in(&self, register: u32) -> Option<&Quotient> {
        self.quotients.iter().find(|held| held.register == register)
    }

    /// Forgets the parts of the number that was multiplied at an address before, and gives the new
    /// one with its upper word, if one factor is a constant.
    pub fn note_product(&mut self, address: u32, product: &Multiply, values: (&Value, &Value)) {
        self.quotients.retain(|held| held.source != address);
        let (number, number_in, factor) = match (values.0.constant(), values.1.constant()) {
            (Some(factor), None) => (values.1, product.multiplier, factor),
            (None, Some(factor)) => (values.0, product.multiplicand, factor),
            _ => return,
        };
        let Some(low) = product.low.filter(|_| !product.kind.accumulate) else {
            return;
        };
        let signed = product.kind.signed;
        let factor = if signed {
            i64::from(factor as i32)
        } else {
            i64::from(factor)
        };
        let place = Location::Register(number_in);
        let copies = self.relations.of(place).filter_map(|copy| match copy {
            (Location::Register(register), 0) => Some(register),
            _ => None,
        });
        let written = [low, product.destination];
        let mut holding: Vec<u32> = copies.chain([number_in]).collect();
        holding.retain(|register| !written.contains(register));
        let number = match number.bounds() {
            Some(_) => number.clone(),
            None => Value::Top,
        };
        let part = |register, part| Quotient {
            register,
            source: address,
            signed,
            number: number.clone(),
            part,
        };
        self.quotients
            .retain(|held| !holding.contains(&held.register));
        let all = holding.iter().map(|register| part(*register, Part::Number));
        let upper = part(product.destination, Part::Upper(factor));
        self.quotients.extend(all.chain([upper]));
        self.quotients.sort_by_key(|held| held.register);
    }

    /// What an operation gives on parts of a number that was divided: the part, and its value.
    pub fn quotient_of(&self, processing: &DataProcessing) -> (Option<Quotient>, Option<Value>) {
        let found = || {
            let Operand::Shifted {
                register,
                kind,
                amount,
            } = processing.second
            else {
                return None;
            };
            let right = self.quotient_in(register)?;
            let second = shifted(right.part, right.signed, kind, amount)?;
            let with = |part| Quotient {
                part,
                ..right.clone()
            };
            if processing.operation == AluOperation::Mov {
                return Some((with(second), None));
            }
            let left = self.quotient_in(processing.first)?;
            if left.source != right.source || left.signed != right.signed {
                return None;
            }
            let (from, less) = match processing.operation {
                AluOperation::Add => {
                    return added(left.part, second, right.signed).map(|part| (with(part), None))
                }
                AluOperation::Sub => (left.part, second),
                AluOperation::Rsb => (second, left.part),
                _ => return None,
            };
            match (from, less) {
                (Part::Number, Part::Multiple(divisor, factor)) if divisor == factor => {
                    let remainder = divided(&right.number, divisor, right.signed).1;
                    Some((with(Part::Number), Some(remainder)))
                }
                _ => subtracted(from, less).map(|part| (with(part), None)),
            }
        };
        match found() {
            Some((_, Some(remainder))) => (None, Some(remainder)),
            Some((part, None)) => {
                let value = part.value();
                (Some(part), value)
            }
            None => (None, None),
        }
    }

    /// A register was written with a part of a number.
    pub fn note_quotient(&mut self, register: u32, part: Quotient) {
        self.quotients.retain(|held| held.register != register);
        self.quotients.push(Quotient { register, ..part });
        self.quotients.sort_by_key(|held| held.register);
    }
}

/// `value`, and what is known of it besides.
pub fn narrowed(value: Value, known: Option<Value>) -> Value {
    match known {
        Some(known) if value.bounds().is_some() => value.meet(&known).unwrap_or(value),
        Some(known) => known,
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remainder_has_the_sign_of_the_number_and_is_less_than_the_divisor() {
        let (quotient, remainder) = divided(&Value::Top, 10, true);
        assert_eq!(quotient, Value::Signed(-214_748_364, 214_748_364));
        assert_eq!(remainder, Value::Signed(-9, 9));
        let (_, of_few) = divided(&Value::Range(0, 3), 10, true);
        assert_eq!(of_few, Value::Range(0, 3));
    }

    const FACTORS: [(i64, u32, bool, u32); 6] = [
        (0xCCCC_CCCD, 3, false, 10),
        (0xAAAA_AAAB, 1, false, 3),
        (0x5555_5556, 0, true, 3),
        (0x6666_6667, 2, true, 10),
        (0x9249_2493, 2, true, 7),
        (0x1062_4DD3, 6, true, 1000),
    ];

    #[test]
    fn a_reciprocal_divides_each_number_by_its_divisor() {
        for (factor, shift, signed, wanted) in FACTORS {
            assert_eq!(divisor(factor, shift, signed), Some(wanted), "{factor:#x}");
            let divisor = i128::from(wanted);
            let numbers = (0..5000).map(|n: i128| n * n * 171 % (1 << 32)).chain([
                (1 << 31) - 1,
                (1 << 32) - 1,
                1 << 31,
            ]);
            for number in numbers {
                let number = if signed { number - (1 << 31) } else { number };
                if signed && number >= 1 << 31 {
                    continue;
                }
                let sign = i128::from(signed && number < 0);
                let found = ((number * i128::from(factor)) >> (32 + shift)) + sign;
                assert_eq!(found, number / divisor, "{number} by {wanted}");
            }
        }
    }

    #[test]
    fn a_factor_that_is_no_reciprocal_has_no_divisor() {
        for factor in [0xCCCC_CCCB, 0xCCCC_CCCF, 0x8000_0000, 12345] {
            assert_eq!(divisor(factor, 3, false), None, "{factor:#x}");
        }
    }
}
