// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The function of a region while it is compiled: where registers, flags and cycles are.

use std::mem::offset_of;

use arm7tdmi::{CodeWindow, GuestState, NO_ADDRESS};
use cranelift_codegen::ir::{
    types, AliasRegion, Block, BlockArg, InstBuilder, MemFlags, SigRef, Value,
};
use cranelift_frontend::{FuncInstBuilder, FunctionBuilder};

use crate::access_range::AccessRange;
use crate::entry_table::{AfterStore, Exit, Exits};
use crate::flags::{Field, Flag, Flags};

/// Offset of the cycles left in the state.
pub(crate) const CYCLES_LEFT_OFFSET: i32 = offset_of!(GuestState, cycles_left) as i32;

const fn offset_of_register(register: u32) -> i32 {
    (offset_of!(GuestState, registers) + 4 * (register as usize & 15)) as i32
}

/// Flags of accesses to the state.
fn of_state() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Vmctx))
}

/// The function's arguments that it needs throughout.
#[derive(Clone, Copy)]
pub(crate) struct Arguments {
    pub state: Value,
    pub words: Value,
    pub marks: Value,
}

/// RAM as the code knows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ram {
    pub address: u32,
    pub bytes: u32,
    pub cycles: u32,
}

/// The table of entries, through which code of other regions is reached.
#[derive(Clone, Copy)]
pub(crate) struct EntryTable {
    pub address: usize,
    /// Signature of the code.
    pub signature: SigRef,
    pub window: CodeWindow,
}

/// The instruction in hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    /// Number of the block, and its key.
    pub block: u32,
    pub key: u32,
    pub operation: u32,
    pub address: u32,
}

/// Bytes around a base that were found to be in RAM.
#[derive(Clone, Copy)]
pub(crate) struct CheckedRange {
    pub base: Value,
    pub range: AccessRange,
    /// Offset of the first in RAM, its address in the host's memory, and the address of its mark if
    /// that is known.
    pub offset: Value,
    pub start: Value,
    pub mark: Option<Value>,
}

/// What is known at this place of the code.
#[derive(Clone, Copy)]
pub(crate) struct Known {
    /// Values of the registers that were read or written.
    pub registers: [Option<Value>; 16],
    /// Registers whose value is not in the state, one bit each.
    pub dirty: u16,
    /// Registers that were written, one bit each.
    written: u16,
    pub flags: Flags,
    /// Cycles left, but for those of fetches in this block and those pending.
    pub left: Value,
    /// Cycles besides fetches that were not yet taken from those left.
    pub pending: u32,
    pub after_store: AfterStore,
    /// The last ranges.
    pub ranges: [Option<CheckedRange>; 4],
}

/// A function while it is compiled.
pub(crate) struct Function<'a> {
    pub builder: FunctionBuilder<'a>,
    pub arguments: Arguments,
    pub table: EntryTable,
    pub ram: Ram,
    pub known: Known,
    pub position: Position,
    /// The code so far ends with a jump.
    pub ended: bool,
    exits: &'a mut Exits,
    /// Returns to the caller, with cycles left and the exit's number.
    exit_block: Block,
    /// Blocks that store flags first and then return.
    flag_exits: Vec<(Flags, Block)>,
}

impl Known {
    /// At the beginning of a block.
    const fn at_start(left: Value) -> Self {
        Self {
            registers: [None; 16],
            dirty: 0,
            written: 0,
            flags: Flags::IN_STATE,
            left,
            pending: 0,
            after_store: AfterStore::No,
            ranges: [None; 4],
        }
    }
}

impl<'a> Function<'a> {
    pub fn new(
        mut builder: FunctionBuilder<'a>,
        arguments: Arguments,
        (table, ram): (EntryTable, Ram),
        left: Value,
        exits: &'a mut Exits,
    ) -> Self {
        let exit_block = new_exit_block(&mut builder);
        Self {
            builder,
            arguments,
            table,
            ram,
            known: Known::at_start(left),
            position: Position {
                block: 0,
                key: 0,
                operation: 0,
                address: 0,
            },
            ended: false,
            exits,
            exit_block,
            flag_exits: Vec::new(),
        }
    }

    /// A block of the region begins, with so many cycles left.
    pub fn begin(&mut self, left: Value) {
        self.ended = false;
        self.known = Known::at_start(left);
    }

    pub fn ins(&mut self) -> FuncInstBuilder<'_, 'a> {
        self.builder.ins()
    }

    pub fn constant(&mut self, value: u32) -> Value {
        self.ins().iconst(types::I32, i64::from(value))
    }

