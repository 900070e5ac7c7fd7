// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! One decoded block.

use super::bus::BlockBus;
use super::operations::run::{Handler, Op, Run, NO_TARGET};

const NO_BLOCK: u32 = u32::MAX;
/// More cycles than any budget has.
const MORE_THAN_BUDGET: u32 = 1 << 31;
pub(super) const NO_REGION: u32 = u32::MAX;

/// How hot a block is, and its JIT code.
#[derive(Clone, Copy, Debug)]
pub(super) struct JitState {
    /// Number of the block's first halfword.
    pub halfword: u32,
    /// Runs until the compiler is asked for its code; only those count that begin when nothing
    /// has been left to the bus for a while.
    pub runs_left: u16,
    /// Number of the entry into the engine from which on these runs are counted.
    pub counted_from: u32,
    /// Number of the entry into the engine in which the compiler was polled last.
    pub polled_at_entry: u32,
    /// Runs since its compilation was first too expensive, those until the next request included.
    pub postponed_runs: u32,
    /// What entries into its code have gained lately, in cycles; below a bound the block is
    /// interpreted.
    pub gain_cycles: i16,
    /// It has code that is entered.
    pub has_code: bool,
    /// The region that it was compiled with.
    pub region: u32,
}

impl JitState {
    /// Of a block that has not run yet, at this entry into the engine.
    pub const fn cold(halfword: u32, threshold_runs: u16, entries: u32) -> Self {
        Self {
            halfword,
            runs_left: threshold_runs,
            counted_from: entries,
            polled_at_entry: 0,
            postponed_runs: 0,
            gain_cycles: 0,
            has_code: false,
            region: NO_REGION,
        }
    }
}

/// Instructions that run one after the other.
pub(super) struct Block<B: BlockBus> {
    /// Address of the first; bit 0 tells Thumb state.
    pub key: u32,
    /// Halfwords that it covers: a change of one makes it invalid.
    pub halfwords: u32,
    /// Most cycles it can take.
    pub worst_cycles: u32,
    /// As many, or more than any budget has where there is more to do than to run its operations:
    /// it has JIT code, or can find the same state again.
    pub simply_run_cycles: u32,
    /// Running it again changes nothing, as long as memory stays.
    pub is_idempotent: bool,
    /// Times in a row that its first instruction was left to the reference engine.
    pub refusals: u8,
    /// Handler of the first operation.
    pub first: Handler<B>,
    pub ops: Box<[Op<B>]>,
    /// Keys and numbers of its last two successors.
    pub links: [(u32, u32); 2],
    pub jit: JitState,
}

impl<B: BlockBus> Block<B> {
    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        std::mem::size_of::<Self>() + std::mem::size_of_val(&*self.ops)
    }

    /// Number of the block at `key` if it followed this one lately; it may be invalid by now.
    #[inline(always)]
    pub fn link(&self, key: u32) -> u32 {
        let [first, second] = self.links;
        if first.0 == key {
            first.1
        } else if second.0 == key {
            second.1
        } else {
            NO_BLOCK
        }
    }

    /// It has no JIT code and has not run lately.
    pub fn make_cold(&mut self, threshold_runs: u16, entries: u32) {
        self.jit = JitState::cold(self.jit.halfword, threshold_runs, entries);
        self.set_code(false);
    }

    /// Run again, it may find another state: it reads a register that changes by itself.
    pub fn never_idles(&mut self) {
        self.is_idempotent = false;
        self.set_code(self.jit.has_code);
    }

    /// Whether it has JIT code that is entered.
    pub fn set_code(&mut self, has_code: bool) {
        self.jit.has_code = has_code;
        self.simply_run_cycles = if has_code || self.is_idempotent {
            MORE_THAN_BUDGET
        } else {
            self.worst_cycles
        };
    }

    /// Runs the block up to its end or to an exit.
    #[inline(always)]
    pub fn execute(&self, run: &mut Run<'_, B>) {
        (self.first)(run, self.ops.iter());
    }

    /// As [`Block::execute`], from the operation of this number on.
    pub fn execute_from(&self, run: &mut Run<'_, B>, number: usize) {
        if let Some(ops) = self.ops.get(number..) {
            self.handler(number)(run, ops.iter());
        }
    }

    /// Handler of the operation of this number.
    fn handler(&self, number: usize) -> Handler<B> {
        let before = number
            .checked_sub(1)
            .and_then(|before| self.ops.get(before));
        before.map_or(self.first, |before| before.next)
    }

    /// Runs as much of the block as certainly ends within `budget` cycles. Instructions that take
    /// less than their worst case leave more to those behind. False if the block was left between
    /// two instructions.
    pub fn run_part(&self, run: &mut Run<'_, B>, budget: u32) -> bool {
        let limit = run.state.cycles + budget;
        let state = self.key & 1;
        let (mut rest, mut handler, mut worst) = (&*self.ops, self.first, 0);
        while let Some(next) = rest.first() {
            let start_cycles = run.state.cycles + u32::from(next.before);
            let left = limit - start_cycles + worst;
            let (part, behind) =
                rest.split_at(rest.partition_point(|op| u32::from(op.worst) <= left));
            let Some(last) = part.last() else {
                run.state.cycles = start_cycles;
                run.state.next = next.address | state;
                return false;
            };
            run.state.next = NO_TARGET | state;
            handler(run, part.iter());
            if run.state.next != NO_TARGET | state {
                return true;
            }
            (rest, handler, worst) = (behind, last.next, u32::from(last.worst));
        }
        true
    }
}
