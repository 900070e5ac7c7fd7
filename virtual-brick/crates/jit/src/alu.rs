// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Data processing.

use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, InstBuilder, Value};

use crate::flags::{Field, Flag};
use crate::function::Function;

/// A result with what it makes of C and V.
enum Outcome {
    /// C as the shifter leaves it.
    Logical(Value),
    Sum(Value, Value, Value),
    Difference(Value, Value, Value),
    /// Operands, result and C of an addition with carry.
    WithCarry(Value, Value, Value, Value),
}

impl Outcome {
    const fn result(&self) -> Value {
        match self {
            Self::Logical(result)
            | Self::Sum(_, _, result)
            | Self::Difference(_, _, result)
            | Self::WithCarry(_, _, result, _) => *result,
        }
    }
}

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
        let outcome = self.outcome(processing.operation, first, second.value);
        if flags {
            self.set_flags(&outcome, second.carry);
        }
        if !processing.operation.compares() {
            self.set(processing.destination, outcome.result());
        }
    }

    fn outcome(&mut self, operation: AluOperation, a: Value, b: Value) -> Outcome {
        let ins = self.ins();
        match operation {
            AluOperation::And | AluOperation::Tst => Outcome::Logical(ins.band(a, b)),
            AluOperation::Eor | AluOperation::Teq => Outcome::Logical(ins.bxor(a, b)),
            AluOperation::Orr => Outcome::Logical(ins.bor(a, b)),
            AluOperation::Bic => Outcome::Logical(ins.band_not(a, b)),
            AluOperation::Mov => Outcome::Logical(b),
            AluOperation::Mvn => Outcome::Logical(ins.bnot(b)),
            AluOperation::Sub | AluOperation::Cmp => Outcome::Difference(a, b, ins.isub(a, b)),
            AluOperation::Rsb => Outcome::Difference(b, a, ins.isub(b, a)),
            AluOperation::Add | AluOperation::Cmn => Outcome::Sum(a, b, ins.iadd(a, b)),
            AluOperation::Adc => self.add_with_carry(a, b),
            AluOperation::Sbc => {
                let inverse = ins.bnot(b);
                self.add_with_carry(a, inverse)
            }
            AluOperation::Rsc => {
                let inverse = ins.bnot(a);
                self.add_with_carry(b, inverse)
            }
        }
    }

    fn add_with_carry(&mut self, a: Value, b: Value) -> Outcome {
        let carry = self.carry();
        let wide = [a, b, carry].map(|value| self.ins().uextend(types::I64, value));
        let sum = self.ins().iadd(wide[0], wide[1]);
        let sum = self.ins().iadd(sum, wide[2]);
        let result = self.ins().ireduce(types::I32, sum);
        Outcome::WithCarry(a, b, result, sum)
    }

    fn set_flags(&mut self, outcome: &Outcome, shifter: Option<Flag>) {
        match *outcome {
            Outcome::Logical(result) => {
                self.known.flags.set_nz(result);
                if let Some(carry) = shifter {
                    self.known.flags.set(Field::Carry, carry);
                }
            }
            Outcome::Sum(a, b, result) => self.known.flags.set_sum(a, b, result),
            Outcome::Difference(a, b, result) => self.known.flags.set_difference(a, b, result),
            Outcome::WithCarry(a, b, result, sum) => {
                self.known.flags.set_nz(result);
                let carry = self.ins().ushr_imm(sum, 32);
                let carry = self.ins().ireduce(types::I32, carry);
                self.known.flags.set(Field::Carry, Flag::Value(carry));
                let overflow = Flag::AdditionOverflow(a, b, result);
                self.known.flags.set(Field::Overflow, overflow);
            }
        }
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
