// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Hot blocks: requests for their compilation, installation and execution of their code.

use super::block::NO_REGION;
use super::bus::BlockBus;
use super::cache::{Blocks, ENTRY_CYCLES};
use super::jit::{CompileAnswer, Region, RegionBlock, EXIT_BY_BRANCH};
use super::operations::run::Run;
use super::region::{code_window, describe};
use super::state::NO_ADDRESS;
use super::translate::read_source;

/// A region has at most so many blocks.
const BLOCKS_MAX: usize = 16;
/// A block joins a region if it ran at least this fraction of the compile threshold.
const WARM_FRACTION: u16 = 2;
/// A block is hot that reaches the compile threshold within so many entries into the engine: one
/// that runs now and then in each entry is not worth compiling.
const ENTRIES_MAX: u32 = 1024;
/// The compiler is polled for the code of a block so often, in runs.
const RUNS_PER_POLL: u16 = 128;
/// A request that was too expensive is made again when the block has run longer by this part: to
/// ask costs as much as some runs.
const POSTPONED_PART: u32 = 4;
/// Code that has lost so many cycles is not entered any more; gains beyond that are not counted.
const LOSS_CYCLES_MAX: i32 = 32 * ENTRY_CYCLES;

impl<B: BlockBus> Blocks<B> {
    /// Requests compilation of a block that has become hot, and installs what has been compiled
    /// by now. A block that runs again and again without leaving the engine waits for its code.
    #[cold]
    #[inline(never)]
    pub(super) fn poll_compiler(&mut self, bus: &mut B, number: u32) {
        let (entries, threshold_runs) = (self.entries, self.threshold_runs);
        let Some(block) = self.blocks.get_mut(number as usize) else {
            return;
        };
        let busy = block.jit.polled_at_entry == entries;
        block.jit.polled_at_entry = entries;
        let region = block.jit.region;
        // Where there will be no code, this is asked again after so many runs.
        block.jit.runs_left = u16::MAX;
        if region != NO_REGION && self.pending_regions != 0 {
            block.jit.runs_left = RUNS_PER_POLL;
        } else if region == NO_REGION && threshold_runs != 0 {
            let hot = entries.wrapping_sub(block.jit.counted_from) <= ENTRIES_MAX;
            block.jit.counted_from = entries;
            if hot {
                self.request_region(bus, number);
            } else {
                block.jit.runs_left = threshold_runs;
            }
        }
        if self.pending_regions != 0 {
            self.install_compiled((busy && region != NO_REGION).then_some(region));
        }
    }

    /// Requests compilation of a block and of those around it.
    fn request_region(&mut self, bus: &mut B, number: u32) {
        let block = &mut self.blocks[number as usize];
        let (runs, size) = (block.jit.postponed_runs, block.ops.len());
        if !self.budget.affords_compiling(size, u64::from(runs)) {
            let more = u16::try_from(runs / POSTPONED_PART).unwrap_or(u16::MAX);
            block.jit.runs_left = more.max(self.threshold_runs);
            block.jit.postponed_runs = runs.saturating_add(u32::from(block.jit.runs_left));
            return;
        }
        if self.jit.as_ref().is_some_and(|jit| jit.is_exhausted()) {
            self.invalidate_code();
        }
        let blocks = self.hot_neighbourhood(bus, number);
        let Some(first) = blocks.first() else {
            return;
        };
        let instructions = blocks.iter().map(|block| block.instructions.len()).sum();
        let region_number = self.regions.len() as u32;
        let numbers: Box<[u32]> = blocks.iter().map(|block| block.number).collect();
        let region = Region {
            number: region_number,
            window: code_window(bus, first),
            ram_cycles: bus.ram_cycles(),
            blocks,
        };
        let (Some(jit), Some(ram)) = (&mut self.jit, bus.ram_view()) else {
            return;
        };
        match jit.request(region, &ram) {
            CompileAnswer::Queued => {
                self.budget.pay_for_compiling(instructions);
                self.note_request(region_number, numbers);
            }
            CompileAnswer::Busy => {
                self.blocks[number as usize].jit.runs_left = self.threshold_runs;
            }
            CompileAnswer::Unsupported => {}
        }
    }

    fn note_request(&mut self, region: u32, numbers: Box<[u32]>) {
        for &number in &numbers {
            if let Some(block) = self.blocks.get_mut(number as usize) {
                block.jit.region = region;
                block.jit.runs_left = RUNS_PER_POLL;
            }
        }
        self.regions.push(numbers);
        self.pending_regions += 1;
    }

