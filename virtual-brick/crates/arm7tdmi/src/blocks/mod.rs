// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The fast engine: runs of instructions decoded once and executed many times.
//!
//! A block is entered only if its worst case ends before anything but the processor can act, so
//! nobody can tell when in the block its cycles passed. An access that does more than read or
//! write memory is made through the bus, which is told the time before, and ends the block; so
//! does what changes mode or masks. What is left is the work of the reference engine,
//! [`Cpu::step`]. Both engines leave the same registers, pipeline and cycle counts at the
//! boundaries that they share. Stores to code, also to opcodes already fetched, are made by the
//! reference engine.

mod analysis;
mod beyond;
mod branch;
mod bus;
mod data;
mod native;
mod operand;
mod region;
mod run;
mod source;
mod transfer;
mod translate;

use std::fmt;

pub use bus::{BlockBus, BusAccess, CodePlace, PlainRead, PlainWords};
pub use native::{
    Native, NativeAnswer, NativeBlock, NativeExit, NativeInstruction, NativeJump, NativeMemory,
    NativeReach, NativeRegion, NativeState, BRANCHED, NOWHERE,
};

use crate::bus::Cycle;
use crate::cpu::Cpu;
use crate::pipeline::MASKS_DELAYED;
use crate::registers::psr;
use run::{size_of, End, Run, NO_MASKS, NO_TARGET};
use source::BYTES_MAX;
use translate::{translate, Block};

/// Blocks kept at most; with more, all are forgotten.
const BLOCKS_MAX: usize = 0x4000;
/// Runs count for code of the host by half after so many entries into blocks.
const ENTRIES_PER_AGE: u32 = 4096;
/// So often it is looked whether code has been made in the meantime: in entries, and in runs of a
/// block.
const ENTRIES_PER_LOOK: u32 = 32;
const RUNS_PER_LOOK: u16 = 128;
const NO_KEY: u32 = u32::MAX;
const NO_BLOCK: u32 = u32::MAX;
/// So many times in a row the first instruction was no plain access: so it will be.
const REFUSALS_LIKELY: u8 = 4;

/// Decoded blocks of one machine. A copy starts empty: it is a cache, no state.
pub struct Blocks<B: BlockBus> {
    blocks: Vec<Block<B>>,
    free: Vec<u32>,
    /// Number of the block that begins at each halfword, plus one.
    starts: Vec<u32>,
    epoch: u32,
    native: Option<Box<dyn Native>>,
    /// Runs of a block's operations before code of the host is made of it; else 0.
    worthwhile_runs: u16,
    /// Entries into blocks; what runs often in few of them is worth code, what runs now and then in
    /// each is not.
    entries: u32,
    /// Numbers of the blocks that were made into code together.
    regions: Vec<Box<[u32]>>,
    /// Of these, those whose code is still being made.
    unsettled: u32,
}

/// What a run of blocks did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlocksRun {
    /// Instructions were executed.
    pub ran: bool,
    /// A branch to itself was executed.
    pub spun: bool,
    /// Address of the last instruction when the bus made its access: somebody may have to look
    /// before the next one.
    pub accessed: Option<u32>,
}

impl<B: BlockBus> Default for Blocks<B> {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            free: Vec::new(),
            starts: Vec::new(),
            epoch: 0,
            native: None,
            worthwhile_runs: 0,
            entries: 0,
            regions: Vec::new(),
            unsettled: 0,
        }
    }
}

impl<B: BlockBus> Clone for Blocks<B> {
    fn clone(&self) -> Self {
        self.fresh()
    }
}

impl<B: BlockBus> fmt::Debug for Blocks<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.blocks.len() - self.free.len();
        f.debug_struct("Blocks").field("count", &count).finish()
    }
}

impl<B: BlockBus> Blocks<B> {
    /// None yet; those that run often are made into code of the host.
    pub fn with_native(native: Box<dyn Native>) -> Self {
        Self {
            worthwhile_runs: native.worthwhile_runs().clamp(1, 0x8000) as u16,
            native: Some(native),
            ..Self::default()
        }
    }

    /// As these, but none yet.
    pub fn fresh(&self) -> Self {
        self.native
            .as_ref()
            .map_or_else(Self::default, |native| Self::with_native(native.fresh()))
    }

    fn forget_all(&mut self) {
        self.forget_native();
        self.blocks.clear();
        self.free.clear();
        self.starts.clear();
        self.starts.resize(B::CODE_HALFWORDS as usize, 0);
    }

