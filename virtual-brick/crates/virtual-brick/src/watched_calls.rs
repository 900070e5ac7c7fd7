// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Calls of some functions, each kind of call counted once: with which first argument, from where.

use std::collections::BTreeMap;

use crate::brick::VirtualBrick;
use crate::calls;
use crate::memory::ChipMemory;
use crate::threads::Memory;

/// Different calls that are kept at most.
const CALLS_MAX: usize = 256;

/// Calls of one function with one argument from one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WatchedCall {
    /// The function's symbol.
    pub function: String,
    /// Its first argument, r0.
    pub argument: u32,
    /// Symbols of the callers, innermost first.
    pub callers: Vec<String>,
    /// Source line of the call, `tasks.adb:57`; none without debug information.
    pub place: Option<String>,
    /// When it was called first and last.
    pub cycles: (u64, u64),
}

/// Function, argument and return address.
type Key = (u32, u32, u32);

#[derive(Clone, Debug)]
struct Seen {
    first_cycles: u64,
    last_cycles: u64,
    addresses: Vec<u32>,
}

/// What is watched, and what was seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct CallWatch {
    functions: Vec<u32>,
    seen: BTreeMap<Key, Seen>,
}

impl CallWatch {
    #[inline(always)]
    pub(crate) fn watches(&self, address: u32) -> bool {
        !self.functions.is_empty() && self.functions.contains(&address)
    }
}

impl VirtualBrick {
    /// Note the calls of these functions from now on; what the program does not have is left out.
    /// The run is the same.
    pub fn watch_calls(&mut self, functions: &[String]) {
        let found = functions
            .iter()
            .filter_map(|name| self.image.symbols().get(name));
        self.call_watch.functions = found.map(|symbol| symbol.address).collect();
        self.chip.observe_arrivals_at(&self.call_watch.functions);
    }

    /// The calls so far, in the order of the functions' addresses.
    #[must_use]
    pub fn watched_calls(&self) -> Vec<WatchedCall> {
        let symbol = |address| self.image.symbols().nearest_code(address);
        let name = |address| symbol(address).map_or_else(String::new, |(name, _)| name.to_owned());
        let told = |(&(function, argument, _), seen): (&Key, &Seen)| {
            let calls = calls::located(&self.image, &seen.addresses);
            WatchedCall {
                function: name(function),
                argument,
                callers: calls.iter().map(|call| call.symbol.clone()).collect(),
                place: calls::place_of_user(&calls),
                cycles: (seen.first_cycles, seen.last_cycles),
            }
        };
        self.call_watch.seen.iter().map(told).collect()
    }

    /// The next instruction is the first of a watched function.
    #[cold]
    pub(crate) fn note_call(&mut self) {
        let registers = self.cpu.registers();
        let [argument, .., link, function] = registers;
        let now = self.chip.now();
        let key = (function, argument, link);
        if let Some(seen) = self.call_watch.seen.get_mut(&key) {
            seen.last_cycles = now;
        } else if self.call_watch.seen.len() < CALLS_MAX {
            let memory = ChipMemory(&self.chip);
            let addresses = calls::addresses(&self.image, registers, |at| memory.word(at));
            let seen = Seen {
                first_cycles: now,
                last_cycles: now,
                addresses: addresses[1..].to_vec(),
            };
            self.call_watch.seen.insert(key, seen);
        }
    }
}
