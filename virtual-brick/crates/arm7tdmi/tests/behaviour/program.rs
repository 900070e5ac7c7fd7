// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A short program with the core that runs it.

use crate::support::memory::Memory;
use arm7tdmi::{psr, Cpu, Mode, Step};

/// Address of a program's first opcode.
pub const START: u32 = 0x100;
/// Initial value of r4: where the programs find their data.
pub const DATA: u32 = 0x1000;
const ARM_NOP: u32 = 0xE1A0_8008;
const THUMB_NOP: u16 = 0x46C0;

/// Core and memory with the pipeline filled: the next step executes the opcode at `START`.
pub struct Program {
    pub cpu: Cpu,
    pub memory: Memory,
}

impl Program {
    /// ARM opcodes, supervisor mode, interrupts disabled.
    pub fn arm(opcodes: &[u32]) -> Self {
        let mut memory = Memory::with_arm(START - 4, &[ARM_NOP]);
        memory.put_words(START, opcodes);
        let mut cpu = Cpu::new();
        cpu.set_pc(START - 4);
        Self::filled(cpu, memory)
    }

    /// Thumb opcodes, supervisor mode, interrupts disabled.
    pub fn thumb(opcodes: &[u16]) -> Self {
        let with_nop: Vec<u16> = [THUMB_NOP].iter().chain(opcodes).copied().collect();
        let memory = Memory::with_thumb(START - 2, &with_nop);
        let mut cpu = Cpu::new();
        cpu.set_cpsr(cpu.cpsr() | psr::T);
        cpu.set_pc(START - 2);
        Self::filled(cpu, memory)
    }

    fn filled(mut cpu: Cpu, mut memory: Memory) -> Self {
        assert_eq!(cpu.step(&mut memory), Step::Instruction);
        cpu.set_register(4, DATA);
        memory.cycles = 0;
        Self { cpu, memory }
    }

    /// Sets a register of the current mode.
    pub fn with(mut self, number: u32, value: u32) -> Self {
        self.cpu.set_register(number, value);
        self
    }

    /// Sets words of memory.
    pub fn with_words(mut self, address: u32, words: &[u32]) -> Self {
        self.memory.put_words(address, words);
        self
    }

    /// Changes mode, keeping flags, masks and state.
    pub fn in_mode(mut self, mode: Mode) -> Self {
        let kept = self.cpu.cpsr() & !psr::MODE;
        self.cpu.set_cpsr(kept | mode.bits());
        self
    }

    /// Sets the condition codes.
    pub fn with_flags(mut self, flags: u32) -> Self {
        let kept = self.cpu.cpsr() & 0x0FFF_FFFF;
        self.cpu.set_cpsr(kept | flags);
        self
    }

    pub fn step(&mut self) -> Step {
        self.cpu.step(&mut self.memory)
    }

    /// Executes `steps` instructions and returns the program.
    pub fn after(mut self, steps: usize) -> Self {
        for _ in 0..steps {
            assert_eq!(self.step(), Step::Instruction);
        }
        self
    }

    /// Cycles that the next `steps` steps take.
    pub fn cycles(mut self, steps: usize) -> u64 {
        for _ in 0..steps {
            let _ = self.step();
        }
        self.memory.cycles
    }

    pub fn register(&self, number: u32) -> u32 {
        self.cpu.register(number)
    }

    /// Condition codes only.
    pub fn flags(&self) -> u32 {
        self.cpu.cpsr() & 0xF000_0000
    }
}