    /// Follow what happened to the code since the last run.
    #[inline(always)]
    fn update(&mut self, bus: &mut B) {
        let epoch = bus.code_epoch();
        if self.epoch != epoch || self.starts.is_empty() {
            self.epoch = epoch;
            self.forget_all();
        }
        while let Some(halfword) = bus.next_code_change() {
            self.forget(halfword);
        }
    }

    /// Forget the blocks that cover a word.
    fn forget(&mut self, halfword: u32) {
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
                self.release(number);
            }
        }
    }

    fn release(&mut self, number: u32) {
        let region = self.blocks[number as usize].native.region;
        self.forget_region(region);
        let block = &mut self.blocks[number as usize];
        block.key = NO_KEY;
        block.ops = Box::default();
        self.free.push(number);
    }

    /// Number of the block that begins at `key`, translated if need be.
    #[inline(always)]
    fn find(&mut self, bus: &mut B, key: u32, place: CodePlace) -> Option<u32> {
        let known = self.starts[place.halfword as usize];
        if let Some(block) = self.blocks.get(known.wrapping_sub(1) as usize) {
            if block.key == key {
                return Some(known - 1);
            }
        }
        self.add(bus, key, place, known)
    }

    /// Translates the block at `key`, in place of the one that began there.
    #[inline(never)]
    fn add(&mut self, bus: &mut B, key: u32, place: CodePlace, known: u32) -> Option<u32> {
        let block = translate(bus, key, place)?;
        if let Some(number) = known.checked_sub(1) {
            self.starts[place.halfword as usize] = 0;
            self.release(number);
        }
        let number = self.insert(block);
        self.starts[place.halfword as usize] = number + 1;
        Some(number)
    }

    fn insert(&mut self, block: Block<B>) -> u32 {
        if let Some(number) = self.free.pop() {
            self.blocks[number as usize] = block;
            return number;
        }
        if self.blocks.len() >= BLOCKS_MAX {
            self.forget_all();
        }
        self.blocks.push(block);
        self.blocks.len() as u32 - 1
    }

    /// The block's first instruction was left to the reference engine again and again. Now and
    /// then the block is tried all the same.
    #[inline(always)]
    fn likely_refuses(&mut self, number: u32) -> bool {
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
    fn note_refusal(&mut self, number: u32, refused: bool) {
        if let Some(block) = self.blocks.get_mut(number as usize) {
            block.refusals = if refused { block.refusals + 1 } else { 0 };
        }
    }

    /// The block at `key` that follows block `from`, when no link leads there.
    #[inline(never)]
    fn successor(&mut self, bus: &mut B, from: u32, key: u32, region: u8) -> Option<u32> {
        let place = bus.code_place(key & !1)?;
        if place.region != region {
            return None;
        }
        let number = self.find(bus, key, place)?;
        if let Some(block) = self.blocks.get_mut(from as usize) {
            block.links = [(key, number), block.links[0]];
        }
        Some(number)
    }

    /// The number of a known block.
    #[inline(always)]
    fn known(&self, number: u32, key: u32) -> Option<&Block<B>> {
        let block = self.blocks.get(number as usize)?;
        (block.key == key).then_some(block)
    }
}

impl<B: BlockBus> Block<B> {
    /// Number of the block at `key` if it followed this one lately; it may have been forgotten.
    #[inline(always)]
    fn link(&self, key: u32) -> u32 {
        let [first, second] = self.links;
        if first.0 == key {
            first.1
        } else if second.0 == key {
            second.1
        } else {
            NO_BLOCK
        }
    }
}

impl Cpu {
    /// Runs blocks as long as the next surely ends before `limit` and before anything can act on
    /// the processor. Does nothing where no block can be entered, or for fewer than `worthwhile`
    /// cycles.
    pub fn run_blocks<B: BlockBus>(
        &mut self,
        bus: &mut B,
        blocks: &mut Blocks<B>,
        limit: u64,
        worthwhile: u32,
    ) -> BlocksRun {
        let status = self.registers.status();
        let budget = bus.quiet_cycles(limit, status & psr::I == 0, status & psr::F == 0);
        if self.pipeline.attention != 0 || budget < worthwhile {
            return BlocksRun::default();
        }
        blocks.update(bus);
        let start = self.next_instruction_address() | u32::from(self.thumb());
        let Some(place) = bus
            .code_place(start & !1)
            .filter(|_| bus.enters(start & !1))
        else {
            return BlocksRun::default();
        };
        let Some(first) = blocks.find(bus, start, place) else {
            return BlocksRun::default();
        };
        if blocks.likely_refuses(first) || !self.pipeline_follows(bus, start, place.region) {
            return BlocksRun::default();
        }
        blocks.entries = blocks.entries.wrapping_add(1);
        if blocks.unsettled != 0 && blocks.entries % ENTRIES_PER_LOOK == 0 {
            blocks.take_native(None);
        }
        let mut run = self.begin(bus, start, place.region);
        execute(&mut run, blocks, first, (budget, limit));
        let done = run.done();
        blocks.note_refusal(first, run.end == End::Refused && !done.ran);
        if done.ran {
            let aborted = run.end == End::Aborted;
            run.store_status();
            let (next, after_store) = (run.state.next, run.state.after_store);
            let (fetched, delayed) = (run.fetched, run.delayed);
            self.end(bus, next, after_store, fetched);
            if delayed != NO_MASKS {
                self.pipeline.attention |= MASKS_DELAYED;
                self.pipeline.delayed_masks = delayed;
            }
            if aborted {
                self.enter_data_abort(bus);
            }
        }
        done
    }

