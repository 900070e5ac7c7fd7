// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Indirect branches: through the table of entries.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, AliasRegion, InstBuilder, MemFlags, Value};

use crate::entry_table::{Entry, CODE, INDEX, KEY, REFILL_CYCLES};
use crate::function::Function;

/// Flags of accesses to the table.
fn of_table() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Table))
}

const ENTRY_SHIFT: u32 = size_of::<Entry>().trailing_zeros();

impl Function<'_> {
    /// Address of an entry of the table.
    pub fn entry_at(&mut self, halfword: u32) -> Value {
        let address = self.table.address + ((halfword as usize) << ENTRY_SHIFT);
        self.ins().iconst(types::I64, address as i64)
    }

    pub fn entry_key(&mut self, entry: Value) -> Value {
        self.ins().load(types::I32, of_table(), entry, KEY)
    }

    /// Jumps to the code at an entry.
    pub fn jump_to_entry(&mut self, entry: Value, left: Value) {
        let index = self.ins().uload16(types::I32, of_table(), entry, INDEX);
        let code = self.ins().load(types::I64, of_table(), entry, CODE);
        let arguments = self.arguments;
        let values = [
            arguments.state,
            left,
            arguments.words,
            arguments.marks,
            index,
        ];
        let signature = self.table.signature;
        self.ins().return_call_indirect(signature, code, &values);
        self.ended = true;
    }

    /// The entry of a target, whose bit 0 tells Thumb state. Takes a side exit if there is none, or
    /// if the target is the branch itself or where its fetches continue.
    pub fn entry_of(&mut self, target: Value) -> Value {
        let shifted = self.ins().ishl_imm(target, i64::from(ENTRY_SHIFT - 1));
        let mask = i64::from(self.table.window.mask << ENTRY_SHIFT);
        let offset = self.ins().band_imm(shifted, mask);
        let first = self.entry_at(self.table.window.first_halfword);
        let entry = self.behind(first, offset);
        let key = self.entry_key(entry);
        let other = self.differs(key, target);
        self.exit_if(other);
        let state = self.position.key & 1;
        let own = self.constant(self.position.address | state);
        let itself = self.ins().icmp(IntCC::Equal, target, own);
        self.exit_if(itself);
        if self.table.window.sequence_differs {
            let size = 4 >> state;
            let sequence = self.constant(self.position.address.wrapping_add(3 * size));
            let address = self.ins().band_imm(target, !1 & 0xFFFF_FFFF);
            let is_sequential = self.ins().icmp(IntCC::Equal, address, sequence);
            self.exit_if(is_sequential);
        }
        entry
    }

    /// Ends the block with a branch to an entry; `through_cycles` are those of all its fetches.
    pub fn branch_to_entry(&mut self, entry: Value, through_cycles: u32) {
        self.store_all();
        let left = self.left_after(through_cycles);
        let refill = self
            .ins()
            .uload16(types::I32, of_table(), entry, REFILL_CYCLES);
        let left = self.ins().isub(left, refill);
        self.jump_to_entry(entry, left);
    }

    /// A word as the target of a branch that stays in the state.
    pub fn target_here(&mut self, value: Value) -> Value {
        if self.position.key & 1 == 0 {
            self.ins().band_imm(value, 0xFFFF_FFFC)
        } else {
            self.ins().bor_imm(value, 1)
        }
    }
}
