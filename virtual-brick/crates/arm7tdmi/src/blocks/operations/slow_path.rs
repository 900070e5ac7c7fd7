// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The slow path of loads and stores: accesses through the bus. Each ends its block, since
//! afterwards anything can be due, unless the rest of the block still ends before that.

use super::encoding::{extended, width, WRITE_BACK};
use super::run::{first, opcodes, run_next, size_of, End, Op, Ops, Run, NO_MASKS};
use crate::blocks::bus::{BlockBus, BusAccess};
use crate::bus::{Cycle, Width};

/// A load that only the bus can make.
#[cold]
#[inline(never)]
pub(in crate::blocks) fn load<B: BlockBus, const ITEM: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
    (at, moved): (u32, u32),
) {
    first!(ops => op);
    if !run.begin_access(op, at, width(ITEM), false) {
        return;
    }
    let loaded = run.bus.read(at, width(ITEM), Cycle::Nonsequential);
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    run.bus.internal(1);
    match loaded {
        Ok(value) => {
            run.set(op.destination, extended(ITEM, value));
            run.continue_behind(ops);
        }
        Err(_) => run.end_behind(op, End::Aborted),
    }
}

/// A store that only the bus can make.
#[cold]
#[inline(never)]
pub(in crate::blocks) fn store<B: BlockBus, const ITEM: u8>(
    run: &mut Run<'_, B>,
    ops: Ops<'_, B>,
    (at, moved): (u32, u32),
) {
    first!(ops => op);
    let value = run.get(op.destination);
    if !run.begin_access(op, at, width(ITEM), true) {
        return;
    }
    let stored = run.bus.write(at, width(ITEM), value, Cycle::Nonsequential);
    run.state.after_store = op.address;
    if op.mode & WRITE_BACK != 0 {
        run.set(op.first, moved);
    }
    match stored {
        Ok(()) => run.continue_behind(ops),
        Err(_) => run.end_behind(op, End::Aborted),
    }
}

impl<B: BlockBus> Run<'_, B> {
    /// Time and, if memory may change, pipeline as they are when the access of this instruction
    /// begins; false when the reference engine must make it, and the block has ended before it.
    #[inline(always)]
    fn begin_access(&mut self, op: &Op<B>, address: u32, width: Width, write: bool) -> bool {
        let passed = self.passed_at(op);
        match self.bus.access_between(address, width, write, passed) {
            BusAccess::Refused => {
                self.exit_before(op);
                return false;
            }
            BusAccess::KeepsMemory => {}
            BusAccess::ChangesMemory => {
                self.end_behind(op, End::Accessed);
                let ahead = 2 * size_of(self.state.next);
                self.fetched = Some(opcodes(self.bus, self.state.next));
                let next = self.state.next & !1;
                self.bus.continue_at(next.wrapping_add(ahead));
            }
        }
        self.pass(passed);
        self.told_cycles = 0;
        true
    }

    /// The block ends behind the instruction.
    fn end_behind(&mut self, op: &Op<B>, end: End) {
        let state = self.state.next & 1;
        self.state.next = op.address.wrapping_add(size_of(state)) | state;
        self.end = end;
    }

    /// Executes what is left of the block behind an access, if it certainly ends before anything
    /// is due.
    #[inline(always)]
    fn continue_behind(&mut self, ops: Ops<'_, B>) {
        first!(ops => op);
        let through = u32::from(op.through);
        let left = self.worst_cycles - through;
        if self.fetched.is_some() || left > self.budget || self.bus.needs_attention() {
            return self.end_behind(op, End::Accessed);
        }
        self.delayed = NO_MASKS;
        let budget = self.cycles_until_event();
        if left > budget {
            return self.end_behind(op, End::Accessed);
        }
        self.budget = budget;
        self.told_cycles = through;
        run_next(self, ops);
        self.state.cycles -= std::mem::take(&mut self.told_cycles);
    }
}
