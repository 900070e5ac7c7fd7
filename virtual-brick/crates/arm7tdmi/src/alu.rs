// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Barrel shifter and adder (DDI 0029E, section 4.5). Pure functions.

/// A value with the carry that goes with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shifted {
    /// The shifted value.
    pub value: u32,
    /// Carry out of the shifter.
    pub carry: bool,
}

/// Logical left; the kinds are encoded as in bits 6:5 of the instruction.
pub const LSL: u32 = 0;
/// Logical right.
pub const LSR: u32 = 1;
/// Arithmetic right.
pub const ASR: u32 = 2;
/// Rotation right.
pub const ROR: u32 = 3;

#[inline(always)]
const fn bit(value: u32, number: u32) -> bool {
    (value >> number) & 1 != 0
}

/// Shift by a constant of 0 to 31; 0 encodes LSL #0, LSR #32, ASR #32 and RRX.
#[inline(always)]
pub fn shift_by_constant(kind: u32, value: u32, amount: u32, carry: bool) -> Shifted {
    match (kind & 3, amount) {
        (LSL, 0) => Shifted { value, carry },
        (ROR, 0) => Shifted {
            value: (u32::from(carry) << 31) | (value >> 1),
            carry: bit(value, 0),
        },
        (LSR | ASR, 0) => shift_by_register(kind, value, 32, carry),
        _ => shift_below_32(kind, value, amount),
    }
}

/// Shift by 1 to 31.
#[inline(always)]
fn shift_below_32(kind: u32, value: u32, amount: u32) -> Shifted {
    let amount = amount & 31;
    let last_out = bit(value, (amount.wrapping_sub(1)) & 31);
    match kind & 3 {
        LSL => Shifted {
            value: value << amount,
            carry: bit(value, 32u32.wrapping_sub(amount) & 31),
        },
        LSR => Shifted {
            value: value >> amount,
            carry: last_out,
        },
        ASR => Shifted {
            value: ((value as i32) >> amount) as u32,
            carry: last_out,
        },
        _ => Shifted {
            value: value.rotate_right(amount),
            carry: last_out,
        },
    }
}

/// Shift by the low byte of a register, 0 to 255; 0 leaves value and carry alone.
#[inline]
pub fn shift_by_register(kind: u32, value: u32, amount: u32, carry: bool) -> Shifted {
    match (kind & 3, amount) {
        (_, 0) => Shifted { value, carry },
        (_, 1..=31) => shift_below_32(kind, value, amount),
        (LSL, _) => Shifted {
            value: 0,
            carry: amount == 32 && bit(value, 0),
        },
        (LSR, _) => Shifted {
            value: 0,
            carry: amount == 32 && bit(value, 31),
        },
        (ASR, _) => Shifted {
            value: ((value as i32) >> 31) as u32,
            carry: bit(value, 31),
        },
        _ => Shifted {
            value: value.rotate_right(amount & 31),
            carry: bit(value, amount.wrapping_sub(1) & 31),
        },
    }
}

/// The 8-bit constant of a data processing instruction, rotated right by twice `rotation`.
#[inline(always)]
pub fn rotated_constant(constant: u32, rotation: u32, carry: bool) -> Shifted {
    let value = constant.rotate_right(2 * rotation);
    let carry = if rotation == 0 { carry } else { bit(value, 31) };
    Shifted { value, carry }
}

/// Codes of the data processing operations.
pub(crate) const AND: u8 = 0x0;
pub(crate) const EOR: u8 = 0x1;
pub(crate) const SUB: u8 = 0x2;
pub(crate) const RSB: u8 = 0x3;
pub(crate) const ADD: u8 = 0x4;
pub(crate) const ADC: u8 = 0x5;
pub(crate) const SBC: u8 = 0x6;
const RSC: u8 = 0x7;
pub(crate) const TST: u8 = 0x8;
const TEQ: u8 = 0x9;
pub(crate) const CMP: u8 = 0xA;
pub(crate) const CMN: u8 = 0xB;
pub(crate) const ORR: u8 = 0xC;
pub(crate) const MOV: u8 = 0xD;
pub(crate) const BIC: u8 = 0xE;
pub(crate) const MVN: u8 = 0xF;

/// Sum with the flags it produces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sum {
    /// The sum modulo 2^32.
    pub value: u32,
    /// Carry out of bit 31.
    pub carry: bool,
    /// Signed overflow.
    pub overflow: bool,
}

