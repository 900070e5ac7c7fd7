// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The barrel shifter (DDI 0029E, section 4.5).

use arm7tdmi::alu::{ASR, LSL, LSR};
use arm7tdmi::instruction::Operand;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::Flag;
use crate::function::Function;

/// A second operand.
pub(crate) struct Shifted {
    pub value: Value,
    /// C, if the shifter changes it and somebody asked for it.
    pub carry: Option<Flag>,
}

impl Function<'_> {
    /// The second operand; with the carry if that is wanted.
    pub fn operand(&mut self, operand: Operand, carry_wanted: bool) -> Shifted {
        match operand {
            Operand::Constant { value, carry } => Shifted {
                value: self.constant(value),
                carry: carry.map(|carry| Flag::Constant(u32::from(carry))),
            },
            Operand::Shifted {
                register,
                kind,
                amount,
            } => {
                let value = self.get(register);
                self.shifted(kind, value, amount)
            }
            Operand::ShiftedByRegister {
                register,
                kind,
                amount,
            } => {
                let (value, amount) = (self.get(register), self.get(amount));
                self.shifted_by_value(kind, value, amount, carry_wanted)
            }
        }
    }

    /// Shifted by a constant as it is encoded.
    pub fn shifted(&mut self, kind: u32, value: Value, amount: u32) -> Shifted {
        let bit = |bit: u32| Some(Flag::Bit(value, bit as u8));
        let (shifted, carry) = match (kind, amount) {
            (LSL, 0) => (value, None),
            (LSL, _) => {
                let shifted = self.ins().ishl_imm(value, i64::from(amount));
                (shifted, bit(32 - amount))
            }
            (LSR, 0) => (self.constant(0), bit(31)),
            (LSR, _) => {
                let shifted = self.ins().ushr_imm(value, i64::from(amount));
                (shifted, bit(amount - 1))
            }
            (ASR, 0) => (self.ins().sshr_imm(value, 31), bit(31)),
            (ASR, _) => {
                let shifted = self.ins().sshr_imm(value, i64::from(amount));
                (shifted, bit(amount - 1))
            }
            (_, 0) => {
                let carry = self.carry();
                let high = self.ins().ishl_imm(carry, 31);
                let low = self.ins().ushr_imm(value, 1);
                (self.ins().bor(high, low), bit(0))
            }
            (_, _) => {
                let shifted = self.ins().rotr_imm(value, i64::from(amount));
                (shifted, bit(amount - 1))
            }
        };
        Shifted {
            value: shifted,
            carry,
        }
    }

    /// Shifted by the low byte of a value.
    fn shifted_by_value(
        &mut self,
        kind: u32,
        value: Value,
        amount: Value,
        carry_wanted: bool,
    ) -> Shifted {
        let amount = self.ins().band_imm(amount, 0xFF);
        let (value, out) = if kind > ASR {
            let rotated = self.ins().rotr(value, amount);
            let out = carry_wanted.then(|| self.ins().ushr_imm(rotated, 31));
            (rotated, out)
        } else {
            self.wide_shift(kind, value, amount, carry_wanted)
        };
        let carry = out.map(|out| {
            let old = self.carry();
            let moved = self.ins().icmp_imm(IntCC::NotEqual, amount, 0);
            Flag::Value(self.ins().select(moved, out, old))
        });
        Shifted { value, carry }
    }

    /// A shift by 0 to 255 and the last bit that it moved out, if it moved.
    fn wide_shift(
        &mut self,
        kind: u32,
        value: Value,
        amount: Value,
        carry_wanted: bool,
    ) -> (Value, Option<Value>) {
        let most = self.constant(63);
        let below = IntCC::UnsignedLessThan;
        let near = self.ins().icmp(below, amount, most);
        let amount = self.ins().select(near, amount, most);
        let wide = if kind == ASR {
            self.ins().sextend(types::I64, value)
        } else {
            self.ins().uextend(types::I64, value)
        };
        let shift = |function: &mut Self, wide: Value| match kind {
            LSL => function.ins().ishl(wide, amount),
            LSR => function.ins().ushr(wide, amount),
            _ => function.ins().sshr(wide, amount),
        };
        let shifted = shift(self, wide);
        let result = self.ins().ireduce(types::I32, shifted);
        if !carry_wanted {
            return (result, None);
        }
        let out = if kind == LSL {
            self.ins().ushr_imm(shifted, 32)
        } else {
            let twice = self.ins().ishl_imm(wide, 1);
            shift(self, twice)
        };
        let out = self.ins().ireduce(types::I32, out);
        (result, Some(self.ins().band_imm(out, 1)))
    }
}
