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
        Err(_) => run.end = End::Aborted,
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
        Err(_) => run.end = End::Aborted,
    }
}

impl<B: BlockBus> Run<'_, B> {
    /// Time and pipeline as they are when the access of this instruction begins; false when the
    /// reference engine must make it, and the block has ended before it.
    #[inline(always)]
    fn begin_access(&mut self, op: &Op<B>, address: u32, width: Width, write: bool) -> bool {
        let passed = self.passed_at(op);
        let access = self.bus.access_between(address, width, write, passed);
        if access == BusAccess::Refused {
            self.exit_before(op);
            return false;
        }
        let (state, size) = (self.state.next & 1, size_of(self.state.next));
        self.state.next = op.address.wrapping_add(size) | state;
        if access == BusAccess::ChangesMemory {
            self.fetched = Some(opcodes(self.bus, self.state.next));
        }
        self.bus.continue_at(op.address.wrapping_add(3 * size));
        self.pass(passed);
        self.told_cycles = 0;
        self.end = End::Accessed;
        true
    }

    /// Executes what is left of the block behind an access, if it certainly ends before anything
    /// is due.
    fn continue_behind(&mut self, ops: Ops<'_, B>) {
        first!(ops => op);
        let through = u32::from(op.through);
        let left = self.worst_cycles - through;
        if self.fetched.is_some() || self.bus.needs_attention() || left > self.budget {
            return;
        }
        self.delayed = NO_MASKS;
        let budget = self.cycles_until_event();
        if left > budget {
            return;
        }
        self.budget = budget;
        self.end = End::Reached;
        self.told_cycles = through;
        run_next(self, ops);
        self.state.cycles -= std::mem::take(&mut self.told_cycles);
    }
}
