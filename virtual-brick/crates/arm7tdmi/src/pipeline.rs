// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The three-stage pipeline as software sees it: two opcodes fetched ahead of the one executed.

use crate::bus::{Abort, Bus, Cycle};
use crate::cpu::Cpu;
use crate::registers::psr;

/// The pipeline must be filled from r15 before the next instruction.
pub(crate) const REFILL: u8 = 1 << 0;
/// The opcode to be executed next was aborted when it was fetched.
pub(crate) const EXECUTE_ABORTED: u8 = 1 << 1;
/// The opcode after it was aborted when it was fetched.
pub(crate) const DECODE_ABORTED: u8 = 1 << 2;
/// The next boundary uses the interrupt masks from before an MSR.
pub(crate) const MASKS_DELAYED: u8 = 1 << 3;

/// Opcodes in the decode and fetch stages, and what the next boundary has to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pipeline {
    /// The opcode executed next and the one after it.
    pub(crate) opcodes: [u32; 2],
    /// Kind of the fetch that starts the next instruction.
    pub(crate) next_fetch: Cycle,
    /// Set of the constants above; zero on the usual path.
    pub(crate) attention: u8,
    /// Status register whose masks count while `MASKS_DELAYED` is set; otherwise zero.
    pub(crate) delayed_masks: u32,
}

impl Pipeline {
    pub(crate) const fn empty() -> Self {
        Self {
            opcodes: [0; 2],
            next_fetch: Cycle::Sequential,
            attention: REFILL,
            delayed_masks: 0,
        }
    }
}

impl Cpu {
    /// First cycle of an ARM instruction: fetch the opcode two ahead, shift the pipeline.
    #[inline(always)]
    pub(crate) fn fetch_ahead_arm<B: Bus>(&mut self, bus: &mut B) -> u32 {
        let fetched = bus.fetch_word(self.registers.pc(), self.pipeline.next_fetch);
        self.shift_in(fetched)
    }

    /// First cycle of a Thumb instruction: fetch the opcode two ahead, shift the pipeline.
    #[inline(always)]
    pub(crate) fn fetch_ahead_thumb<B: Bus>(&mut self, bus: &mut B) -> u32 {
        let fetched = bus.fetch_halfword(self.registers.pc(), self.pipeline.next_fetch);
        self.shift_in(fetched.map(u32::from))
    }

    #[inline(always)]
    fn shift_in(&mut self, fetched: Result<u32, Abort>) -> u32 {
        let opcode = self.pipeline.opcodes[0];
        self.pipeline.opcodes[0] = self.pipeline.opcodes[1];
        self.pipeline.next_fetch = Cycle::Sequential;
        match fetched {
            Ok(fetched) => self.pipeline.opcodes[1] = fetched,
            Err(Abort) => self.mark_fetch_aborted(),
        }
        opcode
    }

    #[cold]
    #[inline(never)]
    fn mark_fetch_aborted(&mut self) {
        self.pipeline.opcodes[1] = 0;
        self.pipeline.attention |= DECODE_ABORTED;
    }

    /// The fetch at the start of an exception entry, whose opcode nobody uses.
    pub(crate) fn fetch_and_discard<B: Bus>(&mut self, bus: &mut B) {
        let (address, cycle) = (self.registers.pc(), self.pipeline.next_fetch);
        if self.registers.status() & psr::T == 0 {
            let _ = bus.fetch_word(address, cycle);
        } else {
            let _ = bus.fetch_halfword(address, cycle);
        }
    }

    /// Continues at `target` in the current state: one N and one S fetch.
    #[inline]
    pub(crate) fn branch<B: Bus>(&mut self, bus: &mut B, target: u32) {
        if self.registers.status() & psr::T == 0 {
            self.branch_arm(bus, target);
        } else {
            self.branch_thumb(bus, target);
        }
    }

    /// Continues at the word address `target` in ARM state.
    #[inline]
    pub(crate) fn branch_arm<B: Bus>(&mut self, bus: &mut B, target: u32) {
        let target = target & !3;
        let first = bus.fetch_word(target, Cycle::Nonsequential);
        let second = bus.fetch_word(target.wrapping_add(4), Cycle::Sequential);
        self.registers.set_pc(target.wrapping_add(8));
        self.fill(first, second);
    }

    /// Continues at the halfword address `target` in Thumb state.
    #[inline]
    pub(crate) fn branch_thumb<B: Bus>(&mut self, bus: &mut B, target: u32) {
        let target = target & !1;
        let first = bus.fetch_halfword(target, Cycle::Nonsequential);
        let second = bus.fetch_halfword(target.wrapping_add(2), Cycle::Sequential);
        self.registers.set_pc(target.wrapping_add(4));
        self.fill(first.map(u32::from), second.map(u32::from));
    }

    #[inline(always)]
    fn fill(&mut self, first: Result<u32, Abort>, second: Result<u32, Abort>) {
        self.pipeline.opcodes = [first.unwrap_or(0), second.unwrap_or(0)];
        self.pipeline.next_fetch = Cycle::Sequential;
        let mut attention = 0;
        if first.is_err() {
            attention |= EXECUTE_ABORTED;
        }
        if second.is_err() {
            attention |= DECODE_ABORTED;
        }
        self.pipeline.attention = attention;
    }

    /// Fills the pipeline after `set_pc` or reset.
    pub(crate) fn refill<B: Bus>(&mut self, bus: &mut B) {
        self.branch(bus, self.next_instruction_address());
    }

    /// Steps r15 over an ARM instruction; later reads of r15 see the address + 12.
    #[inline(always)]
    pub(crate) fn advance_arm(&mut self) {
        let next = self.registers.pc().wrapping_add(4);
        self.registers.set_pc(next);
    }

    /// Steps r15 over a Thumb instruction; later reads of r15 see the address + 6.
    #[inline(always)]
    pub(crate) fn advance_thumb(&mut self) {
        let next = self.registers.pc().wrapping_add(2);
        self.registers.set_pc(next);
    }

    /// Tells the memory that the fetch after a data write does not follow the last address.
    #[inline(always)]
    pub(crate) fn next_fetch_is_nonsequential(&mut self) {
        self.pipeline.next_fetch = Cycle::Nonsequential;
    }
}
