// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Branches to targets that are known only at run time: through the table of places.

use arm7tdmi::NativeReach;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, AliasRegion, InstBuilder, MemFlags, SigRef, Value};

use crate::function::Function;
use crate::table::{Entry, CODE, INDEX, KEY, REFILL_CYCLES};

/// Accesses to the table.
fn of_table() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Table))
}

/// How code of other regions is reached.
#[derive(Clone, Copy)]
pub(crate) struct Ways {
    /// Address of the table.
    pub table: usize,
    /// What other code is called with.
    pub signature: SigRef,
    pub reach: NativeReach,
}

const ENTRY_SHIFT: u32 = size_of::<Entry>().trailing_zeros();

impl Function<'_> {
    /// Address of an entry of the table.
    pub fn entry_at(&mut self, ways: &Ways, halfword: u32) -> Value {
        let address = ways.table + ((halfword as usize) << ENTRY_SHIFT);
        self.builder.ins().iconst(types::I64, address as i64)
    }

    pub fn entry_key(&mut self, entry: Value) -> Value {
        self.builder.ins().load(types::I32, of_table(), entry, KEY)
    }

    /// Goes on in other code.
    pub fn go_to(&mut self, ways: &Ways, entry: Value, left: Value) {
        let index = self
            .builder
            .ins()
            .uload16(types::I32, of_table(), entry, INDEX);
        let code = self.builder.ins().load(types::I64, of_table(), entry, CODE);
        let arguments = self.arguments;
        let values = [
            arguments.state,
            left,
            arguments.words,
            arguments.marks,
            index,
        ];
        self.builder
            .ins()
            .return_call_indirect(ways.signature, code, &values);
        self.ended = true;
    }

    /// The entry of a target, whose bit 0 tells Thumb state; leaves the code if it has none, or is
    /// the branch itself, or is where the fetches go on.
    pub fn entry_of(&mut self, ways: &Ways, target: Value) -> Value {
        let shifted = self
            .builder
            .ins()
            .ishl_imm(target, i64::from(ENTRY_SHIFT - 1));
        let offset = self
            .builder
            .ins()
            .band_imm(shifted, i64::from(ways.reach.mask << ENTRY_SHIFT));
        let first = self.entry_at(ways, ways.reach.first_halfword);
        let entry = self.behind(first, offset);
        let key = self.entry_key(entry);
        let other = self.differs(key, target);
        self.leave_if(other);
        let state = self.position.key & 1;
        let own = self.constant(self.position.address | state);
        let itself = self.builder.ins().icmp(IntCC::Equal, target, own);
        self.leave_if(itself);
        if ways.reach.sequence_differs {
            let size = 4 >> state;
            let onward = self.constant(self.position.address.wrapping_add(3 * size));
            let address = self.builder.ins().band_imm(target, !1 & 0xFFFF_FFFF);
            let is_onward = self.builder.ins().icmp(IntCC::Equal, address, onward);
            self.leave_if(is_onward);
        }
        entry
    }

    /// Goes on at an entry, behind the instruction with all cycles of fetches up to it.
    pub fn branch_to_entry(&mut self, ways: &Ways, entry: Value, through_cycles: u32) {
        self.clean();
        let left = self.left_after(through_cycles);
        let refill = self
            .builder
            .ins()
            .uload16(types::I32, of_table(), entry, REFILL_CYCLES);
        let left = self.builder.ins().isub(left, refill);
        self.go_to(ways, entry, left);
    }

    /// A word as the target of a branch that stays in the state.
    pub fn target_here(&mut self, value: Value) -> Value {
        if self.position.key & 1 == 0 {
            self.builder.ins().band_imm(value, 0xFFFF_FFFC)
        } else {
            self.builder.ins().bor_imm(value, 1)
        }
    }
}
