// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Running blocks, one after the other, as long as nothing else can act on the processor.

use super::block::Block;
use super::bus::BlockBus;
use super::cache::Blocks;
use super::operations::run::{opcodes, size_of, End, Run, ENDS_AT_ACCESS, NO_MASKS};
use super::state::{GuestState, NO_ADDRESS};
use crate::bus::Cycle;
use crate::cpu::Cpu;
use crate::pipeline::MASKS_DELAYED;
use crate::registers::psr;

/// The compiler is polled for finished regions so often, in entries.
const ENTRIES_PER_POLL: u32 = 32;

/// The outcome of a run of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlocksRun {
    /// Instructions were executed.
    pub ran: bool,
    /// A branch to itself was executed.
    pub branched_to_itself: bool,
    /// Address of the last instruction if it made an access through the bus: its effects must be
    /// looked at before the next instruction.
    pub accessed: Option<u32>,
}

impl Cpu {
    /// Runs blocks as long as the next certainly ends before `limit` and before anything can act on
    /// the processor. Runs none where no block can be entered, or for fewer than `min_cycles`. The
    /// caller asks [`Blocks::steps_of_reference`] after it.
    pub fn run_blocks<B: BlockBus>(
        &mut self,
        bus: &mut B,
        blocks: &mut Blocks<B>,
        limit: u64,
        min_cycles: u32,
    ) -> BlocksRun {
        let status = self.registers.status();
        let budget = bus.cycles_until_event(limit, status & psr::I == 0, status & psr::F == 0);
        if self.pipeline.attention != 0 || budget < min_cycles {
            return BlocksRun::default();
        }
        if !blocks.update(bus) {
            return BlocksRun::default();
        }
        let start = self.next_instruction_address() | u32::from(self.thumb());
        let Some(place) = bus
            .code_place(start & !1)
            .filter(|_| bus.can_enter(start & !1))
        else {
            return BlocksRun::default();
        };
        let Some(first) = blocks.find_or_translate(bus, start, place) else {
            return BlocksRun::default();
        };
        if blocks.is_likely_refused(first) || !self.pipeline_holds_code(bus, start, place.memory) {
            return BlocksRun::default();
        }
        blocks.entries = blocks.entries.wrapping_add(1);
        if blocks.pending_regions != 0 && blocks.entries % ENTRIES_PER_POLL == 0 {
            blocks.install_compiled(None);
        }
        let mut run = self.begin_run(bus, start, place.memory, (budget, limit));
        execute(&mut run, blocks, first);
        let done = run.finish();
        let code_gain_cycles = std::mem::take(&mut blocks.code_gain_cycles);
        blocks.budget.earn(run.passed_cycles, code_gain_cycles);
        blocks.note_refusal(first, run.end == End::Refused && !done.ran);
        if done.ran {
            let aborted = run.end == End::Aborted;
            run.store_status();
            let (next, after_store) = (run.state.next, run.state.after_store);
            let (fetched, delayed) = (run.fetched, run.delayed);
            self.end_run(bus, next, after_store, fetched);
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
    fn pipeline_holds_code<B: BlockBus>(&self, bus: &B, key: u32, memory: u8) -> bool {
        let (address, size) = (key & !1, size_of(key));
        let ahead = address.wrapping_add(2 * size);
        address % size == 0
            && bus.in_sequence(ahead)
            && bus.code_place(ahead).map(|place| place.memory) == Some(memory)
            && self.pipeline.opcodes == opcodes(bus, key)
    }

    fn begin_run<'a, B: BlockBus>(
        &'a mut self,
        bus: &'a mut B,
        next: u32,
        memory: u8,
        (budget, limit): (u32, u64),
    ) -> Run<'a, B> {
        let mut run = Run {
            state: GuestState {
                registers: self.registers.visible(),
                next,
                after_store: NO_ADDRESS,
                ..GuestState::default()
            },
            end: End::Reached,
            ran: false,
            passed_cycles: 0,
            limit,
            budget,
            worst_cycles: ENDS_AT_ACCESS,
            told_cycles: 0,
            outside_ram_at: 0,
            reads_steadily: true,
            fetched: None,
            delayed: NO_MASKS,
            delays_masks: self.profile.mask_change_delayed,
            branched_to_itself: false,
            memory,
            file: &mut self.registers,
            bus,
        };
        run.load_flags();
        run
    }

