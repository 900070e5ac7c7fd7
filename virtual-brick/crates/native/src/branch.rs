// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Branches to targets that are known only at run time: through the table of places.

use arm7tdmi::{NativeJump, NativeReach};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, AliasRegion, BlockArg, InstBuilder, MemFlags, SigRef, Value};

use crate::function::{Arguments, Function, Shared};
use crate::table::{Entry, Exit, CODE, INDEX, KEY, REFILL_CYCLES};

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
    fn entry_at(&mut self, ways: &Ways, halfword: u32) -> Value {
        let address = ways.table + ((halfword as usize) << ENTRY_SHIFT);
        self.builder.ins().iconst(types::I64, address as i64)
    }

    fn entry_key(&mut self, entry: Value) -> Value {
        self.builder.ins().load(types::I32, of_table(), entry, KEY)
    }

    /// Goes on in other code.
    fn go_to(&mut self, entry: Value, left: Value) {
        let onward = self.shared.onward;
        self.builder
            .ins()
            .jump(onward, &[entry.into(), left.into()]);
        self.ended = true;
    }

    /// Goes on in other code if there is some of this target, else leaves the code.
    pub fn go_to_known(&mut self, ways: &Ways, jump: NativeJump, left: Value, exit: Exit) {
        let entry = self.entry_at(ways, jump.halfword);
        let (key, exit) = (self.constant(jump.key), self.exit(exit));
        let values = [entry, key, left, exit].map(BlockArg::from);
        let known = self.shared.known;
        self.builder.ins().jump(known, &values);
        self.ended = true;
    }

    /// What all ways to other code end with: it is made once, since making code costs more than a
    /// jump.
    pub fn finish_ways(&mut self, ways: &Ways) {
        let Shared { onward, known, .. } = self.shared;
        self.builder.switch_to_block(known);
        if let [entry, key, left, exit] = *self.builder.block_params(known) {
            let found = self.entry_key(entry);
            let none = self.differs(found, key);
            let (back, others) = ([left.into(), exit.into()], [entry.into(), left.into()]);
            let target = self.shared.back;
            let ins = self.builder.ins();
            ins.brif(none, target, &back, onward, &others);
        }
        self.builder.switch_to_block(onward);
        if let [entry, left] = *self.builder.block_params(onward) {
            let ins = self.builder.ins();
            let index = ins.uload16(types::I32, of_table(), entry, INDEX);
            let code = self.builder.ins().load(types::I64, of_table(), entry, CODE);
            let Arguments {
                state,
                words,
                marks,
            } = self.arguments;
            let values = [state, left, words, marks, index];
            let ins = self.builder.ins();
            ins.return_call_indirect(ways.signature, code, &values);
        }
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
        let other = self.builder.ins().icmp(IntCC::NotEqual, key, target);
        let state = self.position.key & 1;
        let own = self.constant(self.position.address | state);
        let itself = self.builder.ins().icmp(IntCC::Equal, target, own);
        let mut odd = self.builder.ins().bor(other, itself);
        if ways.reach.sequence_differs {
            let size = 4 >> state;
            let onward = self.constant(self.position.address.wrapping_add(3 * size));
            let address = self.builder.ins().band_imm(target, !1 & 0xFFFF_FFFF);
            let is_onward = self.builder.ins().icmp(IntCC::Equal, address, onward);
            odd = self.builder.ins().bor(odd, is_onward);
        }
        self.leave_if(odd);
        entry
    }

    /// Goes on at an entry, behind the instruction with all cycles of fetches up to it.
    pub fn branch_to_entry(&mut self, entry: Value, through_cycles: u32) {
        self.clean();
        let left = self.left_after(through_cycles);
        let refill = self
            .builder
            .ins()
            .uload16(types::I32, of_table(), entry, REFILL_CYCLES);
        let left = self.builder.ins().isub(left, refill);
        self.go_to(entry, left);
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
