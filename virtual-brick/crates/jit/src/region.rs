// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One function of a region's blocks.

use std::collections::BTreeMap;

use arm7tdmi::instruction::{AluOperation, DataProcessing, Operand, Operation, ALWAYS};
use arm7tdmi::{NativeBlock, NativeInstruction, NativeJump, NativeRegion, BRANCHED};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, Block, BlockCall, InstBuilder, JumpTableData, Value};
use cranelift_frontend::FunctionBuilder;

use crate::alu::is_free;
use crate::block_transfer::is_plain;
use crate::branch::Ways;
use crate::function::{Arguments, Function, Position};
use crate::machine::Machine;
use crate::reach::{reach, Reach};
use crate::table::{AfterStore, Exit};
use crate::transfer::Ram;

/// What the code of all regions has in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Guest address and number of the words of RAM.
    pub address: u32,
    pub words: u32,
    /// Address of the table of places.
    pub table: usize,
}

/// Makes the function.
pub(crate) struct RegionCompiler<'a> {
    function: Function<'a>,
    region: &'a NativeRegion,
    ways: Ways,
    ram: Ram,
    /// What the instruction and those behind it access around its base.
    around: Option<Reach>,
    /// The code of each block, by key.
    blocks: BTreeMap<u32, Block>,
    /// Ways out to other code, by key, with the block that asked first.
    outward: BTreeMap<u32, (Block, NativeJump, u32)>,
}

