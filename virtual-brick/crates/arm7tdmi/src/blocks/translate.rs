// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! From opcodes to blocks.

use super::analysis::{needed_flags, repeats, whole_flags};
use super::beyond;
use super::branch::{
    branch, branch_if_handler, branch_link, exchange, fall_through, jump, leave, long_branch,
    long_branch_suffix, only_if_handler, return_to, spin,
};
use super::bus::{BlockBus, CodePlace};
use super::data::{
    self, data_and_branch_handler, data_handler, data_if_handler, multiply, multiply_long, nothing,
};
use super::operand::{comparison, mode_of, operand_parts};
use super::region::Nativeness;
use super::run::{size_of, width_of, Handler, Op, Register};
use super::source::{ends, read_source, Source};
use super::transfer::{self, load_block, load_handler, store_block, store_handler};
use crate::bus::Width;
use crate::instruction::{
    AluOperation, BlockTransfer, DataProcessing, Instruction, Multiply, Operand, Operation,
    Transfer, ALWAYS,
};

/// Instructions that run one after the other.
pub(super) struct Block<B: BlockBus> {
    /// Address of the first; bit 0 tells Thumb state.
    pub key: u32,
    /// Halfwords whose change makes it void.
    pub halfwords: u32,
    /// Most cycles it can take.
    pub worst: u32,
    /// Running it again changes nothing, as long as memory stays.
    pub repeats: bool,
    /// Times in a row that its first instruction was left to the reference engine.
    pub refusals: u8,
    pub ops: Box<[Op<B>]>,
    /// Keys and numbers of the blocks that followed last.
    pub links: [(u32, u32); 2],
    pub native: Nativeness,
}

/// The operations of a block.
pub(super) struct Built<B: BlockBus> {
    pub ops: Vec<Op<B>>,
    /// Index of each instruction's first operation.
    pub starts: Vec<u32>,
    /// Of each instruction: somebody sees the flags that it sets.
    pub needed: Vec<bool>,
}

/// Puts operations together.
struct Builder<'a, B: BlockBus> {
    bus: &'a B,
    key: u32,
    region: u8,
    address: u32,
    before: u16,
    through: u16,
    worst: u16,
    /// Operation and kind of operand of the last instruction, if it always sets flags.
    comparison: Option<(AluOperation, u8)>,
    ops: Vec<Op<B>>,
}

/// The block that begins at `key`; none when no instruction there can be in a block.
pub(super) fn translate<B: BlockBus>(bus: &mut B, key: u32, place: CodePlace) -> Option<Block<B>> {
    if bus.looks_at(key & !1) {
        return None;
    }
    let source = read_source(bus, key, place);
    let worst = *source.worst_cycles.last()?;
    let ops = build(bus, &source).ops;
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
        worst,
        repeats: repeats(&source.instructions),
        refusals: 0,
        ops: ops.into_boxed_slice(),
        links: [(u32::MAX, 0); 2],
        native: Nativeness::none(place.halfword),
    })
}

pub(super) fn build<B: BlockBus>(bus: &B, source: &Source) -> Built<B> {
    let (size, width) = (size_of(source.key), width_of(source.key));
    let needed = needed_flags(&source.instructions);
    let mut builder = Builder {
        bus,
        key: source.key,
        region: source.place.region,
        address: source.key & !1,
        before: 0,
        through: 0,
        worst: 0,
        comparison: None,
        ops: Vec::with_capacity(source.instructions.len() + 1),
    };
    let worst = worst_where_left(source, &needed);
    let mut prefix = None;
    let mut starts = Vec::with_capacity(source.instructions.len());
    let instructions = source.instructions.iter().zip(&needed).zip(&worst);
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
        ops: builder.ops,
        starts,
        needed,
    }
}

/// For each instruction the most cycles up to the next place at which the block can be left.
fn worst_where_left(source: &Source, needed: &[bool]) -> Vec<u16> {
    let worst = source.worst_cycles.iter();
    let mut worst: Vec<u16> = worst.map(|&worst| worst as u16).collect();
    let whole = whole_flags(&source.instructions, needed);
    for index in (1..worst.len()).rev() {
        if !whole[index - 1] {
            worst[index - 1] = worst[index];
        }
    }
    worst
}

