// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Puts the operations of a block together: conditions and branches.

use super::analysis::{complete_flags, is_idempotent, live_flags};
use super::source::{ends, read_source, Source};
use crate::blocks::block::{Block, JitState};
use crate::blocks::bus::{BlockBus, CodePlace};
use crate::blocks::operations::branch::{
    branch, branch_link, branch_to_itself, conditional_branch_handler, exchange, exit_to_reference,
    fall_through, long_branch, long_branch_suffix, skip_unless_handler,
};
use crate::blocks::operations::data::{data_and_branch_handler, data_handler, no_operation};
use crate::blocks::operations::encoding::{EncodedOperand, CONSTANT};
use crate::blocks::operations::run::{size_of, width_of, Handler, Op, Register};
use crate::bus::Width;
use crate::instruction::{AluOperation, Instruction, Operation, ALWAYS};

/// The operations of a block.
pub(in crate::blocks) struct Built<B: BlockBus> {
    /// Handler of the first.
    pub first: Handler<B>,
    pub ops: Vec<Op<B>>,
    /// Index of each instruction's first operation.
    pub starts: Vec<u32>,
    /// Of each instruction: the flags that it sets are observed.
    pub live_flags: Vec<bool>,
}

/// Puts operations together.
pub(super) struct Builder<'a, B: BlockBus> {
    pub(super) bus: &'a B,
    key: u32,
    memory: u8,
    /// Address of the instruction in hand.
    pub(super) address: u32,
    /// Cycles of the block's fetches before the instruction, and up to and with its own.
    before: u16,
    pub(super) through: u16,
    /// Most cycles up to the next exit.
    worst: u16,
    /// Operation and kind of operand of the last instruction, if it always sets flags.
    comparison: Option<(AluOperation, u8)>,
    first: Handler<B>,
    ops: Vec<Op<B>>,
}

/// The block that begins at `key`; none when no instruction there can be in a block.
pub(in crate::blocks) fn translate<B: BlockBus>(
    bus: &mut B,
    key: u32,
    place: CodePlace,
) -> Option<Block<B>> {
    if bus.observes_arrival(key & !1) {
        return None;
    }
    let source = read_source(bus, key, place);
    let worst_cycles = *source.worst_cycles.last()?;
    let Built { first, ops, .. } = build(bus, &source);
    let (size, count) = (size_of(key), source.instructions.len() as u32);
    // Stores near the end could change what was fetched ahead already.
    let mut last = source.instructions.iter().rev().take(2);
    let near_end = last.any(|instruction| instruction.operation.stores());
    let covered = size * if near_end { count + 2 } else { count };
    for offset in (0..covered).step_by(2) {
        bus.mark_code((key & !1).wrapping_add(offset));
    }
    Some(Block {
        key,
        halfwords: covered / 2,
        worst_cycles,
        simply_run_cycles: worst_cycles,
        is_idempotent: is_idempotent(&source.instructions),
        refusals: 0,
        first,
        ops: ops.into_boxed_slice(),
        links: [(u32::MAX, 0); 2],
        jit: JitState::cold(place.halfword, 0, 0),
    })
}

pub(in crate::blocks) fn build<B: BlockBus>(bus: &B, source: &Source) -> Built<B> {
    let (size, width) = (size_of(source.key), width_of(source.key));
    let live_flags = live_flags(&source.instructions);
    let mut builder = Builder {
        bus,
        key: source.key,
        memory: source.place.memory,
        address: source.key & !1,
        before: 0,
        through: 0,
        worst: 0,
        comparison: None,
        first: exit_to_reference,
        ops: Vec::with_capacity(source.instructions.len() + 1),
    };
    let worst = worst_cycles_at_exits(source, &live_flags);
    let mut prefix = None;
    let mut starts = Vec::with_capacity(source.instructions.len());
    let instructions = source.instructions.iter().zip(&live_flags).zip(&worst);
    for ((instruction, &flags), &worst) in instructions {
        builder.worst = worst;
        let fetched = builder.address.wrapping_add(2 * size);
        builder.through += bus.sequential_fetch_cycles(fetched, width) as u16;
        starts.push(builder.ops.len() as u32);
        builder.instruction(instruction, flags, prefix);
        builder.comparison = comparison(instruction, flags);
        prefix = match instruction.operation {
            Operation::LongBranchPrefix { offset } => Some(offset),
            _ => None,
        };
        builder.before = builder.through;
        builder.address = builder.address.wrapping_add(size);
    }
    if !source.instructions.last().is_some_and(ends) {
        let next = builder.address | source.key & 1;
        builder.push(fall_through).value = next;
    }
    Built {
        first: builder.first,
        ops: builder.ops,
        starts,
        live_flags,
    }
}