/// `a + b + carry`; subtraction is `add(a, !b, true)`.
#[inline(always)]
pub fn add(a: u32, b: u32, carry: bool) -> Sum {
    let wide = u64::from(a) + u64::from(b) + u64::from(carry);
    let value = wide as u32;
    Sum {
        value,
        carry: wide >> 32 != 0,
        overflow: bit(!(a ^ b) & (a ^ value), 31),
    }
}

/// Result of a data processing operation, by its code, and whether it is logical: then C comes from
/// the shifter, and V stays.
#[inline(always)]
pub(crate) fn data_operation(operation: u8, a: u32, b: u32, carry: bool) -> (Sum, bool) {
    let logical = |value| {
        let sum = Sum {
            value,
            carry: false,
            overflow: false,
        };
        (sum, true)
    };
    match operation {
        AND | TST => logical(a & b),
        EOR | TEQ => logical(a ^ b),
        SUB | CMP => (add(a, !b, true), false),
        RSB => (add(b, !a, true), false),
        ADD | CMN => (add(a, b, false), false),
        ADC => (add(a, b, carry), false),
        SBC => (add(a, !b, carry), false),
        RSC => (add(b, !a, carry), false),
        ORR => logical(a | b),
        MOV => logical(b),
        BIC => logical(a & !b),
        _ => logical(!b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn shifted(value: u32, carry: bool) -> Shifted {
        Shifted { value, carry }
    }

    #[test]
    fn constant_shift_amount_zero_encodes_the_special_cases() {
        assert_eq!(shift_by_constant(LSL, 5, 0, true), shifted(5, true));
        assert_eq!(shift_by_constant(LSR, 1 << 31, 0, false), shifted(0, true));
        assert_eq!(shift_by_constant(ASR, 1 << 31, 0, false), shifted(!0, true));
        assert_eq!(
            shift_by_constant(ROR, 3, 0, true),
            shifted(0x8000_0001, true)
        );
        assert_eq!(shift_by_constant(ROR, 2, 0, false), shifted(1, false));
    }

    #[test]
    fn register_shift_by_32_takes_the_last_bit_and_beyond_32_gives_zero() {
        assert_eq!(shift_by_register(LSL, 1, 32, false), shifted(0, true));
        assert_eq!(shift_by_register(LSL, 1, 33, true), shifted(0, false));
        assert_eq!(shift_by_register(LSR, 1 << 31, 32, false), shifted(0, true));
        assert_eq!(shift_by_register(LSR, !0, 33, true), shifted(0, false));
        assert_eq!(
            shift_by_register(ASR, 1 << 31, 200, false),
            shifted(!0, true)
        );
        assert_eq!(
            shift_by_register(ROR, 1 << 31, 32, false),
            shifted(1 << 31, true)
        );
        assert_eq!(
            shift_by_register(ROR, 0x10, 37, false),
            shifted(0x8000_0000, true)
        );
        assert_eq!(shift_by_register(LSL, 7, 0, true), shifted(7, true));
    }

    #[test]
    fn shifts_between_1_and_31_carry_out_the_last_bit_lost() {
        assert_eq!(
            shift_by_constant(LSL, 0x4000_0000, 2, false),
            shifted(0, true)
        );
        assert_eq!(shift_by_constant(LSR, 0b10, 2, false), shifted(0, true));
        assert_eq!(
            shift_by_constant(ASR, 0x8000_0000, 31, true),
            shifted(!0, false)
        );
    }

    #[test]
    fn rotated_constant_keeps_the_carry_only_when_not_rotated() {
        assert_eq!(rotated_constant(0xFF, 0, true), shifted(0xFF, true));
        assert_eq!(rotated_constant(0xFF, 4, false), shifted(0xFF00_0000, true));
        assert_eq!(rotated_constant(1, 15, true), shifted(4, false));
    }

    #[test]
    fn addition_reports_carry_and_signed_overflow() {
        let sum = |value, carry, overflow| Sum {
            value,
            carry,
            overflow,
        };
        assert_eq!(add(!0, 1, false), sum(0, true, false));
        assert_eq!(add(0x7FFF_FFFF, 0, true), sum(0x8000_0000, false, true));
        assert_eq!(add(0x8000_0000, !1, true), sum(0x7FFF_FFFF, true, true));
        assert_eq!(add(3, !3, true), sum(0, true, false));
    }
}
