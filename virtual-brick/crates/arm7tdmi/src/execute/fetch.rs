// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Opcode fetches: ahead of each instruction, and at the target of a branch.

use crate::bus::{Abort, Bus, Cycle};
use crate::cpu::{Cpu, Step};
use crate::pipeline::{DECODE_ABORTED, EXECUTE_ABORTED};
use crate::registers::psr;

/// Executes one instruction, after its condition passed and its first fetch was made.
pub(super) type Handler<B> = fn(&mut Cpu, &mut B, u32) -> Step;

impl Cpu {
    /// First cycle of an ARM instruction: fetch the opcode two ahead, shift the pipeline.
    #[inline(always)]
    pub(super) fn fetch_ahead_arm<B: Bus>(&mut self, bus: &mut B) -> u32 {
        let fetched = bus.fetch_word(self.registers.pc(), self.pipeline.next_fetch);
        self.shift_in(fetched)
    }

    /// First cycle of a Thumb instruction: fetch the opcode two ahead, shift the pipeline.
    #[inline(always)]
    pub(super) fn fetch_ahead_thumb<B: Bus>(&mut self, bus: &mut B) -> u32 {
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
    pub(super) fn fetch_and_discard<B: Bus>(&mut self, bus: &mut B) {
        let (address, cycle) = (self.registers.pc(), self.pipeline.next_fetch);
        if self.registers.status() & psr::T == 0 {
            let _ = bus.fetch_word(address, cycle);
        } else {
            let _ = bus.fetch_halfword(address, cycle);
        }
    }

    /// Continues at `target` in the current state: one N and one S fetch.
    #[inline]
    pub(super) fn branch<B: Bus>(&mut self, bus: &mut B, target: u32) {
        if self.registers.status() & psr::T == 0 {
            self.branch_arm(bus, target);
        } else {
            self.branch_thumb(bus, target);
        }
    }

    /// Continues at the word address `target` in ARM state.
    #[inline]
    pub(super) fn branch_arm<B: Bus>(&mut self, bus: &mut B, target: u32) {
        let target = target & !3;
        let first = bus.fetch_word(target, Cycle::Nonsequential);
        let second = bus.fetch_word(target.wrapping_add(4), Cycle::Sequential);
        self.registers.set_pc(target.wrapping_add(8));
        self.fill(first, second);
    }

    /// Continues at the halfword address `target` in Thumb state.
    #[inline]
    pub(super) fn branch_thumb<B: Bus>(&mut self, bus: &mut B, target: u32) {
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
    pub(super) fn refill<B: Bus>(&mut self, bus: &mut B) {
        self.branch(bus, self.next_instruction_address());
    }

    /// Steps r15 over an ARM instruction; later reads of r15 see the address + 12.
    #[inline(always)]
    pub(super) fn advance_arm(&mut self) {
        let next = self.registers.pc().wrapping_add(4);
        self.registers.set_pc(next);
    }

    /// Steps r15 over a Thumb instruction; later reads of r15 see the address + 6.
    #[inline(always)]
    pub(super) fn advance_thumb(&mut self) {
        let next = self.registers.pc().wrapping_add(2);
        self.registers.set_pc(next);
    }

    /// Tells the memory that the fetch after a data write does not follow the last address.
    #[inline(always)]
    pub(super) fn next_fetch_is_nonsequential(&mut self) {
        self.pipeline.next_fetch = Cycle::Nonsequential;
    }

    /// Writes the result of an instruction; r15 as destination is a branch in the current state.
    #[inline(always)]
    pub(super) fn write_result<B: Bus>(&mut self, bus: &mut B, number: u32, value: u32) -> Step {
        if number & 15 == 15 {
            self.branch(bus, value);
        } else {
            self.registers.set(number, value);
        }
        Step::Instruction
    }
}
