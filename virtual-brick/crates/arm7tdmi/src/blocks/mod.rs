// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The fast engine: runs of instructions decoded once and executed many times.
//!
//! A block is entered only if its worst case ends before anything but the processor can act, so
//! nobody can tell when in the block its cycles passed. An access that does more than read or
//! write memory ends the block before its instruction; the reference engine, [`Cpu::step`], makes
//! it. Both engines leave the same registers, pipeline and cycle counts at the boundaries that
//! they share. Stores to code, also to opcodes already fetched, are made by the reference engine.

mod analysis;
mod branch;
mod bus;
mod data;
mod run;
mod transfer;
mod translate;

use std::fmt;

pub use bus::{BlockBus, CodePlace, PlainRead, PlainWords};

use crate::bus::Cycle;
use crate::cpu::Cpu;
use crate::registers::psr;
use run::{size_of, Run, NOWHERE, NO_TARGET};
use translate::{translate, Block, BYTES_MAX};

/// Blocks kept at most; with more, all are forgotten.
const BLOCKS_MAX: usize = 0x4000;
const NO_KEY: u32 = u32::MAX;
/// So many times in a row the first instruction was no plain access: so it will be.
const REFUSALS_LIKELY: u8 = 4;

/// Decoded blocks of one machine. A copy starts empty: it is a cache, no state.
pub struct Blocks<B: BlockBus> {
    blocks: Vec<Block<B>>,
    free: Vec<u32>,
    /// Number of the block that begins at each halfword, plus one.
    starts: Vec<u32>,
    epoch: u32,
}

/// What a run of blocks did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlocksRun {
    /// Cycles that passed.
    pub cycles: u32,
    /// A branch to itself was executed.
    pub spun: bool,
}

impl<B: BlockBus> Default for Blocks<B> {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            free: Vec::new(),
            starts: Vec::new(),
            epoch: 0,
        }
    }
}

impl<B: BlockBus> Clone for Blocks<B> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<B: BlockBus> fmt::Debug for Blocks<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.blocks.len() - self.free.len();
        f.debug_struct("Blocks").field("count", &count).finish()
    }
}

impl<B: BlockBus> Blocks<B> {
    fn forget_all(&mut self) {
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

    /// The block at `key` that follows block `from`.
    #[inline(always)]
    fn successor(&mut self, bus: &mut B, from: u32, key: u32, region: u8) -> Option<u32> {
        let links = self.blocks.get(from as usize)?.links;
        for (known, number) in links {
            let linked = self.blocks.get(number as usize);
            if known == key && linked.is_some_and(|block| block.key == key) {
                return Some(number);
            }
        }
        let place = bus.code_place(key & !1)?;
        if place.region != region {
            return None;
        }
        let number = self.find(bus, key, place)?;
        if let Some(block) = self.blocks.get_mut(from as usize) {
            block.links = [(key, number), links[0]];
        }
        Some(number)
    }
}

impl Cpu {
    /// Runs blocks as long as the next surely ends within `budget` cycles, in which no event and
    /// no interrupt may fall. Does nothing where no block can be entered.
    pub fn run_blocks<B: BlockBus>(
        &mut self,
        bus: &mut B,
        blocks: &mut Blocks<B>,
        budget: u32,
    ) -> BlocksRun {
        blocks.update(bus);
        if self.pipeline.attention != 0 || budget == 0 {
            return BlocksRun::default();
        }
        let start = self.next_instruction_address() | u32::from(self.thumb());
        let Some(place) = bus.code_place(start & !1) else {
            return BlocksRun::default();
        };
        let Some(first) = blocks.find(bus, start, place) else {
            return BlocksRun::default();
        };
        if blocks.likely_refuses(first) || !self.pipeline_follows(bus, start, place.region) {
            return BlocksRun::default();
        }
        let mut run = self.begin(bus, start, place.region);
        execute(&mut run, blocks, first, budget);
        blocks.note_refusal(first, run.leave && run.cycles == 0);
        let done = BlocksRun {
            cycles: run.cycles,
            spun: run.spun,
        };
        if run.cycles != 0 {
            let (registers, next, after_store) = (run.registers, run.next, run.after_store);
            let flags = run.negative >> 31 << 31
                | u32::from(run.zero == 0) << 30
                | run.carry << 29
                | run.overflow << 28;
            self.end(bus, &registers, flags, next, after_store);
            bus.pass(done.cycles);
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

    fn begin<'a, B: BlockBus>(&self, bus: &'a mut B, next: u32, region: u8) -> Run<'a, B> {
        let status = self.registers.status();
        Run {
            registers: self.registers.visible(),
            negative: status & psr::N,
            zero: u32::from(status & psr::Z == 0),
            carry: status >> 29 & 1,
            overflow: status >> 28 & 1,
            cycles: 0,
            next,
            leave: false,
            after_store: NOWHERE,
            spun: false,
            masked: status & psr::I != 0,
            region,
            bus,
        }
    }

    fn end<B: BlockBus>(
        &mut self,
        bus: &mut B,
        registers: &[u32; 16],
        flags: u32,
        next: u32,
        after_store: u32,
    ) {
        let (address, size) = (next & !1, size_of(next));
        self.registers.set_visible(registers);
        let status = self.registers.status() & 0x0FFF_FFFF & !psr::T;
        let state = if next & 1 != 0 { psr::T } else { 0 };
        self.registers.set_flags(status | state | flags);
        self.registers.set_pc(address.wrapping_add(2 * size));
        self.pipeline.opcodes = opcodes(bus, next);
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

fn execute<B: BlockBus>(run: &mut Run<'_, B>, blocks: &mut Blocks<B>, first: u32, budget: u32) {
    let mut number = first;
    loop {
        let Some(block) = blocks.blocks.get(number as usize) else {
            return;
        };
        let (key, begun) = (block.key, run.cycles);
        if begun + block.worst > budget {
            return execute_part(run, block, budget - begun);
        }
        if let Some((op, rest)) = block.ops.split_first() {
            (op.handler)(run, op, rest);
        }
        if run.leave {
            return;
        }
        if run.next == key {
            // The same state comes back each time: what is left of the budget passes so.
            let once = run.cycles - begun;
            if block.repeats && once != 0 && run.cycles + block.worst <= budget {
                let times = (budget - block.worst - run.cycles) / once + 1;
                run.cycles += times * once;
                return;
            }
            continue;
        }
        match blocks.successor(run.bus, number, run.next, run.region) {
            Some(next) => number = next,
            None => return,
        }
    }
}

/// As much of a block as surely ends within `budget` cycles.
fn execute_part<B: BlockBus>(run: &mut Run<'_, B>, block: &Block<B>, budget: u32) {
    let count = block
        .ops
        .partition_point(|op| u32::from(op.worst) <= budget);
    let (Some((op, rest)), Some(next)) = (block.ops[..count].split_first(), block.ops.get(count))
    else {
        return;
    };
    let state = block.key & 1;
    run.next = NO_TARGET | state;
    (op.handler)(run, op, rest);
    if run.next == NO_TARGET | state {
        run.cycles += u32::from(next.before);
        run.next = next.address | state;
    }
}
