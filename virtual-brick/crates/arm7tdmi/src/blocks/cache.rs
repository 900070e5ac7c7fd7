// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The cache of decoded blocks: lookup, successors, invalidation.

use std::fmt;

use super::block::Block;
use super::budget::Budget;
use super::bus::{BlockBus, CodePlace};
use super::jit::Jit;
use super::translate::{translate, BYTES_MAX};

/// The cache holds blocks of at most so many bytes; beyond that, those of some stretch of code are
/// removed.
const BYTES_KEPT_MAX: usize = 8 << 20;
/// Halfwords of the stretch of code whose blocks are removed together.
const STRETCH_HALFWORDS: usize = 0x800;
/// A lower compile threshold is for tests, which want all blocks and all JIT code at once.
const THRESHOLD_OF_RUNS_MIN: u32 = 100;
/// An entry into JIT code costs as much as so many interpreted cycles.
pub(super) const ENTRY_CYCLES: i32 = 40;
/// Invalidating so many blocks costs as much as decoding one instruction.
const INVALIDATIONS_PER_DECODING: usize = 16;
/// The [`Block::key`] of a slot without a block.
const NO_KEY: u32 = u32::MAX;
/// After so many refusals in a row, the first instruction is expected to be refused again.
const REFUSALS_LIKELY: u8 = 4;

/// The decoded blocks of one machine. A copy starts empty, since this is a cache and no state.
pub struct Blocks<B: BlockBus> {
    pub(super) blocks: Vec<Block<B>>,
    free: Vec<u32>,
    /// Number of the block that begins at each halfword, plus one.
    starts: Vec<u32>,
    pub(super) epoch: u32,
    pub(super) jit: Option<Box<dyn Jit>>,
    /// Compile threshold: runs of a block before its compilation is requested; 0 without a JIT.
    pub(super) threshold_runs: u16,
    /// Runs of a block count that begin so many cycles behind the last exit: JIT code that is left
    /// sooner gains nothing.
    pub(super) counted_after_cycles: u32,
    /// Entries into the engine. Hotness decays with them: a block that runs often in few entries
    /// is worth compiling, one that runs now and then in each is not.
    pub(super) entries: u32,
    /// Numbers of the blocks that were compiled together, by region.
    pub(super) regions: Vec<Box<[u32]>>,
    /// Of these, those whose code is still being compiled.
    pub(super) pending_regions: u32,
    pub(super) budget: Budget,
    /// What JIT code has gained, in cycles, that the budget does not know yet.
    pub(super) code_gain_cycles: i64,
    /// Bytes of all blocks.
    bytes: usize,
    /// First halfword of the stretch whose blocks are removed next.
    next_stretch: usize,
}

impl<B: BlockBus> Default for Blocks<B> {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            free: Vec::new(),
            starts: Vec::new(),
            epoch: 0,
            jit: None,
            threshold_runs: 0,
            counted_after_cycles: 0,
            entries: 0,
            regions: Vec::new(),
            pending_regions: 0,
            budget: Budget::new(false),
            code_gain_cycles: 0,
            bytes: 0,
            next_stretch: 0,
        }
    }
}

impl<B: BlockBus> Clone for Blocks<B> {
    fn clone(&self) -> Self {
        self.new_like()
    }
}

impl<B: BlockBus> fmt::Debug for Blocks<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.blocks.len() - self.free.len();
        f.debug_struct("Blocks").field("count", &count).finish()
    }
}

impl<B: BlockBus> Blocks<B> {
    /// An empty cache whose hot blocks are compiled.
    pub fn with_jit(jit: Box<dyn Jit>) -> Self {
        let unlimited = jit.threshold_runs() < THRESHOLD_OF_RUNS_MIN;
        Self {
            threshold_runs: jit.threshold_runs().clamp(1, 0x8000) as u16,
            counted_after_cycles: if unlimited { 0 } else { ENTRY_CYCLES as u32 },
            budget: Budget::new(unlimited),
            jit: Some(jit),
            ..Self::default()
        }
    }

