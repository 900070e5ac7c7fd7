// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flags and conditions as values of the host.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::{Field, Flag};
use crate::function::Function;

impl Function<'_> {
    /// The value of a flag in the form of the state.
    pub fn flag(&mut self, field: Field) -> Value {
        match self.known.flags.get(field) {
            Flag::State => self.load_field(field),
            Flag::Value(value) => value,
            Flag::Constant(value) => self.constant(value),
            Flag::NoBorrow(..) | Flag::CarryOut(..) => {
                let holds = self.carry_holds();
                self.ins().uextend(types::I32, holds)
            }
            Flag::SubtractionOverflow(a, b, result) => {
                let operands = self.ins().bxor(a, b);
                let changed = self.ins().bxor(a, result);
                self.ins().band(operands, changed)
            }
            Flag::AdditionOverflow(a, b, result) => {
                let first = self.ins().bxor(a, result);
                let second = self.ins().bxor(b, result);
                self.ins().band(first, second)
            }
            Flag::Bit(value, bit) => {
                let shifted = self.ins().ushr_imm(value, i64::from(bit));
                if bit == 31 {
                    shifted
                } else {
                    self.ins().band_imm(shifted, 1)
                }
            }
        }
    }

    fn carry_holds(&mut self) -> Value {
        match self.known.flags.get(Field::Carry) {
            Flag::NoBorrow(a, b) => {
                let above = IntCC::UnsignedGreaterThanOrEqual;
                self.ins().icmp(above, a, b)
            }
            Flag::CarryOut(sum, a) => self.ins().icmp(IntCC::UnsignedLessThan, sum, a),
            _ => {
                let carry = self.flag(Field::Carry);
                self.ins().icmp_imm(IntCC::NotEqual, carry, 0)
            }
        }
    }

    /// Does the condition hold? 14 and 15 are not asked.
    pub fn condition(&mut self, condition: u32) -> Value {
        if let (Some((a, b)), Some(code)) = (self.known.flags.compared, difference_code(condition))
        {
            return self.ins().icmp(code, a, b);
        }
        let holds = match condition & !1 {
            0x0 => {
                let zero = self.flag(Field::Zero);
                self.ins().icmp_imm(IntCC::Equal, zero, 0)
            }
            0x2 => self.carry_holds(),
            0x4 => {
                let negative = self.flag(Field::Negative);
                self.is_negative(negative)
            }
            0x6 => {
                let overflow = self.flag(Field::Overflow);
                self.is_negative(overflow)
            }
            0x8 => {
                let carry = self.carry_holds();
                self.and_not_zero(carry)
            }
            0xA => self.not_less(),
            _ => {
                let not_less = self.not_less();
                self.and_not_zero(not_less)
            }
        };
        if condition & 1 == 0 {
            holds
        } else {
            self.ins().icmp_imm(IntCC::Equal, holds, 0)
        }
    }

    /// A condition, and Z is clear.
    fn and_not_zero(&mut self, condition: Value) -> Value {
        let zero = self.flag(Field::Zero);
        let differs = self.ins().icmp_imm(IntCC::NotEqual, zero, 0);
        self.ins().band(condition, differs)
    }

    fn is_negative(&mut self, value: Value) -> Value {
        self.ins().icmp_imm(IntCC::SignedLessThan, value, 0)
    }

    /// N equals V.
    fn not_less(&mut self) -> Value {
        let negative = self.flag(Field::Negative);
        let overflow = self.flag(Field::Overflow);
        let differ = self.ins().bxor(negative, overflow);
        self.ins()
            .icmp_imm(IntCC::SignedGreaterThanOrEqual, differ, 0)
    }

    /// Carry as 0 or 1.
    pub fn carry(&mut self) -> Value {
        self.flag(Field::Carry)
    }
}

/// The comparison of two numbers that a condition makes after their subtraction.
const fn difference_code(condition: u32) -> Option<IntCC> {
    Some(match condition {
        0x0 => IntCC::Equal,
        0x1 => IntCC::NotEqual,
        0x2 => IntCC::UnsignedGreaterThanOrEqual,
        0x3 => IntCC::UnsignedLessThan,
        0x8 => IntCC::UnsignedGreaterThan,
        0x9 => IntCC::UnsignedLessThanOrEqual,
        0xA => IntCC::SignedGreaterThanOrEqual,
        0xB => IntCC::SignedLessThan,
        0xC => IntCC::SignedGreaterThan,
        0xD => IntCC::SignedLessThanOrEqual,
        _ => return None,
    })
}