    /// The pipeline holds what memory holds, and the next fetch has its regular cost.
    fn pipeline_follows<B: BlockBus>(&self, bus: &B, key: u32, region: u8) -> bool {
        let (address, size) = (key & !1, size_of(key));
        let ahead = address.wrapping_add(2 * size);
        address % size == 0
            && bus.in_sequence(ahead)
            && bus.code_place(ahead).map(|place| place.region) == Some(region)
            && self.pipeline.opcodes == opcodes(bus, key)
    }

    fn begin<'a, B: BlockBus>(&'a mut self, bus: &'a mut B, next: u32, region: u8) -> Run<'a, B> {
        let mut run = Run {
            state: NativeState {
                registers: self.registers.visible(),
                next,
                after_store: NOWHERE,
                ..NativeState::default()
            },
            end: End::Reached,
            ran: false,
            fetched: None,
            delayed: NO_MASKS,
            delays_masks: self.profile.mask_change_delayed,
            spun: false,
            region,
            file: &mut self.registers,
            bus,
        };
        run.load_flags();
        run
    }

    fn end<B: BlockBus>(
        &mut self,
        bus: &mut B,
        next: u32,
        after_store: u32,
        fetched: Option<[u32; 2]>,
    ) {
        let (address, size) = (next & !1, size_of(next));
        let state = if next & 1 != 0 { psr::T } else { 0 };
        self.registers
            .set_flags(self.registers.status() & !psr::T | state);
        self.registers.set_pc(address.wrapping_add(2 * size));
        self.pipeline.opcodes = fetched.unwrap_or_else(|| opcodes(bus, next));
        self.pipeline.next_fetch = if after_store.wrapping_add(size) == address {
            Cycle::Nonsequential
        } else {
            Cycle::Sequential
        };
        bus.continue_at(address.wrapping_add(2 * size));
    }
}

/// The two opcodes that memory holds at `key`.
#[inline(always)]
fn opcodes<B: BlockBus>(bus: &B, key: u32) -> [u32; 2] {
    let (address, next) = (key & !1, (key & !1).wrapping_add(size_of(key)));
    let (first, second) = (bus.code_word(address), bus.code_word(next));
    if key & 1 == 0 {
        [first, second]
    } else {
        let half = |word: u32, address: u32| word >> (8 * (address & 2)) & 0xFFFF;
        [half(first, address), half(second, next)]
    }
}

impl<B: BlockBus> Run<'_, B> {
    /// Tells the bus the time, and what was done.
    fn done(&mut self) -> BlocksRun {
        if self.state.cycles != 0 {
            self.bus.pass(self.state.cycles);
            self.ran = true;
            self.delayed = NO_MASKS;
        }
        let size = size_of(self.state.next);
        BlocksRun {
            ran: self.ran,
            spun: self.spun,
            accessed: matches!(self.end, End::Accessed | End::Aborted)
                .then(|| (self.state.next & !1).wrapping_sub(size)),
        }
    }

    /// A loop that finds the same state each time: what is left of the budget passes so.
    #[inline(never)]
    fn passes(&mut self, block: &Block<B>, begun: u32, budget: u32) -> bool {
        let once = self.state.cycles - begun;
        let again = block.key == self.state.next && once != 0;
        if !again || self.state.cycles + block.worst > budget {
            return false;
        }
        let times = (budget - block.worst - self.state.cycles) / once + 1;
        self.state.cycles += times * once;
        true
    }

    /// After an access that can change memory: the pipeline still holds what memory holds.
    #[inline(never)]
    fn settles(&mut self, blocks: &mut Blocks<B>) -> bool {
        let ahead = (self.state.next & !1).wrapping_add(2 * size_of(self.state.next));
        let same = self.fetched == Some(opcodes(self.bus, self.state.next));
        if !same || !self.bus.in_sequence(ahead) || self.bus.code_epoch() != blocks.epoch {
            return false;
        }
        self.fetched = None;
        blocks.update(self.bus);
        true
    }

    /// After an access through the bus, or with other masks: the cycles that are quiet from here
    /// on; none when somebody else has to look first.
    #[inline(never)]
    fn go_on(&mut self, blocks: &mut Blocks<B>, limit: u64) -> Option<u32> {
        match self.end {
            End::Accessed => {
                self.delayed = NO_MASKS;
                if self.bus.attention() || self.fetched.is_some() && !self.settles(blocks) {
                    return None;
                }
            }
            End::Status => {
                self.bus.pass(self.state.cycles);
                self.state.cycles = 0;
                self.ran = true;
            }
            End::Aborted => {
                self.delayed = NO_MASKS;
                return None;
            }
            End::Reached | End::Refused => return None,
        }
        // The masks of both sides of a boundary count.
        let masks = self.file.status() & self.delayed;
        let (irq, fiq) = (masks & psr::I == 0, masks & psr::F == 0);
        let budget = self.bus.quiet_cycles(limit, irq, fiq);
        if budget == 0 {
            return None;
        }
        self.end = End::Reached;
        Some(budget)
    }
}

