// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Endless loops of several instructions: with both interrupts masked, a copy of the core runs
//! ahead on read-only memory. If its state repeats, it repeats for ever.
//!
//! The check is made at samples of signals, which both engines take at the same instruction
//! boundary, and ever more rarely as long as interrupts stay masked.

use arm7tdmi::{psr, Abort, BlockBus, Bus, Cpu, Cycle, Width};

use crate::assembly::Machine;

/// Longest loop that is found, in instructions.
const STEPS_MAX: u32 = 10_000;

/// Schedule of the checks.
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
        self.masked_samples.is_power_of_two() && state_repeats(cpu, chip)
    }
}

fn state_repeats(cpu: &Cpu, chip: &Machine) -> bool {
    let mut ahead = cpu.clone();
    let mut bus = ReadOnlyBus {
        chip,
        refused: chip.data_controller_writes(),
    };
    for _ in 0..STEPS_MAX {
        ahead.step(&mut bus);
        if bus.refused {
            return false;
        }
        if ahead == *cpu {
            return true;
        }
    }
    false
}

/// Memory to read, without time and without peripherals.
struct ReadOnlyBus<'a> {
    chip: &'a Machine,
    /// Something other than memory was accessed, or memory was written.
    refused: bool,
}

impl ReadOnlyBus<'_> {
    fn opcode(&mut self, address: u32) -> u32 {
        if self.chip.target_place(address).is_some() {
            return self.chip.code_word(address);
        }
        self.refused = true;
        0
    }
}

impl Bus for ReadOnlyBus<'_> {
    fn fetch_word(&mut self, address: u32, _: Cycle) -> Result<u32, Abort> {
        Ok(self.opcode(address))
    }

    fn fetch_halfword(&mut self, address: u32, _: Cycle) -> Result<u16, Abort> {
        Ok((self.opcode(address) >> (8 * (address & 2))) as u16)
    }

    fn read(&mut self, address: u32, width: Width, _: Cycle) -> Result<u32, Abort> {
        let read = self.chip.plain_read(address, width);
        self.refused |= read.is_none();
        Ok(read.map_or(0, |read| read.value))
    }

    fn write(&mut self, _: u32, _: Width, _: u32, _: Cycle) -> Result<(), Abort> {
        self.refused = true;
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