impl<B: BlockBus> Builder<'_, B> {
    fn push(&mut self, handler: Handler<B>) -> &mut Op<B> {
        let index = self.ops.len();
        self.ops.push(Op {
            handler,
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

    /// r15 as an instruction here reads it.
    fn pc(&self) -> u32 {
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
            self.push(nothing);
            return;
        }
        if condition < ALWAYS {
            if let Operation::DataProcessing(processing) = &instruction.operation {
                if self.data_processing_if(processing, flags, condition) {
                    return;
                }
            }
            self.push(only_if_handler(condition));
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
            _ => {
                self.push(leave);
            }
        }
    }

    fn constant(&mut self, destination: u32, value: u32) {
        let op = self.push(data_handler(AluOperation::Mov, data::CONSTANT, false));
        op.destination = Register::number(destination);
        op.value = value;
    }

    /// Cycles of a branch to a known target that a block may go to.
    fn refill_cycles(&self, target: u32) -> Option<u16> {
        let place = self.bus.target_place(target)?;
        let sequence = self.address.wrapping_add(3 * size_of(self.key));
        let width = width_of(self.key);
        let cycles = self.bus.refill_cycles(sequence, target, width);
        (place.region == self.region).then_some(cycles as u16)
    }

    fn branch(&mut self, offset: u32, link: bool) {
        let target = self.pc().wrapping_add(offset);
        let (spins, state) = (target == self.address, self.key & 1);
        let Some(cycles) = self.refill_cycles(target) else {
            self.push(leave);
            return;
        };
        let op = self.push(match (link, spins) {
            (true, true) => leave,
            (true, false) => branch_link,
            (false, true) => spin,
            (false, false) => branch,
        });
        op.value = target | state;
        op.through += cycles;
    }

    /// BX r15: on in ARM state behind the instruction, as veneers do.
    fn exchange_here(&mut self) {
        let target = self.pc() & !3;
        let sequence = self.address.wrapping_add(3 * size_of(self.key));
        let region = self.region;
        let cycles = self
            .bus
            .branch_cycles(sequence, target, Width::Word, region);
        match cycles {
            Some(cycles) if target != self.address => {
                let op = self.push(branch);
                op.value = target;
                op.through += cycles as u16;
            }
            _ => {
                self.push(leave);
            }
        }
    }

    fn conditional_branch(&mut self, condition: u32, offset: u32) {
        let target = self.pc().wrapping_add(offset);
        match self.refill_cycles(target) {
            Some(cycles) if target != self.address => {
                let state = self.key & 1;
                let op = self.push(branch_if_handler(condition));
                op.value = target | state;
                op.through += cycles;
                self.join_with_comparison(condition);
            }
            _ => {
                self.push(only_if_handler(condition));
                self.push(leave);
            }
        }
    }

    /// The operation before the branch, if it is a usual comparison, takes the branch as well.
    fn join_with_comparison(&mut self, condition: u32) {
        let Some((operation, kind)) = self.comparison else {
            return;
        };
        let before = self.ops.len().wrapping_sub(2);
        let joined = data_and_branch_handler(operation, kind, condition);
        if let (Some(handler), Some(op)) = (joined, self.ops.get_mut(before)) {
            op.handler = handler;
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
            _ => {
                self.push(leave);
            }
        }
    }

    fn data_processing(&mut self, processing: &DataProcessing, flags: bool) {
        let DataProcessing {
            operation,
            destination,
            first,
            second,
            sets_flags,
        } = *processing;
        if destination == 15 {
            return self.jump(processing);
        }
        if processing.takes_large_frame() {
            self.push(leave);
            return;
        }
        if processing.reads(15) {
            return match self.pc_relative(processing) {
                Some(value) if !sets_flags => self.constant(destination, value),
                _ => {
                    self.push(leave);
                }
            };
        }
        if operation.compares() && !flags {
            let by_register = matches!(second, Operand::ShiftedByRegister { .. });
            if !by_register {
                self.push(nothing);
                return;
            }
        }
        let (kind, value, register, amount, mode) = operand_parts(second);
        let op = self.push(data_handler(operation, kind, flags));
        (op.value, op.second, op.amount, op.mode) = (value, register, amount, mode);
        op.third = Register::number(u32::from(amount));
        op.destination = Register::number(destination);
        op.first = Register::number(first);
    }

    /// Conditional data processing as one operation; false when it needs two.
    fn data_processing_if(
        &mut self,
        processing: &DataProcessing,
        flags: bool,
        condition: u32,
    ) -> bool {
        let (kind, value, register, amount, mode) = operand_parts(processing.second);
        let left = processing.reads(15) || processing.takes_large_frame();
        if flags || left || processing.destination == 15 {
            return false;
        }
        let Some(handler) = data_if_handler(processing.operation, kind) else {
            return false;
        };
        let op = self.push(handler);
        (op.value, op.second, op.amount, op.mode) = (value, register, amount, mode);
        op.third = Register::number(u32::from(amount));
        op.destination = Register::number(processing.destination);
        op.first = Register::number(processing.first);
        op.cycles = condition as u8;
        true
    }

    /// MRS.
    fn read_status(&mut self, destination: u32, saved: bool) {
        let op = self.push(if saved {
            beyond::read_saved_status
        } else {
            beyond::read_status
        });
        op.destination = Register::number(destination);
    }

    /// MSR.
    fn write_status(&mut self, saved: bool, operand: Operand) {
        if operand.reads(15) {
            self.push(leave);
            return;
        }
        let fields = self.bus.code_word(self.address) >> 16 & 15;
        let (next, through) = (self.address.wrapping_add(4), self.through);
        let (_, value, register, ..) = operand_parts(operand);
        let op = self.push(if saved {
            beyond::write_saved_status
        } else {
            beyond::write_status
        });
        (op.value, op.second, op.mode) = (value, register, fields as u8);
        if matches!(operand, Operand::Constant { .. }) {
            op.mode |= beyond::OF_CONSTANT;
        }
        if saved {
            let op = self.push(fall_through);
            (op.value, op.before) = (next, through);
        }
    }

    /// MOVS and SUBS to r15 return from an exception.
    fn return_from_exception(&mut self, processing: &DataProcessing) -> bool {
        let (first, value) = match (processing.operation, processing.second) {
            (AluOperation::Sub, Operand::Constant { value, .. }) => (processing.first, value),
            (
                AluOperation::Mov,
                Operand::Shifted {
                    register,
                    kind: 0,
                    amount: 0,
                },
            ) => (register, 0),
            _ => return false,
        };
        if first == 15 || !processing.sets_flags {
            return false;
        }
        let op = self.push(return_to);
        op.first = Register::number(first);
        op.value = value;
        true
    }

    /// MOV r15, Rm is a branch in the present state; most others are left to the reference
    /// engine.
    fn jump(&mut self, processing: &DataProcessing) {
        if self.return_from_exception(processing) {
            return;
        }
        let plain = match processing.second {
            Operand::Shifted {
                register,
                kind: 0,
                amount: 0,
            } if register != 15 => Some(register),
            _ => None,
        };
        match plain {
            Some(register)
                if processing.operation == AluOperation::Mov && !processing.sets_flags =>
            {
                self.push(jump).second = Register::number(register);
            }
            _ => {
                self.push(leave);
            }
        }
    }

    /// Value of the usual ways to compute an address from r15.
    fn pc_relative(&self, processing: &DataProcessing) -> Option<u32> {
        let pc = self.pc();
        match (processing.operation, processing.first, processing.second) {
            (AluOperation::Add, 15, Operand::Constant { value, .. }) => {
                Some(pc.wrapping_add(value))
            }
            (AluOperation::Sub, 15, Operand::Constant { value, .. }) => {
                Some(pc.wrapping_sub(value))
            }
            (
                AluOperation::Mov,
                _,
                Operand::Shifted {
                    register: 15,
                    kind: 0,
                    amount: 0,
                },
            ) => Some(pc),
            _ => None,
        }
    }

    fn multiply(&mut self, product: &Multiply, flags: bool) {
        if product.uses(15) {
            self.push(leave);
            return;
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

    fn transfer(&mut self, transfer: &Transfer) {
        let pc_moves = transfer.base == 15 && transfer.moves_base();
        let jumps = transfer.register == 15;
        let jumps_oddly = jumps && !(transfer.load && transfer.width == Width::Word);
        if jumps_oddly || pc_moves || transfer.offset.reads(15) {
            self.push(leave);
            return;
        }
        let addressing = self.addressing(transfer);
        let item = match (transfer.width, transfer.signed) {
            (Width::Word, _) => transfer::WORD,
            (Width::Byte, false) => transfer::BYTE,
            (Width::Halfword, false) => transfer::HALFWORD,
            (Width::Byte, true) => transfer::SIGNED_BYTE,
            (Width::Halfword, true) => transfer::SIGNED_HALFWORD,
        };
        let Some((addressing, value, second, amount, mode)) = addressing else {
            self.push(leave);
            return;
        };
        let ram_cycles = self.bus.ram_cycles() as u8;
        let op = self.push(if jumps {
            transfer::jump_handler(addressing)
        } else if transfer.load {
            load_handler(item, addressing)
        } else {
            store_handler(item, addressing)
        });
        (op.value, op.second, op.amount, op.mode) = (value, second, amount, mode);
        op.destination = Register::number(transfer.register);
        op.first = Register::number(transfer.base);
        op.cycles = ram_cycles + u8::from(transfer.load);
    }

    /// Addressing, value, second register, amount and mode of a transfer.
    fn addressing(&self, transfer: &Transfer) -> Option<(u8, u32, Register, u8, u8)> {
        let simple = transfer.before && !transfer.write_back;
        let signed = |value: u32| {
            if transfer.add {
                value
            } else {
                value.wrapping_neg()
            }
        };
        match transfer.offset {
            Operand::Constant { value, .. } if transfer.base == 15 => {
                let at = (self.pc() & !3).wrapping_add(signed(value));
                Some((transfer::FIXED, at, Register::R0, 0, 0))
            }
            Operand::Shifted {
                register,
                kind: 0,
                amount,
            } if transfer.base == 15 && simple && transfer.add => {
                let (pc, register) = (self.pc() & !3, Register::number(register));
                Some((transfer::RELATIVE, pc, register, amount as u8, 0))
            }
            _ if transfer.base == 15 => None,
            Operand::Constant { value, .. } if simple => {
                Some((transfer::OFFSET, signed(value), Register::R0, 0, 0))
            }
            Operand::Shifted {
                register,
                kind: 0,
                amount,
            } if simple && transfer.add => {
                let register = Register::number(register);
                Some((transfer::INDEXED, 0, register, amount as u8, 0))
            }
            Operand::Constant { value, .. } => {
                let mode = mode_of(transfer, 0);
                Some((transfer::GENERAL, value, Register::R0, 0, mode))
            }
            Operand::Shifted {
                register,
                kind,
                amount,
            } => {
                let mode = transfer::BY_REGISTER | (kind as u8) << transfer::SHIFT;
                let mode = mode_of(transfer, mode);
                let register = Register::number(register);
                Some((transfer::GENERAL, 0, register, amount as u8, mode))
            }
            Operand::ShiftedByRegister { .. } => None,
        }
    }

    fn block_transfer(&mut self, block: &BlockTransfer) {
        let stores_pc = !block.load && block.list >> 15 != 0;
        let odd = block.size_bytes != 4 * block.list.count_ones();
        let returns = block.load && block.list >> 15 != 0;
        if block.status && !returns || block.base == 15 || stores_pc || odd {
            self.push(leave);
            return;
        }
        let op = self.push(match (block.load, returns, block.status) {
            (false, ..) => store_block,
            (true, false, _) => load_block::<B, { transfer::GOES_ON }>,
            (true, true, false) => load_block::<B, { transfer::BRANCHES }>,
            (true, true, true) => load_block::<B, { transfer::RETURNS }>,
        });
        op.value = transfer::packed(block);
        op.first = Register::number(block.base);
        op.amount = block.list.count_ones() as u8;
    }
}
