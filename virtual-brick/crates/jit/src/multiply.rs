// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Multiplications and their cycles, which depend on the multiplier.

use arm7tdmi::instruction::Multiply;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::Flag;
use crate::function::{Field, Function};

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
                let mut result = self.builder.ins().imul(multiplicand, multiplier);
                if product.kind.accumulate {
                    let addend = self.get(product.addend.unwrap_or(0));
                    result = self.builder.ins().iadd(result, addend);
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
                function.builder.ins().sextend(types::I64, value)
            } else {
                function.builder.ins().uextend(types::I64, value)
            }
        };
        let (a, b) = (widen(self, multiplicand), widen(self, multiplier));
        let mut result = self.builder.ins().imul(a, b);
        if product.kind.accumulate {
            let (high, low) = (self.get(product.destination), self.get(low));
            let high = self.builder.ins().uextend(types::I64, high);
            let high = self.builder.ins().ishl_imm(high, 32);
            let low = self.builder.ins().uextend(types::I64, low);
            let addend = self.builder.ins().bor(high, low);
            result = self.builder.ins().iadd(result, addend);
        }
        let lower = self.builder.ins().ireduce(types::I32, result);
        let upper = self.builder.ins().ushr_imm(result, 32);
        let upper = self.builder.ins().ireduce(types::I32, upper);
        if flags {
            let zero = self.builder.ins().bor(lower, upper);
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
            let sign = self.builder.ins().sshr_imm(multiplier, 31);
            leading = self.builder.ins().bxor(multiplier, sign);
        }
        let some = self.builder.ins().bor_imm(leading, 1);
        let zeros = self.builder.ins().clz(some);
        let highest = self.builder.ins().bxor_imm(zeros, 31);
        let cycles = self.builder.ins().ushr_imm(highest, 3);
        self.pass(cycles);
        self.known.pending += 1;
    }
}
