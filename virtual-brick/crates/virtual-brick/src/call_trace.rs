// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Calls of chosen functions, each combination of function, first argument and caller once.

use std::collections::BTreeMap;

use crate::backtrace;
use crate::brick::VirtualBrick;
use crate::memory::ChipMemory;
use crate::threads::Memory;

/// Most different calls that are kept.
const CALLS_MAX: usize = 256;

/// Calls of one function with one argument from one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TracedCall {
    /// The function's symbol.
    pub function: String,
    /// Its first argument, r0.
    pub argument: u32,
    /// Symbols of the callers, innermost first.
    pub callers: Vec<String>,
    /// Addresses of the calls, innermost first, for [`VirtualBrick::call_place`].
    pub addresses: Vec<u32>,
    /// When it was called first and last.
    pub cycles: (u64, u64),
}

/// Function, argument and return address.
type Key = (u32, u32, u32);

#[derive(Clone, Debug)]
struct Times {
    first_cycles: u64,
    last_cycles: u64,
    addresses: Vec<u32>,
}

/// The chosen functions and their calls so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct CallTrace {
    functions: Vec<u32>,
    seen: BTreeMap<Key, Times>,
}

impl CallTrace {
    /// Some function is traced.
    pub(crate) fn is_active(&self) -> bool {
        !self.functions.is_empty()
    }

    pub(crate) fn traces(&self, address: u32) -> bool {
        self.functions.contains(&address)
    }
}

impl VirtualBrick {
    /// Record the calls of these functions from now on; functions that the program does not have
    /// are left out. The run stays the same.
    pub fn trace_calls(&mut self, functions: &[String]) {
        let found = functions
            .iter()
            .filter_map(|name| self.image.symbols().get(name));
        self.call_trace.functions = found.map(|symbol| symbol.address).collect();
        self.observe_arrivals();
    }

    /// What is traced or counted is a step of its own; blocks that contain it are forgotten.
    pub(crate) fn observe_arrivals(&mut self) {
        let traced = self.call_trace.functions.iter().copied();
        let addresses: Vec<u32> = traced.chain(self.flow_counts.addresses()).collect();
        self.chip.observe_arrivals_at(addresses);
        self.blocks = self.blocks.new_like();
    }

    /// The calls so far, in the order of the functions' addresses.
    #[must_use]
    pub fn traced_calls(&self) -> Vec<TracedCall> {
        let symbol = |address| self.image.symbols().nearest_code(address);
        let name = |address| symbol(address).map_or_else(String::new, |(name, _)| name.to_owned());
        let described = |(&(function, argument, _), seen): (&Key, &Times)| {
            let callers = seen.addresses.iter().filter_map(|&address| symbol(address));
            TracedCall {
                function: name(function),
                argument,
                callers: callers.map(|(name, _)| name.to_owned()).collect(),
                addresses: seen.addresses.clone(),
                cycles: (seen.first_cycles, seen.last_cycles),
            }
        };
        self.call_trace.seen.iter().map(described).collect()
    }

    /// Source line of the innermost of these calls outside of run-time and drivers,
    /// `tasks.adb:57`; none without debug information. The first call of this reads all lines.
    #[must_use]
    pub fn call_place(&self, addresses: &[u32]) -> Option<String> {
        backtrace::user_place(&backtrace::located(&self.image, addresses))
    }

    /// Record a call: the next instruction is the first of a traced function.
    #[cold]
    pub(crate) fn record_call(&mut self) {
        let registers = self.cpu.registers();
        let [argument, .., link, function] = registers;
        let now = self.chip.now();
        let key = (function, argument, link);
        if let Some(seen) = self.call_trace.seen.get_mut(&key) {
            seen.last_cycles = now;
        } else if self.call_trace.seen.len() < CALLS_MAX {
            let memory = ChipMemory(&self.chip);
            let addresses = backtrace::addresses(&self.image, registers, |at| memory.word(at));
            let seen = Times {
                first_cycles: now,
                last_cycles: now,
                addresses: addresses[1..].to_vec(),
            };
            self.call_trace.seen.insert(key, seen);
        }
    }
}
