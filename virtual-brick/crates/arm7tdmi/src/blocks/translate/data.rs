// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Operations on registers and status registers.

use super::builder::Builder;
use crate::blocks::bus::BlockBus;
use crate::blocks::operations::branch::{fall_through, jump, return_to};
use crate::blocks::operations::data::{
    data_handler, data_if_handler, multiply, multiply_long, no_operation,
};
use crate::blocks::operations::encoding::EncodedOperand;
use crate::blocks::operations::run::{Handler, Op, Register};
use crate::blocks::operations::status;
use crate::instruction::{AluOperation, DataProcessing, Multiply, Operand};

impl<B: BlockBus> Builder<'_, B> {
    pub(super) fn data_processing(&mut self, processing: &DataProcessing, flags: bool) {
        if processing.destination == 15 {
            return self.data_processing_to_pc(processing);
        }
        if processing.takes_large_frame() {
            return self.exit();
        }
        if processing.reads(15) {
            return match self.pc_relative(processing) {
                Some(value) if !processing.sets_flags => {
                    self.constant(processing.destination, value);
                }
                _ => self.exit(),
            };
        }
        let by_register = matches!(processing.second, Operand::ShiftedByRegister { .. });
        if processing.operation.compares() && !flags && !by_register {
            self.push(no_operation);
            return;
        }
        let operand = EncodedOperand::of(processing.second);
        let handler = data_handler(processing.operation, operand.kind, flags);
        self.push_data(handler, processing, &operand);
    }

    fn push_data(
        &mut self,
        handler: Handler<B>,
        processing: &DataProcessing,
        operand: &EncodedOperand,
    ) -> &mut Op<B> {
        let op = self.push(handler);
        op.set_operand(operand);
        op.destination = Register::number(processing.destination);
        op.first = Register::number(processing.first);
        op
    }

    /// Conditional data processing as one operation; false when it needs two.
    pub(super) fn data_processing_if(
        &mut self,
        processing: &DataProcessing,
        flags: bool,
        condition: u32,
    ) -> bool {
        let exits = processing.reads(15) || processing.takes_large_frame();
        if flags || exits || processing.destination == 15 {
            return false;
        }
        let operand = EncodedOperand::of(processing.second);
        let Some(handler) = data_if_handler(processing.operation, operand.kind) else {
            return false;
        };
        self.push_data(handler, processing, &operand).cycles = condition as u8;
        true
    }

    /// MOV r15, Rm is a branch in the present state; MOVS and SUBS to r15 return from an exception.
    /// The reference engine executes the others.
    fn data_processing_to_pc(&mut self, processing: &DataProcessing) {
        let (handler, first, value): (Handler<B>, _, _) = match (
            processing.operation,
            processing.second,
            processing.sets_flags,
        ) {
            (AluOperation::Sub, Operand::Constant { value, .. }, true) => {
                (return_to, processing.first, value)
            }
            (AluOperation::Mov, second, sets_flags) => match second.plain_register() {
                Some(register) if sets_flags => (return_to, register, 0),
                Some(register) => (jump, register, 0),
                None => return self.exit(),
            },
            _ => return self.exit(),
        };
        if first == 15 {
            return self.exit();
        }
        let op = self.push(handler);
        op.first = Register::number(first);
        op.value = value;
    }

    /// Value of the usual instructions that compute an address from r15.
    fn pc_relative(&self, processing: &DataProcessing) -> Option<u32> {
        let pc = self.pc();
        match (processing.operation, processing.first, processing.second) {
            (AluOperation::Add, 15, Operand::Constant { value, .. }) => {
                Some(pc.wrapping_add(value))
            }
            (AluOperation::Sub, 15, Operand::Constant { value, .. }) => {
                Some(pc.wrapping_sub(value))
            }
            (AluOperation::Mov, _, second) if second.plain_register() == Some(15) => Some(pc),
            _ => None,
        }
    }

    /// MRS.
    pub(super) fn read_status(&mut self, destination: u32, saved: bool) {
        let op = self.push(if saved {
            status::read_saved_status
        } else {
            status::read_status
        });
        op.destination = Register::number(destination);
    }

    /// MSR.
    pub(super) fn write_status(&mut self, saved: bool, operand: Operand) {
        if operand.reads(15) {
            return self.exit();
        }
        let fields = self.bus.code_word(self.address) >> 16 & 15;
        let (next, through) = (self.address.wrapping_add(4), self.through);
        let op = self.push(if saved {
            status::write_saved_status
        } else {
            status::write_status
        });
        op.set_operand(&EncodedOperand::of(operand));
        op.mode = fields as u8;
        if matches!(operand, Operand::Constant { .. }) {
            op.mode |= status::OF_CONSTANT;
        }
        if saved {
            let op = self.push(fall_through);
            (op.value, op.before) = (next, through);
        }
    }

    pub(super) fn multiply(&mut self, product: &Multiply, flags: bool) {
        if product.uses(15) {
            return self.exit();
        }
        let kind = product.kind;
        let handler: Handler<B> = match (kind.long, kind.signed, kind.accumulate, flags) {
            (false, _, false, false) => multiply::<B, false, false>,
            (false, _, false, true) => multiply::<B, false, true>,
            (false, _, true, false) => multiply::<B, true, false>,
            (false, _, true, true) => multiply::<B, true, true>,
            (true, false, false, _) => multiply_long::<B, false, false>,
            (true, false, true, _) => multiply_long::<B, false, true>,
            (true, true, false, _) => multiply_long::<B, true, false>,
            (true, true, true, _) => multiply_long::<B, true, true>,
        };
        let op = self.push(handler);
        op.destination = Register::number(product.destination);
        op.first = Register::number(product.multiplicand);
        op.second = Register::number(product.multiplier);
        op.third = Register::number(product.third());
        op.mode = u8::from(flags);
    }
}