#[inline(never)]
fn execute<B: BlockBus>(
    run: &mut Run<'_, B>,
    blocks: &mut Blocks<B>,
    first: u32,
    (mut budget, limit): (u32, u64),
) {
    let mut number = first;
    loop {
        let begun = run.state.cycles;
        let Some(mut whole) = run_once(run, blocks, &mut number, budget) else {
            return;
        };
        let Some(block) = blocks.blocks.get(number as usize) else {
            return;
        };
        let link = block.link(run.state.next);
        if run.end == End::Reached {
            whole &= block.repeats;
            if whole && run.passes(block, begun, budget) {
                return;
            }
        } else {
            match run.go_on(blocks, limit) {
                Some(quiet) => budget = quiet,
                None => return,
            }
        }
        number = match blocks.known(link, run.state.next) {
            Some(_) => link,
            None => match blocks.successor(run.bus, number, run.state.next, run.region) {
                Some(found) => found,
                None => return,
            },
        };
    }
}

/// Runs the block of this number, or as much of it as the budget allows, or code of the host from
/// there on; the number becomes that of the block that ran last. True if its operations ran from
/// the first on; none when the budget ends.
#[inline(always)]
fn run_once<B: BlockBus>(
    run: &mut Run<'_, B>,
    blocks: &mut Blocks<B>,
    number: &mut u32,
    budget: u32,
) -> Option<bool> {
    let worthwhile_runs = blocks.worthwhile_runs;
    let age = (blocks.entries / ENTRIES_PER_AGE) as u16;
    let mut block = blocks.blocks.get_mut(*number as usize)?;
    if run.state.cycles + block.worst > budget {
        return execute_part(run, block, budget - run.state.cycles).then_some(true);
    }
    if block.native.enters {
        *number = blocks.run_native(run, *number, budget)?;
        return Some(false);
    }
    if block.native.age != age {
        block.native.age = age;
        block.native.heat /= 2;
    }
    block.native.heat = block.native.heat.wrapping_add(1);
    if block.native.heat.wrapping_sub(worthwhile_runs) % RUNS_PER_LOOK == 0 {
        blocks.look_for_native(run.bus, *number);
        block = blocks.blocks.get_mut(*number as usize)?;
    }
    let mut ops = block.ops.iter();
    if let Some(op) = ops.next() {
        (op.handler)(run, op, ops);
    }
    Some(true)
}

/// As much of a block as surely ends within `budget` cycles; what took less than it could have
/// leaves more to those behind. False if the block ended between two instructions.
fn execute_part<B: BlockBus>(run: &mut Run<'_, B>, block: &Block<B>, budget: u32) -> bool {
    let limit = run.state.cycles + budget;
    let state = block.key & 1;
    let (mut rest, mut worst) = (&*block.ops, 0);
    while let Some(next) = rest.first() {
        let begun = run.state.cycles + u32::from(next.before);
        let quiet = limit - begun + worst;
        let (part, behind) = rest.split_at(rest.partition_point(|op| u32::from(op.worst) <= quiet));
        let mut ops = part.iter();
        let Some(op) = ops.next() else {
            run.state.cycles = begun;
            run.state.next = next.address | state;
            return false;
        };
        run.state.next = NO_TARGET | state;
        (op.handler)(run, op, ops);
        if run.state.next != NO_TARGET | state {
            return true;
        }
        worst = part.last().map_or(worst, |op| u32::from(op.worst));
        rest = behind;
    }
    true
}