    /// Installs what has been compiled by now, and waits for the region `awaited`. Code of blocks
    /// that have changed in the meantime is dropped.
    #[cold]
    #[inline(never)]
    pub(super) fn install_compiled(&mut self, mut awaited: Option<u32>) {
        while let Some(jit) = &mut self.jit {
            if jit.is_exhausted() {
                self.invalidate_code();
                return;
            }
            let wait = awaited.is_some() && self.pending_regions != 0;
            let Some(region) = jit.next_compiled(wait) else {
                return;
            };
            awaited = awaited.filter(|&awaited| awaited != region);
            self.pending_regions -= 1;
            let numbers = self.regions.get(region as usize);
            let numbers = numbers.map(|numbers| &**numbers).unwrap_or_default();
            let has_code = jit.install(!numbers.is_empty());
            for &number in numbers {
                if let Some(block) = self.blocks.get_mut(number as usize) {
                    block.set_code(has_code);
                }
            }
        }
    }

    /// The block and those that it leads to, as far as they run often enough.
    fn hot_neighbourhood(&self, bus: &B, number: u32) -> Vec<RegionBlock> {
        let mut wanted = vec![number];
        let mut found: Vec<RegionBlock> = Vec::new();
        let mut next = 0;
        while let Some(&number) = wanted.get(next) {
            next += 1;
            let Some(block) = self.describe_block(bus, number) else {
                continue;
            };
            let targets = block.instructions.iter().filter_map(|one| one.target);
            let mut keys: Vec<u32> = targets.chain(block.next).map(|target| target.key).collect();
            keys.extend(self.blocks[number as usize].links.map(|link| link.0));
            found.push(block);
            for number in keys.into_iter().filter_map(|key| self.find(bus, key)) {
                if wanted.len() < BLOCKS_MAX && !wanted.contains(&number) && self.is_warm(number) {
                    wanted.push(number);
                }
            }
        }
        found
    }

    fn is_warm(&self, number: u32) -> bool {
        let jit = &self.blocks[number as usize].jit;
        let lately = self.entries.wrapping_sub(jit.counted_from) <= ENTRIES_MAX;
        let left_max = self.threshold_runs - self.threshold_runs / WARM_FRACTION;
        jit.region == NO_REGION && lately && (jit.runs_left <= left_max || jit.postponed_runs != 0)
    }

    /// The block as the compiler receives it; none where code would be of no use.
    fn describe_block(&self, bus: &B, number: u32) -> Option<RegionBlock> {
        let block = self.blocks.get(number as usize)?;
        if block.jit.region != NO_REGION {
            return None;
        }
        let place = bus.target_place(block.key & !1)?;
        let source = read_source(bus, block.key, place);
        let description = describe(bus, block, number, &source);
        let mut targets = description.instructions.iter().filter_map(|one| one.target);
        let is_idle_loop = block.is_idempotent && targets.any(|target| target.key == block.key);
        (!is_idle_loop).then_some(description)
    }

    /// Runs JIT code from a block on, then the operations behind its side exit. Number of the
    /// block that ran last; none when the budget ends there.
    pub(super) fn run_code(
        &mut self,
        run: &mut Run<'_, B>,
        number: u32,
        budget: u32,
    ) -> Option<u32> {
        let halfword = self.blocks.get(number as usize)?.jit.halfword;
        let (start_cycles, after_store) = (run.state.cycles, run.state.after_store);
        let (jit, ram) = (self.jit.as_mut()?, run.bus.ram_view()?);
        run.state.cycles_left = budget - start_cycles;
        run.state.after_store = NO_ADDRESS;
        let exit = jit.run(halfword, &mut run.state, ram);
        run.state.cycles = budget - run.state.cycles_left;
        let code_cycles = run.state.cycles - start_cycles;
        if code_cycles == 0 {
            run.state.after_store = after_store;
        }
        self.count_entry(number, code_cycles);
        if exit.operation == EXIT_BY_BRANCH {
            return Some(exit.block);
        }
        let block = self.blocks.get(exit.block as usize)?;
        if exit.operation == 0 && run.state.cycles + block.worst_cycles > budget {
            let left = budget - run.state.cycles;
            return block.run_part(run, left).then_some(exit.block);
        }
        block.execute_from(run, exit.operation as usize);
        Some(exit.block)
    }

    /// JIT code that is left again and again after a few cycles is not worth entering.
    #[inline(always)]
    fn count_entry(&mut self, number: u32, code_cycles: u32) {
        self.code_gain_cycles += i64::from(code_cycles) - i64::from(ENTRY_CYCLES);
        if let Some(block) = self.blocks.get_mut(number as usize) {
            let gain = code_cycles.min(LOSS_CYCLES_MAX as u32) as i32 - ENTRY_CYCLES;
            let sum = (i32::from(block.jit.gain_cycles) + gain).min(LOSS_CYCLES_MAX);
            block.jit.gain_cycles = sum as i16;
            block.set_code(sum > -LOSS_CYCLES_MAX);
        }
    }
}
