// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Data processing.

use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::{Field, Flag};
use crate::function::Function;
use crate::shift::Shifted;

/// The result of the operation can be computed and dropped: it takes no cycles of its own and sets
/// no flags.
pub(crate) const fn is_pure(processing: &DataProcessing, flags: bool) -> bool {
    !flags && !matches!(processing.second, Operand::ShiftedByRegister { .. })
}

impl Function<'_> {
    /// An operation that neither reads nor writes r15.
    pub fn data_processing(&mut self, processing: &DataProcessing, flags: bool) {
        let by_register = matches!(processing.second, Operand::ShiftedByRegister { .. });
        self.known.pending += u32::from(by_register);
        if !flags && processing.operation.compares() {
            return;
        }
        let second = self.operand(processing.second, flags);
        let first = if processing.operation.moves() {
            second.value
        } else {
            self.get(processing.first)
        };
        let result = self.result(processing.operation, (first, second), flags);
        if !processing.operation.compares() {
            self.set(processing.destination, result);
        }
    }

    /// The result of an operation, which also sets the flags if they are observed.
    fn result(
        &mut self,
        operation: AluOperation,
        (a, second): (Value, Shifted),
        flags: bool,
    ) -> Value {
        let b = second.value;
        let ins = self.ins();
        match operation {
            AluOperation::Sub | AluOperation::Cmp => return self.difference(a, b, flags),
            AluOperation::Rsb => return self.difference(b, a, flags),
            AluOperation::Add | AluOperation::Cmn => return self.sum(a, b, flags),
            AluOperation::Adc => return self.sum_with_carry(a, b, flags),
            AluOperation::Sbc => {
                let inverse = ins.bnot(b);
                return self.sum_with_carry(a, inverse, flags);
            }
            AluOperation::Rsc => {
                let inverse = ins.bnot(a);
                return self.sum_with_carry(b, inverse, flags);
            }
            _ => {}
        }
        let result = match operation {
            AluOperation::And | AluOperation::Tst => ins.band(a, b),
            AluOperation::Eor | AluOperation::Teq => ins.bxor(a, b),
            AluOperation::Orr => ins.bor(a, b),
            AluOperation::Bic => ins.band_not(a, b),
            AluOperation::Mvn => ins.bnot(b),
            _ => b,
        };
        if flags {
            self.known.flags.set_nz(result);
            if let Some(carry) = second.carry {
                self.known.flags.set(Field::Carry, carry);
            }
        }
        result
    }

    fn difference(&mut self, a: Value, b: Value, flags: bool) -> Value {
        let result = self.ins().isub(a, b);
        if flags {
            self.known.flags.set_difference(a, b, result);
        }
        result
    }

    fn sum(&mut self, a: Value, b: Value, flags: bool) -> Value {
        let result = self.ins().iadd(a, b);
        if flags {
            let carry = Flag::CarryOut(result, a);
            self.known.flags.set_sum(a, b, result, carry);
        }
        result
    }

    fn sum_with_carry(&mut self, a: Value, b: Value, flags: bool) -> Value {
        let carry = self.carry();
        let wide = [a, b, carry].map(|value| self.ins().uextend(types::I64, value));
        let sum = self.ins().iadd(wide[0], wide[1]);
        let sum = self.ins().iadd(sum, wide[2]);
        let result = self.ins().ireduce(types::I32, sum);
        if flags {
            let carry = self.ins().ushr_imm(sum, 32);
            let carry = Flag::Value(self.ins().ireduce(types::I32, carry));
            self.known.flags.set_sum(a, b, result, carry);
        }
        result
    }

    /// A pure operation, whose result is kept only if the condition holds.
    pub fn data_processing_if(&mut self, processing: &DataProcessing, condition: u32) {
        if processing.operation.compares() {
            return;
        }
        let holds = self.condition(condition);
        let old = self.get(processing.destination);
        self.data_processing(processing, false);
        let new = self.get(processing.destination);
        let kept = self.ins().select(holds, new, old);
        self.set(processing.destination, kept);
    }

    /// Do two values differ?
    pub fn differs(&mut self, a: Value, b: Value) -> Value {
        self.ins().icmp(IntCC::NotEqual, a, b)
    }
}
