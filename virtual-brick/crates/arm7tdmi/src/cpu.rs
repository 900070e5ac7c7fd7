// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The core as its users see it: its state and access to it.

use crate::exception::Exception;
use crate::pipeline::Pipeline;
use crate::registers::{psr, Mode, RegisterFile};
use crate::timing::TimingProfile;

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// An instruction was executed, or skipped because its condition failed.
    Instruction,
    /// An exception was entered. Interrupts and prefetch aborts are steps of their own; the
    /// other exceptions end the instruction that raised them.
    Exception(Exception),
}

/// An ARM7TDMI core between two instructions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cpu {
    pub(crate) registers: RegisterFile,
    pub(crate) pipeline: Pipeline,
    pub(crate) profile: TimingProfile,
}

impl Default for Cpu {
    fn default() -> Self {
        Self::new()
    }
}

impl Cpu {
    /// A core just reset: supervisor mode, ARM state, interrupts disabled, next instruction at 0.
    pub const fn new() -> Self {
        Self::with_profile(TimingProfile::nominal())
    }

    /// A core just reset that follows the given timing choices.
    pub const fn with_profile(profile: TimingProfile) -> Self {
        let mut cpu = Self {
            registers: RegisterFile::new(),
            pipeline: Pipeline::empty(),
            profile,
        };
        cpu.registers = cpu.registers.with_pc(8);
        cpu
    }

    /// The timing choices in force.
    pub const fn profile(&self) -> TimingProfile {
        self.profile
    }

    /// r0 to r14 as the current mode sees them; entry 15 is the address of the next instruction.
    pub fn registers(&self) -> [u32; 16] {
        let mut registers = self.registers.visible();
        registers[15] = self.next_instruction_address();
        registers
    }

    /// One register as the current mode sees it; 15 is the address of the next instruction.
    /// Only the low four bits of `number` count.
    pub fn register(&self, number: u32) -> u32 {
        match number & 15 {
            15 => self.next_instruction_address(),
            number => self.registers.get(number),
        }
    }

    /// Writes one register of the current mode; 15 acts as [`Cpu::set_pc`].
    pub fn set_register(&mut self, number: u32, value: u32) {
        match number & 15 {
            15 => self.set_pc(value),
            number => self.registers.set(number, value),
        }
    }

    /// Register 0 to 14 as `mode` would see it, or for 15 the address of the next instruction.
    pub fn banked_register(&self, mode: Mode, number: u32) -> u32 {
        match number & 15 {
            15 => self.next_instruction_address(),
            number => self.registers.get_in(mode, number),
        }
    }

    /// Writes register 0 to 14 of `mode`; 15 acts as [`Cpu::set_pc`].
    pub fn set_banked_register(&mut self, mode: Mode, number: u32, value: u32) {
        match number & 15 {
            15 => self.set_pc(value),
            number => self.registers.set_in(mode, number, value),
        }
    }

    /// Address of the instruction that will execute next if no exception intervenes.
    #[inline]
    pub fn next_instruction_address(&self) -> u32 {
        self.registers.pc().wrapping_sub(self.pc_offset())
    }

    /// Continues at `address`, aligned for the current state. The next step starts with the two
    /// fetches that fill the pipeline.
    pub fn set_pc(&mut self, address: u32) {
        let offset = self.pc_offset();
        let aligned = address & !(offset / 2 - 1);
        self.registers.set_pc(aligned.wrapping_add(offset));
        self.pipeline = Pipeline::empty();
    }

    /// Distance between an instruction and the r15 it reads.
    #[inline]
    fn pc_offset(&self) -> u32 {
        if self.registers.status() & psr::T == 0 {
            8
        } else {
            4
        }
    }

    /// Current program status register.
    #[inline]
    pub fn cpsr(&self) -> u32 {
        self.registers.status()
    }

    /// Writes the whole CPSR from outside: the mode's bank comes into view at once; if the state
    /// bit changes, the next step refills the pipeline. Bits that do not exist are dropped.
    pub fn set_cpsr(&mut self, value: u32) {
        let next = self.next_instruction_address();
        let state_changes = (self.cpsr() ^ value) & psr::T != 0;
        self.registers.set_status(value & psr::IMPLEMENTED);
        if state_changes {
            self.set_pc(next);
        }
    }

    /// Saved program status register of the current mode; `None` in user and system mode.
    pub fn spsr(&self) -> Option<u32> {
        self.registers.saved_status()
    }

    /// Saved program status register of `mode`; `None` for user and system mode.
    pub fn spsr_of(&self, mode: Mode) -> Option<u32> {
        self.registers.saved_status_of(mode)
    }

    /// Writes the SPSR of `mode`; no effect for user and system mode.
    pub fn set_spsr_of(&mut self, mode: Mode, value: u32) {
        self.registers
            .set_saved_status_of(mode, value & psr::IMPLEMENTED);
    }

    /// Current mode; `None` while the mode field holds a value ARM leaves undefined.
    pub fn mode(&self) -> Option<Mode> {
        Mode::from_psr(self.cpsr())
    }

    /// True in Thumb state.
    pub fn thumb(&self) -> bool {
        self.cpsr() & psr::T != 0
    }
}