    fn end_run<B: BlockBus>(
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

impl<B: BlockBus> Run<'_, B> {
    /// Tells the bus the time, and the caller what was done.
    fn finish(&mut self) -> BlocksRun {
        if self.state.cycles != 0 {
            self.pass(self.state.cycles);
            self.delayed = NO_MASKS;
        }
        let size = size_of(self.state.next);
        BlocksRun {
            ran: self.ran,
            branched_to_itself: self.branched_to_itself,
            accessed: matches!(self.end, End::Accessed | End::Aborted)
                .then(|| (self.state.next & !1).wrapping_sub(size)),
        }
    }

    /// The rest of the budget passes in iterations of a loop that finds the same state each time.
    #[inline(never)]
    fn skip_idle_iterations(&mut self, block: &Block<B>, start_cycles: u32) -> bool {
        let budget = self.budget;
        let once = self.state.cycles - start_cycles;
        let again = block.key == self.state.next && once != 0;
        if !again || self.state.cycles + block.worst_cycles > budget {
            return false;
        }
        let times = (budget - block.worst_cycles - self.state.cycles) / once + 1;
        self.state.cycles += times * once;
        true
    }

    /// After an access that can change memory: the pipeline still holds what memory holds.
    #[inline(never)]
    fn pipeline_still_valid(&mut self, blocks: &mut Blocks<B>) -> bool {
        let ahead = (self.state.next & !1).wrapping_add(2 * size_of(self.state.next));
        let same = self.fetched == Some(opcodes(self.bus, self.state.next));
        if !same || !self.bus.in_sequence(ahead) || self.bus.code_epoch() != blocks.epoch {
            return false;
        }
        self.fetched = None;
        blocks.update(self.bus)
    }

    /// Finds the cycles until the next event, after an access through the bus or with other masks.
    /// False when there are none or the caller must look first.
    #[inline(never)]
    fn renew_budget(&mut self, blocks: &mut Blocks<B>) -> bool {
        match self.end {
            End::Accessed => {
                self.delayed = NO_MASKS;
                if self.bus.needs_attention()
                    || self.fetched.is_some() && !self.pipeline_still_valid(blocks)
                {
                    return false;
                }
            }
            End::Status => self.pass(self.state.cycles),
            End::Aborted => {
                self.delayed = NO_MASKS;
                return false;
            }
            End::Reached | End::Refused => return false,
        }
        self.budget = self.cycles_until_event();
        if self.budget == 0 {
            return false;
        }
        self.end = End::Reached;
        true
    }
}

#[inline(never)]
fn execute<B: BlockBus>(run: &mut Run<'_, B>, blocks: &mut Blocks<B>, first: u32) {
    let mut number = first;
    let counted_after = blocks.counted_after_cycles;
    loop {
        let Some(mut block) = blocks.blocks.get_mut(number as usize) else {
            return;
        };
        let since_outside = run.state.cycles.wrapping_sub(run.outside_ram_at);
        let counted = u16::from(since_outside >= counted_after);
        block.jit.runs_left = block.jit.runs_left.wrapping_sub(counted);
        if block.jit.runs_left != 0 && run.state.cycles + block.simply_run_cycles <= run.budget {
            run.worst_cycles = block.worst_cycles;
            block.execute(run);
        } else {
            let Some(last) = run_otherwise(run, blocks, number) else {
                return;
            };
            number = last;
            block = match blocks.blocks.get_mut(number as usize) {
                Some(block) => block,
                None => return,
            };
        }
        let next = run.state.next;
        let link = block.link(next);
        if run.end != End::Reached && !run.renew_budget(blocks) {
            return;
        }
        number = if blocks.is_valid(link, next) {
            link
        } else {
            match blocks.successor(run.bus, number, next, run.memory) {
                Some(found) => found,
                None => return,
            }
        };
    }
}

/// Runs as much of the block of this number as the budget allows, or its JIT code, or asks the
/// compiler for it, or skips what would only find the same state again. Number of the block that
/// ran last; none when the budget ends.
#[inline(never)]
fn run_otherwise<B: BlockBus>(
    run: &mut Run<'_, B>,
    blocks: &mut Blocks<B>,
    number: u32,
) -> Option<u32> {
    let (budget, start_cycles) = (run.budget, run.state.cycles);
    run.worst_cycles = ENDS_AT_ACCESS;
    let mut block = blocks.blocks.get_mut(number as usize)?;
    if start_cycles + block.worst_cycles > budget {
        block.jit.runs_left = block.jit.runs_left.max(1);
        return block.run_part(run, budget - start_cycles).then_some(number);
    }
    if block.jit.has_code {
        return blocks.run_code(run, number, budget);
    }
    if block.jit.runs_left == 0 {
        blocks.poll_compiler(run.bus, number);
        block = blocks.blocks.get_mut(number as usize)?;
    }
    run.reads_steadily = true;
    block.execute(run);
    if !run.reads_steadily {
        block.never_idles();
    }
    let idle = block.is_idempotent && run.end == End::Reached;
    (!idle || !run.skip_idle_iterations(block, start_cycles)).then_some(number)
}
