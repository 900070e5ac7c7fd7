// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Compiles the blocks of a region to one function.

use std::collections::BTreeMap;

use arm7tdmi::instruction::{AluOperation, DataProcessing, Operation, ALWAYS};
use arm7tdmi::{KnownTarget, Region, RegionBlock, RegionInstruction, EXIT_BY_BRANCH};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, Block, BlockCall, InstBuilder, JumpTableData, Value};
use cranelift_frontend::FunctionBuilder;

use crate::access_range::{range_around_base, AccessRange};
use crate::alu::is_pure;
use crate::block_transfer::is_supported;
use crate::entry_table::{AfterStore, Exit, Exits};
use crate::function::{Arguments, EntryTable, Function, Position, Ram};
use crate::host_code::region_signature;

/// Addresses that the code of all regions knows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Guest address and number of the words of RAM.
    pub ram_address: u32,
    pub ram_words: u32,
    /// Address of the table of entries.
    pub table_address: usize,
}

/// Compiles a region.
pub(crate) struct RegionCompiler<'a> {
    function: Function<'a>,
    region: &'a Region,
    /// The range that the instruction in hand and those behind it access around its base.
    around: Option<AccessRange>,
    /// The code of each block, by key.
    blocks: BTreeMap<u32, Block>,
    /// Branches to other regions, by key of the target, with the block that has the first.
    outgoing: BTreeMap<u32, (Block, KnownTarget, u32)>,
}