    /// An empty cache that compiles as this one does.
    pub fn new_like(&self) -> Self {
        self.jit
            .as_ref()
            .map_or_else(Self::default, |jit| Self::with_jit(jit.new_like()))
    }

    /// To be asked after each [`Cpu::run_blocks`](crate::Cpu::run_blocks): so many steps shall the
    /// reference engine make before the next, since decoding has cost what it may.
    #[inline(always)]
    pub fn steps_of_reference(&mut self) -> u32 {
        self.budget.steps_of_reference()
    }

    /// Bytes of JIT code compiled so far.
    pub fn jit_code_bytes(&self) -> usize {
        self.jit.as_ref().map_or(0, |jit| jit.code_bytes())
    }

    /// Invalidates what has changed in memory since the last run. False if that would cost more
    /// than blocks have earned: none may run now.
    #[inline(always)]
    pub(super) fn update(&mut self, bus: &mut B) -> bool {
        let epoch = bus.code_epoch();
        if (self.epoch != epoch || self.starts.is_empty()) && !self.begin_epoch(epoch) {
            return false;
        }
        while let Some(halfword) = bus.next_code_change() {
            self.invalidate_word(halfword);
        }
        true
    }

    #[cold]
    #[inline(never)]
    fn begin_epoch(&mut self, epoch: u32) -> bool {
        if !self.budget.affords_decoding() {
            return false;
        }
        self.epoch = epoch;
        self.invalidate_all();
        true
    }

    fn invalidate_all(&mut self) {
        self.budget
            .pay_for_decoding(1 + self.blocks.len() / INVALIDATIONS_PER_DECODING);
        self.invalidate_code();
        if self.starts.is_empty() {
            self.starts = vec![0; B::CODE_HALFWORDS as usize];
        }
        for block in self.blocks.drain(..) {
            self.starts[block.jit.halfword as usize] = 0;
        }
        self.free.clear();
        self.bytes = 0;
    }

    /// Invalidates the blocks that cover a word.
    fn invalidate_word(&mut self, halfword: u32) {
        let first = halfword.saturating_sub(BYTES_MAX / 2);
        for start in first..=halfword + 1 {
            let Some(slot) = self.starts.get_mut(start as usize) else {
                return;
            };
            let Some(number) = slot.checked_sub(1) else {
                continue;
            };
            if start + self.blocks[number as usize].halfwords > halfword {
                *slot = 0;
                self.remove(number);
            }
        }
    }

    fn remove(&mut self, number: u32) {
        self.invalidate_region(self.blocks[number as usize].jit.region);
        let block = &mut self.blocks[number as usize];
        self.bytes -= block.bytes();
        block.key = NO_KEY;
        block.ops = Box::default();
        self.free.push(number);
    }

    /// Invalidates the code of a region; its blocks stay.
    fn invalidate_region(&mut self, region: u32) {
        let numbers = self.regions.get_mut(region as usize).map(std::mem::take);
        let numbers = numbers.unwrap_or_default();
        self.lose_code(&numbers);
        for number in numbers {
            if let Some(block) = self.blocks.get_mut(number as usize) {
                block.make_cold(self.threshold_runs, self.entries);
                if let Some(jit) = &mut self.jit {
                    jit.invalidate(block.jit.halfword);
                }
            }
        }
    }

    /// Tells the budget of the lost code of a region; of none where it was lost before.
    fn lose_code(&mut self, numbers: &[u32]) {
        let blocks = numbers
            .iter()
            .filter_map(|&number| self.blocks.get(number as usize));
        if !numbers.is_empty() {
            self.budget
                .lose_code(blocks.map(|block| block.ops.len()).sum());
        }
    }

    /// Invalidates all JIT code; the blocks stay.
    pub(super) fn invalidate_code(&mut self) {
        for numbers in std::mem::take(&mut self.regions) {
            self.lose_code(&numbers);
        }
        self.pending_regions = 0;
        for block in &mut self.blocks {
            block.make_cold(self.threshold_runs, self.entries);
        }
        if let Some(jit) = &mut self.jit {
            jit.invalidate_all();
        }
    }