/// For each instruction the most cycles up to the next place at which the block can be left.
fn worst_cycles_at_exits(source: &Source, live_flags: &[bool]) -> Vec<u16> {
    let worst = source.worst_cycles.iter();
    let mut worst: Vec<u16> = worst.map(|&worst| worst as u16).collect();
    let complete = complete_flags(&source.instructions, live_flags);
    for index in (1..worst.len()).rev() {
        if !complete[index - 1] {
            worst[index - 1] = worst[index];
        }
    }
    worst
}

impl<B: BlockBus> Builder<'_, B> {
    pub(super) fn push(&mut self, handler: Handler<B>) -> &mut Op<B> {
        let index = self.ops.len();
        *self.handler_mut(index) = handler;
        self.ops.push(Op {
            next: exit_to_reference,
            address: self.address,
            value: 0,
            before: self.before,
            through: self.through,
            destination: Register::R0,
            first: Register::R0,
            second: Register::R0,
            third: Register::R0,
            amount: 0,
            mode: 0,
            cycles: 0,
            worst: self.worst,
        });
        &mut self.ops[index]
    }

    /// Handler of the operation of this number, which the one before it keeps.
    fn handler_mut(&mut self, number: usize) -> &mut Handler<B> {
        match number.checked_sub(1) {
            Some(before) => &mut self.ops[before].next,
            None => &mut self.first,
        }
    }

    /// The reference engine must execute the instruction.
    pub(super) fn exit(&mut self) {
        self.push(exit_to_reference);
    }

    /// r15 as an instruction here reads it.
    pub(super) fn pc(&self) -> u32 {
        self.address.wrapping_add(2 * size_of(self.key))
    }

    fn instruction(&mut self, instruction: &Instruction, flags: bool, prefix: Option<u32>) {
        let condition = instruction.condition;
        if let Operation::Branch { offset, link } = instruction.operation {
            if !link && condition < ALWAYS {
                return self.conditional_branch(condition, offset);
            }
        }
        if condition > ALWAYS {
            self.push(no_operation);
            return;
        }
        if condition < ALWAYS {
            if let Operation::DataProcessing(processing) = &instruction.operation {
                if self.data_processing_if(processing, flags, condition) {
                    return;
                }
            }
            self.push(skip_unless_handler(condition));
        }
        match &instruction.operation {
            Operation::DataProcessing(processing) => self.data_processing(processing, flags),
            Operation::Multiply(product) => self.multiply(product, flags),
            Operation::Transfer(transfer) => self.transfer(transfer),
            Operation::BlockTransfer(block) => self.block_transfer(block),
            Operation::LoadAddress {
                destination,
                offset,
            } => {
                let value = (self.pc() & !3).wrapping_add(*offset);
                self.constant(*destination, value);
            }
            Operation::LongBranchPrefix { offset } => {
                self.constant(14, self.pc().wrapping_add(*offset));
            }
            Operation::Branch { offset, link } => self.branch(*offset, *link),
            Operation::BranchExchange { register } if *register != 15 => {
                self.push(exchange).second = Register::number(*register);
            }
            Operation::BranchExchange { .. } => self.exchange_here(),
            Operation::LongBranchSuffix { offset } => self.long_branch_suffix(*offset, prefix),
            Operation::ReadStatus { destination, saved } if *destination != 15 => {
                self.read_status(*destination, *saved);
            }
            Operation::WriteStatus { saved, operand, .. } => self.write_status(*saved, *operand),
            _ => self.exit(),
        }
    }

    pub(super) fn constant(&mut self, destination: u32, value: u32) {
        let op = self.push(data_handler(AluOperation::Mov, CONSTANT, false));
        op.destination = Register::number(destination);
        op.value = value;
    }

    /// Cycles of a branch to a known target; none if no block may begin there.
    fn refill_cycles(&self, target: u32) -> Option<u16> {
        let place = self.bus.target_place(target)?;
        let sequence = self.address.wrapping_add(3 * size_of(self.key));
        let width = width_of(self.key);
        let cycles = self.bus.refill_cycles(sequence, target, width);
        (place.memory == self.memory).then_some(cycles as u16)
    }

    fn branch(&mut self, offset: u32, link: bool) {
        let target = self.pc().wrapping_add(offset);
        let (to_itself, state) = (target == self.address, self.key & 1);
        let Some(cycles) = self.refill_cycles(target) else {
            return self.exit();
        };
        let op = self.push(match (link, to_itself) {
            (true, true) => exit_to_reference,
            (true, false) => branch_link,
            (false, true) => branch_to_itself,
            (false, false) => branch,
        });
        op.value = target | state;
        op.through += cycles;
    }

    /// BX r15, as in veneers: continues in ARM state behind the instruction.
    fn exchange_here(&mut self) {
        let target = self.pc() & !3;
        let sequence = self.address.wrapping_add(3 * size_of(self.key));
        let memory = self.memory;
        let cycles = self
            .bus
            .branch_cycles(sequence, target, Width::Word, memory);
        match cycles {
            Some(cycles) if target != self.address => {
                let op = self.push(branch);
                op.value = target;
                op.through += cycles as u16;
            }
            _ => self.exit(),
        }
    }

    fn conditional_branch(&mut self, condition: u32, offset: u32) {
        let target = self.pc().wrapping_add(offset);
        match self.refill_cycles(target) {
            Some(cycles) if target != self.address => {
                let state = self.key & 1;
                let op = self.push(conditional_branch_handler(condition));
                op.value = target | state;
                op.through += cycles;
                self.join_with_comparison(condition);
            }
            _ => {
                self.push(skip_unless_handler(condition));
                self.exit();
            }
        }
    }

    /// A usual comparison before the branch takes the branch as well.
    fn join_with_comparison(&mut self, condition: u32) {
        let Some((operation, kind)) = self.comparison else {
            return;
        };
        let before = self.ops.len().checked_sub(2);
        let joined = data_and_branch_handler(operation, kind, condition);
        if let (Some(handler), Some(number)) = (joined, before) {
            *self.handler_mut(number) = handler;
        }
    }

    fn long_branch_suffix(&mut self, offset: u32, prefix: Option<u32>) {
        let Some(prefix) = prefix else {
            self.push(long_branch_suffix).value = offset;
            return;
        };
        // r15 as the first half read it.
        let base = self.pc().wrapping_sub(2).wrapping_add(prefix);
        let target = base.wrapping_add(offset) & !1;
        match self.refill_cycles(target) {
            Some(cycles) if target != self.address => {
                let op = self.push(long_branch);
                op.value = target | 1;
                op.through += cycles;
            }
            _ => self.exit(),
        }
    }
}

/// Operation and kind of operand of an instruction that always computes flags.
fn comparison(instruction: &Instruction, flags: bool) -> Option<(AluOperation, u8)> {
    let Operation::DataProcessing(processing) = &instruction.operation else {
        return None;
    };
    let plain = flags && instruction.condition == ALWAYS && processing.destination != 15;
    (plain && !processing.reads(15)).then(|| {
        (
            processing.operation,
            EncodedOperand::of(processing.second).kind,
        )
    })
}
