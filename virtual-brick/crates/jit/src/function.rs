// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The function of a region while it is made: where registers, flags and cycles are.

use std::mem::offset_of;

use arm7tdmi::{NativeState, NOWHERE};
use cranelift_codegen::ir::{types, AliasRegion, Block, BlockArg, InstBuilder, MemFlags, Value};
use cranelift_frontend::FunctionBuilder;

use crate::flags::Flags;
use crate::reach::Reach;
use crate::table::{AfterStore, Exit};

/// A flag's place in the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    Negative,
    Zero,
    Carry,
    Overflow,
}

impl Field {
    const fn offset(self) -> i32 {
        let offset = match self {
            Self::Negative => offset_of!(NativeState, negative),
            Self::Zero => offset_of!(NativeState, zero),
            Self::Carry => offset_of!(NativeState, carry),
            Self::Overflow => offset_of!(NativeState, overflow),
        };
        offset as i32
    }
}

/// Offset of the cycles left in the state.
pub(crate) const fn offset_of_left() -> i32 {
    offset_of!(NativeState, left) as i32
}

const fn offset_of_register(register: u32) -> i32 {
    (offset_of!(NativeState, registers) + 4 * (register as usize & 15)) as i32
}

/// Accesses to the state.
fn of_state() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Vmctx))
}

/// What the whole function has from its beginning.
#[derive(Clone, Copy)]
pub(crate) struct Arguments {
    pub state: Value,
    pub words: Value,
    pub marks: Value,
}

/// The instruction that is made into code.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    /// Number of the block, and its key.
    pub block: u32,
    pub key: u32,
    pub operation: u32,
    pub address: u32,
}

/// Bytes around a base that are in RAM.
#[derive(Clone, Copy)]
pub(crate) struct Checked {
    pub base: Value,
    pub reach: Reach,
    /// Offset of the first in RAM, its address in the host's memory, and that of its mark if it was
    /// asked for.
    pub offset: Value,
    pub start: Value,
    pub mark: Option<Value>,
}

/// What is known where code is made.
#[derive(Clone, Copy)]
pub(crate) struct Known {
    /// Values of the registers that were read or written.
    pub registers: [Option<Value>; 16],
    /// Registers that the state does not have.
    pub dirty: u16,
    /// Registers that were written.
    written: u16,
    pub flags: Flags,
    /// Cycles left, but for those of fetches in this block and those pending.
    pub left: Value,
    /// Cycles besides fetches that were not yet taken from those left.
    pub pending: u32,
    pub after_store: AfterStore,
    /// The last ones.
    pub checked: [Option<Checked>; 4],
}

/// A function while it is made.
pub(crate) struct Function<'a> {
    pub builder: FunctionBuilder<'a>,
    pub arguments: Arguments,
    pub known: Known,
    pub position: Position,
    /// Nothing comes behind what was made.
    pub ended: bool,
    exits: &'a mut Vec<Exit>,
    /// Returns to the caller, with cycles left and the exit's number.
    back: Block,
    /// Ways there that store flags first.
    through: Vec<(Flags, Block)>,
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
            after_store: AfterStore::Not,
            checked: [None; 4],
        }
    }
}

impl<'a> Function<'a> {
    pub fn new(
        mut builder: FunctionBuilder<'a>,
        arguments: Arguments,
        left: Value,
        exits: &'a mut Vec<Exit>,
    ) -> Self {
        let back = way_back(&mut builder);
        Self {
            builder,
            arguments,
            known: Known::at_start(left),
            position: Position {
                block: 0,
                key: 0,
                operation: 0,
                address: 0,
            },
            ended: false,
            exits,
            back,
            through: Vec::new(),
        }
    }

    /// A block of the region begins, with so many cycles left.
    pub fn begin(&mut self, left: Value) {
        self.ended = false;
        self.known = Known::at_start(left);
    }

    pub fn constant(&mut self, value: u32) -> Value {
        self.builder.ins().iconst(types::I32, i64::from(value))
    }

    pub fn load_field(&mut self, field: Field) -> Value {
        let state = self.arguments.state;
        self.builder
            .ins()
            .load(types::I32, of_state(), state, field.offset())
    }

