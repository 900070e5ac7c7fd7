// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bus cycles by kind, counted or as `arm7tdmi::cost` states them.

use arm7tdmi::instruction::Operation;
use arm7tdmi::{condition_passes, cost::BusCycles, Cpu, Cycle, Instruction};

/// Bus cycles of one instruction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub code_nonsequential: u32,
    pub code_sequential: u32,
    pub data_nonsequential: u32,
    pub data_sequential: u32,
    pub internal: u32,
}

impl Counts {
    pub fn total(&self) -> u32 {
        self.code_nonsequential
            + self.code_sequential
            + self.data_nonsequential
            + self.data_sequential
            + self.internal
    }

    pub fn count_code(&mut self, cycle: Cycle) {
        match cycle {
            Cycle::Nonsequential => self.code_nonsequential += 1,
            Cycle::Sequential => self.code_sequential += 1,
        }
    }

    pub fn count_data(&mut self, cycle: Cycle) {
        match cycle {
            Cycle::Nonsequential => self.data_nonsequential += 1,
            Cycle::Sequential => self.data_sequential += 1,
        }
    }

    /// What the instruction should cost from this state, after one that did not store.
    pub fn stated(instruction: &Instruction, cpu: &Cpu) -> Self {
        let cycles = if condition_passes(instruction.condition, cpu.cpsr() >> 28) {
            instruction.cycles(cpu.profile())
        } else {
            return Self::of(BusCycles::SKIPPED, 0);
        };
        let internal = match instruction.operation {
            Operation::Multiply(product) => {
                let pipeline_offset = 3 * instruction.size;
                let multiplier = match product.multiplier {
                    15 => cpu.register(15).wrapping_add(pipeline_offset),
                    number => cpu.register(number),
                };
                let exact = product.kind.internal_cycles(multiplier);
                assert!((cycles.internal_min..=cycles.internal_max).contains(&exact));
                exact
            }
            _ => {
                assert_eq!(cycles.internal_min, cycles.internal_max);
                cycles.internal_max
            }
        };
        Self::of(cycles, internal)
    }

    fn of(cycles: BusCycles, internal: u32) -> Self {
        Self {
            code_nonsequential: cycles.refills,
            code_sequential: 1 + cycles.refills,
            data_nonsequential: cycles.reads.nonsequential + cycles.writes.nonsequential,
            data_sequential: cycles.reads.sequential + cycles.writes.sequential,
            internal,
        }
    }
}