impl<'a> RegionCompiler<'a> {
    pub fn new(
        mut builder: FunctionBuilder<'a>,
        region: &'a Region,
        layout: Layout,
        exits: &'a mut Exits,
    ) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let signature = builder.import_signature(region_signature());
        let parameters = builder.block_params(entry);
        let left = parameters[1];
        let arguments = Arguments {
            state: parameters[0],
            words: parameters[2],
            marks: parameters[3],
        };
        let index = parameters[4];
        let table = EntryTable {
            address: layout.table_address,
            signature,
            window: region.window,
        };
        let ram = Ram {
            address: layout.ram_address,
            bytes: 4 * layout.ram_words,
            cycles: region.ram_cycles,
        };
        let mut compiler = Self {
            function: Function::new(builder, arguments, (table, ram), left, exits),
            region,
            around: None,
            blocks: BTreeMap::new(),
            outgoing: BTreeMap::new(),
        };
        compiler.compile_dispatch(left, index);
        compiler
    }

    /// Jumps to the block with this index.
    fn compile_dispatch(&mut self, left: Value, index: Value) {
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
        for (_, (code, jump, block)) in std::mem::take(&mut self.outgoing) {
            self.compile_outgoing(code, jump, block);
        }
        self.function.finish();
    }

    fn block(&mut self, block: &RegionBlock) {
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
        let short = function.ins().icmp(below, left, worst);
        function.exit_if(short);
        for (index, instruction) in block.instructions.iter().enumerate() {
            self.around = range_around_base(&block.instructions[index..]);
            self.function.position.operation = instruction.operation;
            self.function.position.address = instruction.address;
            self.instruction(instruction);
            if self.function.ended {
                return;
            }
            if !instruction.instruction.operation.stores() {
                self.function.known.after_store = AfterStore::No;
            }
        }
        self.fall_through(block);
    }

    /// The end of a block without a branch.
    fn fall_through(&mut self, block: &RegionBlock) {
        let through = block
            .instructions
            .last()
            .map_or(0, |last| last.through_cycles);
        let function = &mut self.function;
        let end = function.position.address.wrapping_add(4 >> (block.key & 1));
        match block.next {
            Some(next) if function.known.after_store == AfterStore::No => {
                self.branch(next, through);
            }
            _ => {
                function.store_all();
                let left = function.left_after(through);
                let exit = Exit {
                    block: block.number,
                    operation: EXIT_BY_BRANCH,
                    next: end | block.key & 1,
                    pending_cycles: 0,
                    after_store: function.known.after_store,
                };
                function.exit_with(left, exit);
            }
        }
    }

    /// A branch to a known target.
    fn branch(&mut self, jump: KnownTarget, through_cycles: u32) {
        self.function.store_registers();
        self.function.store_flags();
        let left = self
            .function
            .left_after(through_cycles + jump.refill_cycles);
        let code = self.code_at(jump);
        self.function.ins().jump(code, &[left.into()]);
        self.function.ended = true;
    }

    /// The code that continues at a known target.
    fn code_at(&mut self, jump: KnownTarget) -> Block {
        if let Some(&code) = self.blocks.get(&jump.key) {
            return code;
        }
        if let Some(&(code, ..)) = self.outgoing.get(&jump.key) {
            return code;
        }
        let code = self.function.builder.create_block();
        self.function.builder.append_block_param(code, types::I32);
        let from = self.function.position.block;
        self.outgoing.insert(jump.key, (code, jump, from));
        code
    }

    /// Jumps to the code of another region, if there is some, or else returns.
    fn compile_outgoing(&mut self, code: Block, jump: KnownTarget, from: u32) {
        let function = &mut self.function;
        function.builder.switch_to_block(code);
        let left = function.builder.block_params(code)[0];
        let entry = function.entry_at(jump.halfword);
        let (key, wanted) = (function.entry_key(entry), function.constant(jump.key));
        let absent = function.differs(key, wanted);
        let exit_block = function.builder.create_block();
        let jump_block = function.builder.create_block();
        function
            .ins()
            .brif(absent, exit_block, &[], jump_block, &[]);
        function.builder.set_cold_block(exit_block);
        function.builder.switch_to_block(exit_block);
        let exit = Exit {
            block: from,
            operation: EXIT_BY_BRANCH,
            next: jump.key,
            pending_cycles: 0,
            after_store: AfterStore::No,
        };
        function.exit_with(left, exit);
        function.builder.switch_to_block(jump_block);
        function.jump_to_entry(entry, left);
    }

    fn instruction(&mut self, one: &RegionInstruction) {
        let condition = one.instruction.condition;
        if condition > ALWAYS {
            return;
        }
        if condition == ALWAYS {
            return self.unconditional(one);
        }
        match (&one.instruction.operation, one.target) {
            (Operation::Branch { link: false, .. }, Some(jump)) => {
                self.branch_if(condition, jump, one.through_cycles);
            }
            (Operation::DataProcessing(processing), _)
                if processing.destination != 15
                    && !processing.reads(15)
                    && !processing.takes_large_frame()
                    && is_pure(processing, one.flags) =>
            {
                self.function.data_processing_if(processing, condition);
            }
            _ => self.skip_unless(condition, one),
        }
    }

    /// A conditional instruction, skipped by a branch.
    fn skip_unless(&mut self, condition: u32, one: &RegionInstruction) {
        let skipped = self.function.begin_if(condition);
        self.unconditional(one);
        self.function.end_if(skipped);
    }

    fn branch_if(&mut self, condition: u32, jump: KnownTarget, through_cycles: u32) {
        self.function.store_registers();
        let holds = self.function.condition(condition);
        let taken = self.function.builder.create_block();
        let on = self.function.builder.create_block();
        let ins = self.function.ins();
        ins.brif(holds, taken, &[], on, &[]);
        self.function.builder.switch_to_block(taken);
        self.branch(jump, through_cycles);
        self.function.builder.switch_to_block(on);
        self.function.ended = false;
    }

    fn unconditional(&mut self, one: &RegionInstruction) {
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
                self.function.transfer(transfer, pc, known)
            }
            Operation::BlockTransfer(block) if is_supported(block) => {
                self.block_transfer(one);
                true
            }
            _ => self.jump(one),
        };
        if !done {
            self.function.exit();
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
        one: &RegionInstruction,
        pc: u32,
    ) -> bool {
        let to_pc = processing.destination == 15;
        if processing.operation == AluOperation::Mov && !processing.sets_flags {
            match processing.second.plain_register() {
                Some(15) if !to_pc => return self.set_constant(processing.destination, pc),
                Some(register) if to_pc && register != 15 => {
                    let value = self.function.get(register);
                    let target = self.function.target_here(value);
                    let entry = self.function.entry_of(target);
                    self.function.branch_to_entry(entry, one.through_cycles);
                    return true;
                }
                _ => {}
            }
        }
        let supported = !to_pc && !processing.reads(15) && !processing.takes_large_frame();
        if supported {
            self.function.data_processing(processing, one.flags);
        }
        supported
    }

    /// LDR to r15.
    fn load_jump(&mut self, one: &RegionInstruction, pc: u32) -> bool {
        let Operation::Transfer(transfer) = &one.instruction.operation else {
            return false;
        };
        let word = transfer.width == arm7tdmi::Width::Word;
        if !transfer.load || !word || self.function.position.key & 1 != 0 {
            return false;
        }
        let before = self.function.known.pending;
        let Some(loaded) = self.function.loaded_target(transfer, pc) else {
            return false;
        };
        // Until the entry is found, the instruction has not begun.
        let pending = std::mem::replace(&mut self.function.known.pending, before);
        let target = self.function.target_here(loaded.value);
        let entry = self.function.entry_of(target);
        self.function.known.pending = pending;
        if let Some(moved) = loaded.moved {
            self.function.set(transfer.base, moved);
        }
        let through = one.through_cycles;
        self.function.branch_to_entry(entry, through);
        true
    }

    fn block_transfer(&mut self, one: &RegionInstruction) {
        let Operation::BlockTransfer(block) = &one.instruction.operation else {
            return;
        };
        if !block.load {
            return self.function.store_words(block);
        }
        let words = self.function.block_words(block);
        if block.list >> 15 == 0 {
            return self.function.load_words(block, &words);
        }
        let last = self.function.last_word(block, &words);
        let target = self.function.target_here(last);
        let entry = self.function.entry_of(target);
        self.function.load_words(block, &words);
        let through = one.through_cycles;
        self.function.branch_to_entry(entry, through);
    }

    /// Other branches; false if the code cannot make it.
    fn jump(&mut self, one: &RegionInstruction) -> bool {
        let through = one.through_cycles;
        match (&one.instruction.operation, one.target) {
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
                let entry = self.function.entry_of(target);
                self.function.branch_to_entry(entry, through);
            }
            _ => return false,
        }
        true
    }
}