    fn load_register(&mut self, register: u32) -> Value {
        let (state, offset) = (self.arguments.state, offset_of_register(register));
        self.builder
            .ins()
            .load(types::I32, of_state(), state, offset)
    }

    /// Value of a register without taking note of it.
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

    /// The state has all registers.
    pub fn clean_registers(&mut self) {
        let state = self.arguments.state;
        for register in 0..16 {
            let value = self.known.registers[register as usize];
            if let (true, Some(value)) = (self.known.dirty >> register & 1 != 0, value) {
                let offset = offset_of_register(register);
                self.builder.ins().store(of_state(), value, state, offset);
            }
        }
        self.known.dirty = 0;
    }

    /// Stores the flags that the state does not have, on one of several ways on from here.
    pub fn store_flags(&mut self) {
        let (state, flags) = (self.arguments.state, self.known.flags);
        for (field, flag) in flags.each() {
            if flags.dirty >> field as u8 & 1 != 0 {
                let value = self.flag(field, flag);
                let offset = field.offset();
                self.builder.ins().store(of_state(), value, state, offset);
            }
        }
    }

    /// The state is up to date.
    pub fn clean(&mut self) {
        self.clean_registers();
        self.store_flags();
        self.known.flags.dirty = 0;
    }

    pub fn tell_after_store(&mut self, address: u32) {
        let (state, value) = (self.arguments.state, self.constant(address));
        let offset = offset_of!(NativeState, after_store) as i32;
        self.builder.ins().store(of_state(), value, state, offset);
    }

    /// So many cycles less are left, from here on.
    pub fn pass(&mut self, cycles: Value) {
        self.known.left = self.builder.ins().isub(self.known.left, cycles);
    }

    /// What is left after the pending cycles and some more.
    pub fn left_after(&mut self, more_cycles: u32) -> Value {
        let cycles = self.known.pending + more_cycles;
        if cycles == 0 {
            return self.known.left;
        }
        let cycles = self.constant(cycles);
        self.builder.ins().isub(self.known.left, cycles)
    }

    /// Returns to the caller with cycles left, from which the exit's are still to be taken.
    pub fn leave_with(&mut self, left: Value, exit: Exit) {
        self.leave_through(self.back, left, exit);
    }

    fn leave_through(&mut self, way: Block, left: Value, exit: Exit) {
        let number = self.exits.len() as u32;
        self.exits.push(exit);
        let number = self.constant(number);
        self.builder.ins().jump(way, &[left.into(), number.into()]);
        self.ended = true;
    }

    /// The way back to the caller that stores the flags as they are known here.
    fn back_through(&mut self) -> Block {
        let flags = self.known.flags;
        if flags.dirty == 0 {
            return self.back;
        }
        if let Some(known) = self.through.iter().find(|known| known.0 == flags) {
            return known.1;
        }
        let way = way_back(&mut self.builder);
        self.through.push((flags, way));
        way
    }

    /// The ways back to the caller.
    pub fn finish(mut self) {
        let back = self.back;
        for (flags, way) in std::mem::take(&mut self.through) {
            self.builder.switch_to_block(way);
            self.known.flags = flags;
            self.store_flags();
            let results = self.builder.block_params(way);
            let results: Vec<BlockArg> = results.iter().map(|&result| result.into()).collect();
            self.builder.ins().jump(back, &results);
        }
        self.builder.switch_to_block(back);
        let results = self.builder.block_params(back).to_vec();
        self.builder.ins().return_(&results);
        self.builder.seal_all_blocks();
        self.builder.finalize();
    }

    /// Leaves the code before the instruction. The state has all registers.
    fn leave_here(&mut self) {
        let way = self.back_through();
        let exit = Exit {
            block: self.position.block,
            operation: self.position.operation,
            next: self.position.key,
            pending_cycles: self.known.pending,
            after_store: self.known.after_store,
        };
        self.leave_through(way, self.known.left, exit);
    }

    /// Leaves the code before the instruction.
    pub fn leave(&mut self) {
        self.clean_registers();
        self.leave_here();
    }