impl<'a> RegionCompiler<'a> {
    pub fn new(
        mut builder: FunctionBuilder<'a>,
        region: &'a NativeRegion,
        layout: Layout,
        exits: &'a mut Vec<Exit>,
    ) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let signature = builder.import_signature(Machine::signature());
        let parameters = builder.block_params(entry);
        let left = parameters[1];
        let arguments = Arguments {
            state: parameters[0],
            words: parameters[2],
            marks: parameters[3],
        };
        let index = parameters[4];
        let mut compiler = Self {
            function: Function::new(builder, arguments, left, exits),
            region,
            ways: Ways {
                table: layout.table,
                signature,
                reach: region.reach,
            },
            ram: Ram {
                address: layout.address,
                bytes: 4 * layout.words,
                cycles: region.ram_cycles,
            },
            around: None,
            blocks: BTreeMap::new(),
            outward: BTreeMap::new(),
        };
        compiler.enter(left, index);
        compiler
    }

    /// The way to the block that is asked for.
    fn enter(&mut self, left: Value, index: Value) {
        let builder = &mut self.function.builder;
        let mut calls = Vec::new();
        for block in &self.region.blocks {
            let code = builder.create_block();
            builder.append_block_param(code, types::I32);
            self.blocks.insert(block.key, code);
            let pool = &mut builder.func.dfg.value_lists;
            calls.push(BlockCall::new(code, [left.into()], pool));
        }
        let first = calls[0];
        if calls.len() == 1 {
            let code = self.blocks[&self.region.blocks[0].key];
            builder.ins().jump(code, &[left.into()]);
            return;
        }
        let table = builder.create_jump_table(JumpTableData::new(first, &calls));
        builder.ins().br_table(index, table);
    }

    pub fn compile(mut self) {
        let region = self.region;
        for block in &region.blocks {
            self.block(block);
        }
        for (_, (code, jump, block)) in std::mem::take(&mut self.outward) {
            self.leave_to(code, jump, block);
        }
        self.function.finish();
    }

    fn block(&mut self, block: &NativeBlock) {
        let code = self.blocks[&block.key];
        let function = &mut self.function;
        function.builder.switch_to_block(code);
        let left = function.builder.block_params(code)[0];
        function.begin(left);
        function.position = Position {
            block: block.number,
            key: block.key,
            operation: 0,
            address: block.key & !1,
        };
        let worst = function.constant(block.worst_cycles);
        let below = IntCC::UnsignedLessThan;
        let short = function.builder.ins().icmp(below, left, worst);
        function.leave_if(short);
        for (index, instruction) in block.instructions.iter().enumerate() {
            self.around = reach(&block.instructions[index..]);
            self.function.position.operation = instruction.operation;
            self.function.position.address = instruction.address;
            self.instruction(instruction);
            if self.function.ended {
                return;
            }
            if !instruction.instruction.operation.stores() {
                self.function.known.after_store = AfterStore::Not;
            }
        }
        self.fall_through(block);
    }

    /// Behind the last instruction of a block that has no branch there.
    fn fall_through(&mut self, block: &NativeBlock) {
        let through = block
            .instructions
            .last()
            .map_or(0, |last| last.through_cycles);
        let function = &mut self.function;
        let end = function.position.address.wrapping_add(4 >> (block.key & 1));
        match block.next {
            Some(next) if function.known.after_store == AfterStore::Not => {
                self.branch(next, through);
            }
            _ => {
                function.clean();
                let left = function.left_after(through);
                let exit = Exit {
                    block: block.number,
                    operation: BRANCHED,
                    next: end | block.key & 1,
                    pending_cycles: 0,
                    after_store: function.known.after_store,
                };
                function.leave_with(left, exit);
            }
        }
    }

    /// Goes on at a known target.
    fn branch(&mut self, jump: NativeJump, through_cycles: u32) {
        self.function.clean_registers();
        self.function.store_flags();
        let left = self
            .function
            .left_after(through_cycles + jump.refill_cycles);
        let code = self.way_to(jump);
        self.function.builder.ins().jump(code, &[left.into()]);
        self.function.ended = true;
    }

    /// The code that goes on at a known target.
    fn way_to(&mut self, jump: NativeJump) -> Block {
        if let Some(&code) = self.blocks.get(&jump.key) {
            return code;
        }
        if let Some(&(code, ..)) = self.outward.get(&jump.key) {
            return code;
        }
        let code = self.function.builder.create_block();
        self.function.builder.append_block_param(code, types::I32);
        let from = self.function.position.block;
        self.outward.insert(jump.key, (code, jump, from));
        code
    }

    /// On in other code, if there is some, else back to the caller.
    fn leave_to(&mut self, code: Block, jump: NativeJump, from: u32) {
        let ways = self.ways;
        let function = &mut self.function;
        function.builder.switch_to_block(code);
        let left = function.builder.block_params(code)[0];
        let entry = function.entry_at(&ways, jump.halfword);
        let (key, wanted) = (function.entry_key(entry), function.constant(jump.key));
        let none = function.differs(key, wanted);
        let back = function.builder.create_block();
        let on = function.builder.create_block();
        function.builder.ins().brif(none, back, &[], on, &[]);
        function.builder.set_cold_block(back);
        function.builder.switch_to_block(back);
        let exit = Exit {
            block: from,
            operation: BRANCHED,
            next: jump.key,
            pending_cycles: 0,
            after_store: AfterStore::Not,
        };
        function.leave_with(left, exit);
        function.builder.switch_to_block(on);
        function.go_to(&ways, entry, left);
    }

    fn instruction(&mut self, one: &NativeInstruction) {
        let condition = one.instruction.condition;
        if condition > ALWAYS {
            return;
        }
        if condition == ALWAYS {
            return self.always(one);
        }
        match (&one.instruction.operation, one.jump) {
            (Operation::Branch { link: false, .. }, Some(jump)) => {
                self.branch_if(condition, jump, one.through_cycles);
            }
            (Operation::DataProcessing(processing), _)
                if processing.destination != 15
                    && !processing.reads(15)
                    && !processing.takes_large_frame()
                    && is_free(processing, one.flags) =>
            {
                self.function.data_processing_if(processing, condition);
            }
            _ => self.only_if(condition, one),
        }
    }

    /// An instruction under a condition, passed over by a branch.
    fn only_if(&mut self, condition: u32, one: &NativeInstruction) {
        let way = self.function.begin_if(condition);
        self.always(one);
        self.function.end_if(way);
    }

    fn branch_if(&mut self, condition: u32, jump: NativeJump, through_cycles: u32) {
        self.function.clean_registers();
        let holds = self.function.condition(condition);
        let taken = self.function.builder.create_block();
        let on = self.function.builder.create_block();
        let ins = self.function.builder.ins();
        ins.brif(holds, taken, &[], on, &[]);
        self.function.builder.switch_to_block(taken);
        self.branch(jump, through_cycles);
        self.function.builder.switch_to_block(on);
        self.function.ended = false;
    }

    fn always(&mut self, one: &NativeInstruction) {
        let pc = one.address.wrapping_add(2 * one.instruction.size);
        let done = match &one.instruction.operation {
            Operation::DataProcessing(processing) => self.data_processing(processing, one, pc),
            Operation::LoadAddress {
                destination,
                offset,
            } => self.set_constant(*destination, (pc & !3).wrapping_add(*offset)),
            Operation::LongBranchPrefix { offset } => {
                self.set_constant(14, pc.wrapping_add(*offset))
            }
            Operation::Multiply(product) => {
                let plain = !product.uses(15);
                if plain {
                    self.function.multiply(product, one.flags);
                }
                plain
            }
            Operation::Transfer(transfer) if transfer.register == 15 => self.load_jump(one, pc),
            Operation::Transfer(transfer) => {
                let known = (one.literal, self.around);
                self.function.transfer(transfer, pc, known, self.ram)
            }
            Operation::BlockTransfer(block) if is_plain(block) => {
                self.block_transfer(one);
                true
            }
            _ => self.jump(one),
        };
        if !done {
            self.function.leave();
        }
    }

    fn set_constant(&mut self, register: u32, value: u32) -> bool {
        let value = self.function.constant(value);
        self.function.set(register, value);
        true
    }

    fn data_processing(
        &mut self,
        processing: &DataProcessing,
        one: &NativeInstruction,
        pc: u32,
    ) -> bool {
        let plain_move = processing.operation == AluOperation::Mov && !processing.sets_flags;
        match processing.second {
            Operand::Shifted {
                register,
                kind: 0,
                amount: 0,
            } if processing.destination == 15 && plain_move && register != 15 => {
                let value = self.function.get(register);
                let target = self.function.target_here(value);
                let entry = self.function.entry_of(&self.ways, target);
                let through = one.through_cycles;
                self.function.branch_to_entry(&self.ways, entry, through);
                true
            }
            Operand::Shifted {
                register: 15,
                kind: 0,
                amount: 0,
            } if plain_move && processing.destination != 15 => {
                self.set_constant(processing.destination, pc)
            }
            _ if processing.destination == 15
                || processing.reads(15)
                || processing.takes_large_frame() =>
            {
                false
            }
            _ => {
                self.function.data_processing(processing, one.flags);
                true
            }
        }
    }

    /// LDR to r15.
    fn load_jump(&mut self, one: &NativeInstruction, pc: u32) -> bool {
        let Operation::Transfer(transfer) = &one.instruction.operation else {
            return false;
        };
        let word = transfer.width == arm7tdmi::Width::Word;
        if !transfer.load || !word || self.function.position.key & 1 != 0 {
            return false;
        }
        let before = self.function.known.pending;
        let Some(loaded) = self.function.loaded_target(transfer, pc, self.ram) else {
            return false;
        };
        // Until the entry is found, the instruction has not begun.
        let pending = std::mem::replace(&mut self.function.known.pending, before);
        let target = self.function.target_here(loaded.value);
        let entry = self.function.entry_of(&self.ways, target);
        self.function.known.pending = pending;
        if let Some(moved) = loaded.moved {
            self.function.set(transfer.base, moved);
        }
        let through = one.through_cycles;
        self.function.branch_to_entry(&self.ways, entry, through);
        true
    }

    fn block_transfer(&mut self, one: &NativeInstruction) {
        let Operation::BlockTransfer(block) = &one.instruction.operation else {
            return;
        };
        if !block.load {
            return self.function.store_words(block, self.ram);
        }
        let words = self.function.block_words(block, self.ram);
        if block.list >> 15 == 0 {
            return self.function.load_words(block, &words, self.ram);
        }
        let last = self.function.last_word(block, &words);
        let target = self.function.target_here(last);
        let entry = self.function.entry_of(&self.ways, target);
        self.function.load_words(block, &words, self.ram);
        let through = one.through_cycles;
        self.function.branch_to_entry(&self.ways, entry, through);
    }

    /// Other branches; false if it is none that the code makes.
    fn jump(&mut self, one: &NativeInstruction) -> bool {
        let through = one.through_cycles;
        match (&one.instruction.operation, one.jump) {
            (Operation::Branch { link: true, .. }, Some(jump)) => {
                self.set_constant(14, one.address.wrapping_add(4));
                self.branch(jump, through);
            }
            (Operation::LongBranchSuffix { .. }, Some(jump)) => {
                self.set_constant(14, one.address.wrapping_add(2) | 1);
                self.branch(jump, through);
            }
            (Operation::Branch { .. } | Operation::BranchExchange { .. }, Some(jump)) => {
                self.branch(jump, through);
            }
            (Operation::BranchExchange { register }, None) if *register != 15 => {
                // An address with bit 1 without bit 0 has no entry.
                let target = self.function.get(*register);
                let entry = self.function.entry_of(&self.ways, target);
                self.function.branch_to_entry(&self.ways, entry, through);
            }
            _ => return false,
        }
        true
    }
}