    /// Number of the block that begins at `key`; it is translated if it is not in the cache.
    #[inline(always)]
    pub(super) fn find_or_translate(
        &mut self,
        bus: &mut B,
        key: u32,
        place: CodePlace,
    ) -> Option<u32> {
        let slot = self.starts[place.halfword as usize];
        if let Some(block) = self.blocks.get(slot.wrapping_sub(1) as usize) {
            if block.key == key {
                return Some(slot - 1);
            }
        }
        self.translate(bus, key, place, slot)
    }

    /// Translates the block at `key` and replaces the one that began there.
    #[inline(never)]
    fn translate(&mut self, bus: &mut B, key: u32, place: CodePlace, slot: u32) -> Option<u32> {
        if !self.budget.affords_decoding() {
            return None;
        }
        let mut block = translate(bus, key, place)?;
        block.make_cold(self.threshold_runs, self.entries);
        self.budget.pay_for_decoding(block.ops.len());
        if let Some(number) = slot.checked_sub(1) {
            self.starts[place.halfword as usize] = 0;
            self.remove(number);
        }
        let number = self.insert(block);
        self.starts[place.halfword as usize] = number + 1;
        Some(number)
    }

    fn insert(&mut self, block: Block<B>) -> u32 {
        while self.bytes > BYTES_KEPT_MAX {
            self.remove_stretch();
        }
        self.bytes += block.bytes();
        if let Some(number) = self.free.pop() {
            self.blocks[number as usize] = block;
            return number;
        }
        self.blocks.push(block);
        self.blocks.len() as u32 - 1
    }

    /// Removes the blocks of one stretch of code, each in turn.
    #[cold]
    fn remove_stretch(&mut self) {
        let first = self.next_stretch;
        let end = (first + STRETCH_HALFWORDS).min(self.starts.len());
        self.next_stretch = if end == self.starts.len() { 0 } else { end };
        for start in first..end {
            if let Some(number) = std::mem::take(&mut self.starts[start]).checked_sub(1) {
                self.remove(number);
            }
        }
    }

    /// Has the reference engine had to execute the block's first instruction again and again? Now
    /// and then the block is tried all the same.
    #[inline(always)]
    pub(super) fn is_likely_refused(&mut self, number: u32) -> bool {
        let Some(block) = self.blocks.get_mut(number as usize) else {
            return true;
        };
        if block.refusals < REFUSALS_LIKELY {
            return false;
        }
        block.refusals = block.refusals.wrapping_add(1);
        block.refusals != 0
    }

    #[inline(always)]
    pub(super) fn note_refusal(&mut self, number: u32, refused: bool) {
        if let Some(block) = self.blocks.get_mut(number as usize) {
            block.refusals = if refused { block.refusals + 1 } else { 0 };
        }
    }

    /// The block at `key`, as the successor of block `from` from now on. None outside
    /// of this memory.
    #[inline(never)]
    pub(super) fn successor(
        &mut self,
        bus: &mut B,
        from: u32,
        key: u32,
        memory: u8,
    ) -> Option<u32> {
        let place = bus.code_place(key & !1)?;
        if place.memory != memory {
            return None;
        }
        let number = self.find_or_translate(bus, key, place)?;
        if let Some(block) = self.blocks.get_mut(from as usize) {
            block.links = [(key, number), block.links[0]];
        }
        Some(number)
    }

    /// Does this number still stand for the block at `key`?
    #[inline(always)]
    pub(super) fn is_valid(&self, number: u32, key: u32) -> bool {
        let block = self.blocks.get(number as usize);
        block.is_some_and(|block| block.key == key)
    }

    /// Number of the block at `key`, if it is in the cache.
    pub(super) fn find(&self, bus: &B, key: u32) -> Option<u32> {
        let place = bus.code_place(key & !1)?;
        let number = self.starts.get(place.halfword as usize)?.checked_sub(1)?;
        self.is_valid(number, key).then_some(number)
    }
}
