// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loops of several instructions that nothing leaves: with both interrupts masked, a copy of the
//! core is run ahead on memory that it only reads. If its state comes back, it always will.
//!
//! The look is taken at samples of signals, which both engines make at the same instruction
//! boundary, and ever more rarely as long as interrupts stay masked.

use arm7tdmi::{psr, Abort, BlockBus, Bus, Cpu, Cycle, Width};

use crate::assembly::Machine;

/// A loop of more instructions is not found.
const STEPS_MOST: u32 = 10_000;

/// When to look.
#[derive(Clone, Debug, Default)]
pub(crate) struct EndlessLoops {
    /// Samples in a row at which interrupts were masked.
    masked_samples: u64,
}

impl EndlessLoops {
    /// At a sample: does the core loop for ever?
    pub(crate) fn at_sample(&mut self, cpu: &Cpu, chip: &Machine) -> bool {
        let masked = cpu.cpsr() & (psr::I | psr::F) == psr::I | psr::F;
        if !masked || chip.processor_stopped() {
            self.masked_samples = 0;
            return false;
        }
        self.masked_samples += 1;
        self.masked_samples.is_power_of_two() && comes_back(cpu, chip)
    }
}

fn comes_back(cpu: &Cpu, chip: &Machine) -> bool {
    let mut ahead = cpu.clone();
    let mut bus = Frozen {
        chip,
        left: chip.data_controller_writes(),
    };
    for _ in 0..STEPS_MOST {
        ahead.step(&mut bus);
        if bus.left {
            return false;
        }
        if ahead == *cpu {
            return true;
        }
    }
    false
}

/// Memory without time and without anything else on the bus.
struct Frozen<'a> {
    chip: &'a Machine,
    /// Something else than memory was accessed, or it was written.
    left: bool,
}

impl Frozen<'_> {
    fn opcode(&mut self, address: u32) -> u32 {
        if self.chip.target_place(address).is_some() {
            return self.chip.code_word(address);
        }
        self.left = true;
        0
    }
}

impl Bus for Frozen<'_> {
    fn fetch_word(&mut self, address: u32, _cycle: Cycle) -> Result<u32, Abort> {
        Ok(self.opcode(address))
    }

    fn fetch_halfword(&mut self, address: u32, _cycle: Cycle) -> Result<u16, Abort> {
        Ok((self.opcode(address) >> (8 * (address & 2))) as u16)
    }

    fn read(&mut self, address: u32, width: Width, _cycle: Cycle) -> Result<u32, Abort> {
        let read = self.chip.plain_read(address, width);
        self.left |= read.is_none();
        Ok(read.map_or(0, |read| read.value))
    }

    fn write(&mut self, _: u32, _: Width, _: u32, _: Cycle) -> Result<(), Abort> {
        self.left = true;
        Ok(())
    }

    fn internal(&mut self, _count: u32) {}

    fn irq(&self) -> bool {
        false
    }

    fn fiq(&self) -> bool {
        false
    }
}