    pub fn load_field(&mut self, field: Field) -> Value {
        let state = self.arguments.state;
        self.ins()
            .load(types::I32, of_state(), state, field.offset())
    }

    fn load_register(&mut self, register: u32) -> Value {
        let (state, offset) = (self.arguments.state, offset_of_register(register));
        self.ins().load(types::I32, of_state(), state, offset)
    }

    /// Value of a register; a loaded one is not kept.
    pub fn peek(&mut self, register: u32) -> Value {
        match self.known.registers[register as usize & 15] {
            Some(value) => value,
            None => self.load_register(register),
        }
    }

    pub fn get(&mut self, register: u32) -> Value {
        let value = self.peek(register);
        self.known.registers[register as usize & 15] = Some(value);
        value
    }

    pub fn set(&mut self, register: u32, value: Value) {
        self.known.registers[register as usize & 15] = Some(value);
        self.known.dirty |= 1 << (register & 15);
        self.known.written |= 1 << (register & 15);
    }

    /// Stores the registers whose value is not in the state.
    pub fn store_registers(&mut self) {
        let state = self.arguments.state;
        for register in 0..16 {
            let value = self.known.registers[register as usize];
            if let (true, Some(value)) = (self.known.dirty >> register & 1 != 0, value) {
                let offset = offset_of_register(register);
                self.ins().store(of_state(), value, state, offset);
            }
        }
        self.known.dirty = 0;
    }

    /// Stores the flags that are not in the state, on one of several paths from here.
    pub fn store_flags(&mut self) {
        let (state, flags) = (self.arguments.state, self.known.flags);
        for field in Field::ALL {
            if flags.dirty >> field as u8 & 1 != 0 {
                let (value, offset) = (self.flag(field), field.offset());
                self.ins().store(of_state(), value, state, offset);
            }
        }
    }

    /// Stores registers and flags.
    pub fn store_all(&mut self) {
        self.store_registers();
        self.store_flags();
        self.known.flags.dirty = 0;
    }

    pub fn store_after_store(&mut self, address: u32) {
        let (state, value) = (self.arguments.state, self.constant(address));
        let offset = offset_of!(GuestState, after_store) as i32;
        self.ins().store(of_state(), value, state, offset);
    }

    /// So many cycles less are left, from here on.
    pub fn pass(&mut self, cycles: Value) {
        let left = self.known.left;
        self.known.left = self.ins().isub(left, cycles);
    }

    /// What is left after the pending cycles and some more.
    pub fn left_after(&mut self, more_cycles: u32) -> Value {
        let cycles = self.known.pending + more_cycles;
        if cycles == 0 {
            return self.known.left;
        }
        let (left, cycles) = (self.known.left, self.constant(cycles));
        self.ins().isub(left, cycles)
    }

    /// Returns to the caller with cycles left, from which the exit's are still to be taken.
    pub fn exit_with(&mut self, left: Value, exit: Exit) {
        self.exit_through(self.exit_block, left, exit);
    }

    fn exit_through(&mut self, block: Block, left: Value, exit: Exit) {
        let number = self.exits.add(exit);
        let number = self.constant(number);
        self.ins().jump(block, &[left.into(), number.into()]);
        self.ended = true;
    }

    /// The block that stores the flags as they are known here and returns.
    fn exit_block_for_flags(&mut self) -> Block {
        let flags = self.known.flags;
        if flags.dirty == 0 {
            return self.exit_block;
        }
        if let Some(known) = self.flag_exits.iter().find(|known| known.0 == flags) {
            return known.1;
        }
        let block = new_exit_block(&mut self.builder);
        self.flag_exits.push((flags, block));
        block
    }

    /// Completes the function with the blocks that return.
    pub fn finish(mut self) {
        let exit_block = self.exit_block;
        for (flags, block) in std::mem::take(&mut self.flag_exits) {
            self.builder.switch_to_block(block);
            self.known.flags = flags;
            self.store_flags();
            let results = self.builder.block_params(block);
            let results: Vec<BlockArg> = results.iter().map(|&result| result.into()).collect();
            self.ins().jump(exit_block, &results);
        }
        self.builder.switch_to_block(exit_block);
        let results = self.builder.block_params(exit_block).to_vec();
        self.ins().return_(&results);
        self.builder.seal_all_blocks();
        self.builder.finalize();
    }

