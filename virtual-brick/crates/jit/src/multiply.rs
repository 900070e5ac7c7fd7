// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Multiplications and their cycles, which depend on the multiplier.

use arm7tdmi::instruction::Multiply;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::{Field, Flag};
use crate::function::Function;

impl Function<'_> {
    /// A multiplication of registers other than r15.
    pub fn multiply(&mut self, product: &Multiply, flags: bool) {
        let multiplicand = self.get(product.multiplicand);
        let multiplier = self.get(product.multiplier);
        self.array_cycles(multiplier, product.kind.signed || !product.kind.long);
        self.known.pending += u32::from(product.kind.long) + u32::from(product.kind.accumulate);
        match product.low {
            Some(low) if product.kind.long => {
                self.multiply_long(product, low, (multiplicand, multiplier), flags);
            }
            _ => {
                let mut result = self.ins().imul(multiplicand, multiplier);
                if product.kind.accumulate {
                    let addend = self.get(product.addend.unwrap_or(0));
                    result = self.ins().iadd(result, addend);
                }
                if flags {
                    self.known.flags.set_nz(result);
                }
                self.set(product.destination, result);
            }
        }
    }

    fn multiply_long(
        &mut self,
        product: &Multiply,
        low: u32,
        (multiplicand, multiplier): (Value, Value),
        flags: bool,
    ) {
        let widen = |function: &mut Self, value: Value| {
            if product.kind.signed {
                function.ins().sextend(types::I64, value)
            } else {
                function.ins().uextend(types::I64, value)
            }
        };
        let (a, b) = (widen(self, multiplicand), widen(self, multiplier));
        let mut result = self.ins().imul(a, b);
        if product.kind.accumulate {
            let (high, low) = (self.get(product.destination), self.get(low));
            let high = self.ins().uextend(types::I64, high);
            let high = self.ins().ishl_imm(high, 32);
            let low = self.ins().uextend(types::I64, low);
            let addend = self.ins().bor(high, low);
            result = self.ins().iadd(result, addend);
        }
        let lower = self.ins().ireduce(types::I32, result);
        let upper = self.ins().ushr_imm(result, 32);
        let upper = self.ins().ireduce(types::I32, upper);
        if flags {
            let zero = self.ins().bor(lower, upper);
            self.known.flags.set_nz(upper);
            self.known.flags.set(Field::Zero, Flag::Value(zero));
        }
        self.set(low, lower);
        self.set(product.destination, upper);
    }

    /// The array takes 8 bits of the multiplier per cycle and stops where the rest is zeros, or in
    /// signed multiplications ones.
    fn array_cycles(&mut self, multiplier: Value, signed: bool) {
        let mut leading = multiplier;
        if signed {
            let sign = self.ins().sshr_imm(multiplier, 31);
            leading = self.ins().bxor(multiplier, sign);
        }
        let some = self.ins().bor_imm(leading, 1);
        let zeros = self.ins().clz(some);
        let highest = self.ins().bxor_imm(zeros, 31);
        let cycles = self.ins().ushr_imm(highest, 3);
        self.pass(cycles);
        self.known.pending += 1;
    }
}