    /// Leaves the code before the instruction if a value is not zero.
    pub fn leave_if(&mut self, condition: Value) {
        self.clean_registers();
        let leave = self.builder.create_block();
        let on = self.builder.create_block();
        self.builder.ins().brif(condition, leave, &[], on, &[]);
        self.builder.set_cold_block(leave);
        self.builder.switch_to_block(leave);
        self.leave_here();
        self.builder.switch_to_block(on);
        self.ended = false;
    }

    /// What comes next runs only if the condition holds.
    pub fn begin_if(&mut self, condition: u32) -> Passed {
        let holds = self.condition(condition);
        let then = self.builder.create_block();
        let skip = self.builder.create_block();
        self.builder.ins().brif(holds, then, &[], skip, &[]);
        self.builder.switch_to_block(then);
        let known = self.known;
        self.known.written = 0;
        Passed { skip, known }
    }

    /// What comes next runs in any case.
    pub fn end_if(&mut self, passed: Passed) {
        let Passed { skip, known } = passed;
        if self.ended {
            self.builder.switch_to_block(skip);
            self.known = known;
            self.ended = false;
            return;
        }
        let changes = self.changes_since(&known);
        let stored = self.known.after_store != known.after_store;
        if let (true, AfterStore::At(address)) = (stored, self.known.after_store) {
            self.tell_after_store(address);
        }
        let join = self.builder.create_block();
        let arguments = self.values(&changes);
        self.builder.ins().jump(join, &arguments);
        let (dirty, flags_dirty) = (self.known.dirty, self.known.flags.dirty);
        let written = self.known.written;
        self.known = known;
        self.builder.switch_to_block(skip);
        if stored {
            self.tell_after_store(NOWHERE);
        }
        let arguments = self.values(&changes);
        self.builder.ins().jump(join, &arguments);
        self.builder.switch_to_block(join);
        self.take(&changes, join);
        self.known.dirty |= dirty;
        self.known.flags.dirty |= flags_dirty;
        self.known.written |= written;
        if stored {
            self.known.after_store = AfterStore::Told;
        }
    }

    fn changes_since(&self, before: &Known) -> Changes {
        let now = &self.known;
        let registers = (0..16).filter(|&number: &u32| {
            let index = number as usize;
            now.written >> number & 1 != 0 && now.registers[index] != before.registers[index]
        });
        let flags = now.flags.each().into_iter().zip(before.flags.each());
        Changes {
            registers: registers.collect(),
            fields: flags
                .filter(|(now, before)| now.1 != before.1)
                .map(|(now, _)| now.0)
                .collect(),
            left: now.left != before.left || now.pending != before.pending,
        }
    }

    /// Values of what changes, as they are here.
    fn values(&mut self, changes: &Changes) -> Vec<BlockArg> {
        let mut values = Vec::new();
        for &register in &changes.registers {
            values.push(self.peek(register).into());
        }
        for &field in &changes.fields {
            let flag = self.known.flags.get(field);
            values.push(self.flag(field, flag).into());
        }
        if changes.left {
            values.push(self.left_after(0).into());
        }
        values
    }

    /// What changed on one of two ways is a parameter of the block where they meet.
    fn take(&mut self, changes: &Changes, join: Block) {
        for &register in &changes.registers {
            let value = self.builder.append_block_param(join, types::I32);
            self.known.registers[register as usize & 15] = Some(value);
        }
        for &field in &changes.fields {
            let value = self.builder.append_block_param(join, types::I32);
            self.known
                .flags
                .set(field, crate::flags::Flag::Value(value));
        }
        if changes.left {
            self.known.left = self.builder.append_block_param(join, types::I32);
            self.known.pending = 0;
        }
    }
}

/// Takes cycles left and the number of an exit.
fn way_back(builder: &mut FunctionBuilder<'_>) -> Block {
    let block = builder.create_block();
    builder.append_block_param(block, types::I32);
    builder.append_block_param(block, types::I32);
    builder.set_cold_block(block);
    block
}

/// What is known where an instruction under a condition is passed over.
pub(crate) struct Passed {
    skip: Block,
    known: Known,
}

/// What an instruction under a condition changes.
struct Changes {
    registers: Vec<u32>,
    fields: Vec<Field>,
    left: bool,
}