    /// Takes a side exit in front of the instruction; the registers are stored.
    fn exit_here(&mut self) {
        let block = self.exit_block_for_flags();
        let exit = Exit {
            block: self.position.block,
            operation: self.position.operation,
            next: self.position.key,
            pending_cycles: self.known.pending,
            after_store: self.known.after_store,
        };
        self.exit_through(block, self.known.left, exit);
    }

    /// Takes a side exit in front of the instruction.
    pub fn exit(&mut self) {
        self.store_registers();
        self.exit_here();
    }

    /// Takes a side exit in front of the instruction if a value is not zero.
    pub fn exit_if(&mut self, condition: Value) {
        self.store_registers();
        let exit = self.builder.create_block();
        let next = self.builder.create_block();
        self.ins().brif(condition, exit, &[], next, &[]);
        self.builder.set_cold_block(exit);
        self.builder.switch_to_block(exit);
        self.exit_here();
        self.builder.switch_to_block(next);
        self.ended = false;
    }

    /// The code up to [`Function::end_if`] runs only if the condition holds.
    pub fn begin_if(&mut self, condition: u32) -> Skipped {
        let holds = self.condition(condition);
        let then = self.builder.create_block();
        let skip = self.builder.create_block();
        self.ins().brif(holds, then, &[], skip, &[]);
        self.builder.switch_to_block(then);
        let known = self.known;
        self.known.written = 0;
        Skipped { skip, known }
    }

    /// The code from here on runs in any case.
    pub fn end_if(&mut self, skipped: Skipped) {
        let Skipped { skip, known } = skipped;
        if self.ended {
            self.builder.switch_to_block(skip);
            self.known = known;
            self.ended = false;
            return;
        }
        let changes = self.changes_since(&known);
        let stored = self.known.after_store != known.after_store;
        if let (true, AfterStore::At(address)) = (stored, self.known.after_store) {
            self.store_after_store(address);
        }
        let join = self.builder.create_block();
        let arguments = self.values(&changes);
        self.ins().jump(join, &arguments);
        let (dirty, flags_dirty) = (self.known.dirty, self.known.flags.dirty);
        let written = self.known.written;
        self.known = known;
        self.builder.switch_to_block(skip);
        if stored {
            self.store_after_store(NO_ADDRESS);
        }
        let arguments = self.values(&changes);
        self.ins().jump(join, &arguments);
        self.builder.switch_to_block(join);
        self.take(&changes, join);
        self.known.dirty |= dirty;
        self.known.flags.dirty |= flags_dirty;
        self.known.written |= written;
        if stored {
            self.known.after_store = AfterStore::InState;
        }
    }

    fn changes_since(&self, before: &Known) -> Changes {
        let now = &self.known;
        let registers = (0..16).filter(|&number: &u32| {
            let index = number as usize;
            now.written >> number & 1 != 0 && now.registers[index] != before.registers[index]
        });
        let fields = Field::ALL
            .into_iter()
            .filter(|&field| now.flags.get(field) != before.flags.get(field));
        Changes {
            registers: registers.collect(),
            fields: fields.collect(),
            left: now.left != before.left || now.pending != before.pending,
        }
    }

    /// The values here of what changes.
    fn values(&mut self, changes: &Changes) -> Vec<BlockArg> {
        let mut values = Vec::new();
        for &register in &changes.registers {
            values.push(self.peek(register).into());
        }
        for &field in &changes.fields {
            values.push(self.flag(field).into());
        }
        if changes.left {
            values.push(self.left_after(0).into());
        }
        values
    }

    /// A value that changed on one of two paths is a parameter of the block where they meet.
    fn take(&mut self, changes: &Changes, join: Block) {
        for &register in &changes.registers {
            let value = self.builder.append_block_param(join, types::I32);
            self.known.registers[register as usize & 15] = Some(value);
        }
        for &field in &changes.fields {
            let value = self.builder.append_block_param(join, types::I32);
            self.known.flags.set(field, Flag::Value(value));
        }
        if changes.left {
            self.known.left = self.builder.append_block_param(join, types::I32);
            self.known.pending = 0;
        }
    }
}

/// A block that receives the cycles left and the number of an exit.
fn new_exit_block(builder: &mut FunctionBuilder<'_>) -> Block {
    let block = builder.create_block();
    builder.append_block_param(block, types::I32);
    builder.append_block_param(block, types::I32);
    builder.set_cold_block(block);
    block
}

/// What is known where a conditional instruction is skipped.
pub(crate) struct Skipped {
    skip: Block,
    known: Known,
}

/// What a conditional instruction changes.
struct Changes {
    registers: Vec<u32>,
    fields: Vec<Field>,
    left: bool,
}
