// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Flags as far as they are known in a block: computed when somebody looks at them.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::function::{Field, Function};

/// Where the value of a flag is to be had, in the form of [`arm7tdmi::NativeState`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flag {
    /// The state has it.
    State,
    Value(Value),
    Constant(u32),
    /// C of a subtraction: no borrow.
    NoBorrow(Value, Value),
    /// C of an addition: its sum and one addend.
    CarryOut(Value, Value),
    /// V of a subtraction: operands and result.
    SubtractionOverflow(Value, Value, Value),
    /// V of an addition: operands and result.
    AdditionOverflow(Value, Value, Value),
    /// A bit of a value.
    Bit(Value, u8),
}

/// The four flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Flags {
    pub negative: Flag,
    pub zero: Flag,
    pub carry: Flag,
    pub overflow: Flag,
    /// All are those of the difference of these.
    pub compared: Option<(Value, Value)>,
    /// Which the state does not have, by number of the field.
    pub dirty: u8,
}

impl Flags {
    pub const IN_STATE: Self = Self {
        negative: Flag::State,
        zero: Flag::State,
        carry: Flag::State,
        overflow: Flag::State,
        compared: None,
        dirty: 0,
    };

    /// With their fields.
    pub const fn each(&self) -> [(Field, Flag); 4] {
        [
            (Field::Negative, self.negative),
            (Field::Zero, self.zero),
            (Field::Carry, self.carry),
            (Field::Overflow, self.overflow),
        ]
    }

    pub const fn get(&self, field: Field) -> Flag {
        match field {
            Field::Negative => self.negative,
            Field::Zero => self.zero,
            Field::Carry => self.carry,
            Field::Overflow => self.overflow,
        }
    }

    /// One by itself.
    pub fn set(&mut self, field: Field, flag: Flag) {
        self.compared = None;
        self.dirty |= 1 << field as u8;
        match field {
            Field::Negative => self.negative = flag,
            Field::Zero => self.zero = flag,
            Field::Carry => self.carry = flag,
            Field::Overflow => self.overflow = flag,
        }
    }

    /// N and Z of a result.
    pub fn set_nz(&mut self, result: Value) {
        self.set(Field::Negative, Flag::Value(result));
        self.set(Field::Zero, Flag::Value(result));
    }

    /// All of a - b.
    pub fn set_difference(&mut self, a: Value, b: Value, result: Value) {
        self.set_nz(result);
        self.set(Field::Carry, Flag::NoBorrow(a, b));
        self.set(Field::Overflow, Flag::SubtractionOverflow(a, b, result));
        self.compared = Some((a, b));
    }

    /// All of a + b.
    pub fn set_sum(&mut self, a: Value, b: Value, result: Value) {
        self.set_nz(result);
        self.set(Field::Carry, Flag::CarryOut(result, a));
        self.set(Field::Overflow, Flag::AdditionOverflow(a, b, result));
    }
}

impl Function<'_> {
    /// The value of a flag in the form of the state.
    pub fn flag(&mut self, field: Field, flag: Flag) -> Value {
        match flag {
            Flag::State => self.load_field(field),
            Flag::Value(value) => value,
            Flag::Constant(value) => self.constant(value),
            Flag::NoBorrow(..) | Flag::CarryOut(..) => {
                let holds = self.carry_holds(flag);
                self.builder.ins().uextend(types::I32, holds)
            }
            Flag::SubtractionOverflow(a, b, result) => {
                let operands = self.builder.ins().bxor(a, b);
                let changed = self.builder.ins().bxor(a, result);
                self.builder.ins().band(operands, changed)
            }
            Flag::AdditionOverflow(a, b, result) => {
                let first = self.builder.ins().bxor(a, result);
                let second = self.builder.ins().bxor(b, result);
                self.builder.ins().band(first, second)
            }
            Flag::Bit(value, bit) => {
                let shifted = self.builder.ins().ushr_imm(value, i64::from(bit));
                if bit == 31 {
                    shifted
                } else {
                    self.builder.ins().band_imm(shifted, 1)
                }
            }
        }
    }

    fn carry_holds(&mut self, flag: Flag) -> Value {
        match flag {
            Flag::NoBorrow(a, b) => {
                let above = IntCC::UnsignedGreaterThanOrEqual;
                self.builder.ins().icmp(above, a, b)
            }
            Flag::CarryOut(sum, a) => self.builder.ins().icmp(IntCC::UnsignedLessThan, sum, a),
            _ => {
                let carry = self.flag(Field::Carry, flag);
                self.builder.ins().icmp_imm(IntCC::NotEqual, carry, 0)
            }
        }
    }

    /// Does the condition hold? 14 and 15 are not asked.
    pub fn condition(&mut self, condition: u32) -> Value {
        if let (Some((a, b)), Some(code)) = (self.known.flags.compared, difference_code(condition))
        {
            return self.builder.ins().icmp(code, a, b);
        }
        let flags = self.known.flags;
        let holds = match condition & !1 {
            0x0 => {
                let zero = self.flag(Field::Zero, flags.zero);
                self.builder.ins().icmp_imm(IntCC::Equal, zero, 0)
            }
            0x2 => self.carry_holds(flags.carry),
            0x4 => {
                let negative = self.flag(Field::Negative, flags.negative);
                self.is_negative(negative)
            }
            0x6 => {
                let overflow = self.flag(Field::Overflow, flags.overflow);
                self.is_negative(overflow)
            }
            0x8 => {
                let carry = self.carry_holds(flags.carry);
                let zero = self.flag(Field::Zero, flags.zero);
                let differs = self.builder.ins().icmp_imm(IntCC::NotEqual, zero, 0);
                self.builder.ins().band(carry, differs)
            }
            0xA => self.not_less(),
            _ => {
                let not_less = self.not_less();
                let zero = self.flag(Field::Zero, flags.zero);
                let differs = self.builder.ins().icmp_imm(IntCC::NotEqual, zero, 0);
                self.builder.ins().band(not_less, differs)
            }
        };
        if condition & 1 == 0 {
            holds
        } else {
            self.builder.ins().icmp_imm(IntCC::Equal, holds, 0)
        }
    }

    fn is_negative(&mut self, value: Value) -> Value {
        self.builder.ins().icmp_imm(IntCC::SignedLessThan, value, 0)
    }

    /// N equals V.
    fn not_less(&mut self) -> Value {
        let flags = self.known.flags;
        let negative = self.flag(Field::Negative, flags.negative);
        let overflow = self.flag(Field::Overflow, flags.overflow);
        let differ = self.builder.ins().bxor(negative, overflow);
        self.builder
            .ins()
            .icmp_imm(IntCC::SignedGreaterThanOrEqual, differ, 0)
    }

    /// Carry as 0 or 1.
    pub fn carry(&mut self) -> Value {
        self.flag(Field::Carry, self.known.flags.carry)
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
