// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A path through a function and all that it calls, by instructions and calls.

use std::collections::BTreeMap;

/// All executions of a function on a path that were called at one place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PathTree {
    /// The function.
    pub entry: u32,
    /// Its executions.
    pub calls: u64,
    /// Executions and cycles of its instructions, without calls.
    pub instructions: BTreeMap<u32, (u64, u64)>,
    /// Functions that it calls, by the address of the call and their entry.
    pub callees: BTreeMap<(u32, u32), PathTree>,
    /// Cycles beyond those of instructions and calls that facts add, or below them.
    pub difference: i64,
}

impl PathTree {
    /// A function that is not executed so far.
    pub fn new(entry: u32) -> Self {
        Self {
            entry,
            ..Self::default()
        }
    }

    /// One call of which only the cycles are known.
    pub fn without_steps(entry: u32, cycles: u64) -> Self {
        Self {
            calls: 1,
            difference: cycles as i64,
            ..Self::new(entry)
        }
    }

    /// Cycles of all executions with all that they call.
    pub fn cycles(&self) -> u64 {
        let own: u64 = self.instructions.values().map(|(_, cycles)| cycles).sum();
        let called: u64 = self.callees.values().map(Self::cycles).sum();
        (own + called).wrapping_add_signed(self.difference)
    }

    /// Adds executions of an instruction.
    pub fn add_instruction(&mut self, address: u32, executions: u64, cycles: u64) {
        let known = self.instructions.entry(address).or_default();
        known.0 += executions;
        known.1 += cycles;
    }

    /// What is called at an address.
    pub fn callee(&mut self, address: u32, entry: u32) -> &mut Self {
        let place = self.callees.entry((address, entry));
        place.or_insert_with(|| Self::new(entry))
    }

    /// Adds the executions of a tree of the same function, `times` times.
    pub fn add(&mut self, other: &Self, times: u64) {
        self.calls += other.calls * times;
        self.difference += other.difference * times as i64;
        for (address, (executions, cycles)) in &other.instructions {
            self.add_instruction(*address, executions * times, cycles * times);
        }
        for ((address, entry), called) in &other.callees {
            self.callee(*address, *entry).add(called, times);
        }
    }
}
