// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The memory map with the cost of each kind of access. All numbers are an input: a chip's timing
//! profile is turned into this structure by whoever knows the chip.

use crate::error::Error;
use serde::{Deserialize, Serialize};

/// Cycles of opcode fetches of one width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FetchCost {
    /// At an address that does not follow the last fetch.
    pub first_cycles: u64,
    /// At the address after the last fetch.
    pub sequential_cycles: u64,
    /// The same where it begins a new word; differs for Thumb only.
    pub word_boundary_cycles: u64,
    /// Added to the fetch after a branch to the upper half of a word.
    pub odd_target_cycles: u64,
    /// Of a fetch at the address after the last one, when the bus did something else in between; at
    /// least what the fetch costs without.
    pub after_gap_cycles: u64,
}

/// One region of the memory map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Name, by which annotations refer to it.
    pub name: String,
    /// First address.
    pub start: u32,
    /// Last address.
    pub last: u32,
    /// A constant in the region is taken for an address: what is computed from it stays in the
    /// region. False where small numbers would be mistaken for addresses.
    pub holds_pointers: bool,
    /// ARM opcodes; none in a region without code.
    pub fetch_word: Option<FetchCost>,
    /// Thumb opcodes.
    pub fetch_halfword: Option<FetchCost>,
    /// One data read.
    pub read_cycles: u64,
    /// One data write.
    pub write_cycles: u64,
}

/// All regions, and which of them holds the stacks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryMap {
    /// What is analysed: the name of the timing profile and its parameters.
    pub name: String,
    /// Regions that do not overlap.
    pub regions: Vec<Region>,
    /// Name of the region with all stacks.
    pub stack: String,
}

impl MemoryMap {
    /// One region over all addresses in which each access takes a cycle.
    pub fn without_wait_states() -> Self {
        let fetch = FetchCost {
            first_cycles: 1,
            sequential_cycles: 1,
            word_boundary_cycles: 1,
            odd_target_cycles: 0,
            after_gap_cycles: 1,
        };
        Self {
            name: "no wait states".into(),
            regions: vec![Region {
                name: "memory".into(),
                start: 0,
                last: u32::MAX,
                holds_pointers: false,
                fetch_word: Some(fetch),
                fetch_halfword: Some(fetch),
                read_cycles: 1,
                write_cycles: 1,
            }],
            stack: "memory".into(),
        }
    }

    /// Index of the region with this name.
    pub fn find(&self, name: &str) -> Result<u8, Error> {
        let position = self.regions.iter().position(|region| region.name == name);
        position.map(|index| index as u8).ok_or_else(|| {
            let known: Vec<_> = self.regions.iter().map(|r| r.name.as_str()).collect();
            Error::Input(format!(
                "region '{name}' is not in the memory map '{}'; it has {}",
                self.name,
                known.join(", ")
            ))
        })
    }

    /// The region of an address.
    pub fn at(&self, address: u32) -> Option<u8> {
        let inside = |region: &Region| (region.start..=region.last).contains(&address);
        self.regions
            .iter()
            .position(inside)
            .map(|index| index as u8)
    }

    /// Cycles of one data access; in the worst region when the address is not known.
    pub fn data_cycles(&self, region: Option<u8>, write: bool) -> u64 {
        let cycles = |region: &Region| {
            if write {
                region.write_cycles
            } else {
                region.read_cycles
            }
        };
        match region {
            Some(index) => cycles(&self.regions[usize::from(index)]),
            None => self.regions.iter().map(cycles).max().unwrap_or(1),
        }
    }

    fn fetch_cost(&self, address: u32, thumb: bool) -> Result<FetchCost, Error> {
        let region = self
            .at(address)
            .map(|index| &self.regions[usize::from(index)]);
        let cost = region.and_then(|region| {
            if thumb {
                region.fetch_halfword
            } else {
                region.fetch_word
            }
        });
        cost.ok_or_else(|| {
            Error::Input(format!(
                "code at {address:#010x}, where the memory map '{}' has no fetches",
                self.name
            ))
        })
    }

    /// Cycles of a fetch at the address after the last one.
    pub fn sequential_fetch(&self, address: u32, thumb: bool) -> Result<u64, Error> {
        let cost = self.fetch_cost(address, thumb)?;
        Ok(if thumb && address & 2 == 0 {
            cost.word_boundary_cycles
        } else {
            cost.sequential_cycles
        })
    }

    /// What such a fetch costs more when the bus did something else in between; nothing where the
    /// map has no fetches.
    pub fn after_gap(&self, address: u32, thumb: bool) -> u64 {
        let cost = self
            .fetch_cost(address, thumb)
            .map(|cost| cost.after_gap_cycles);
        let sequential = self.sequential_fetch(address, thumb);
        match (cost, sequential) {
            (Ok(gap), Ok(regular)) => gap.saturating_sub(regular),
            _ => 0,
        }
    }

    /// Cycles of the two fetches after a branch to `target`.
    pub fn refill(&self, target: u32, thumb: bool) -> Result<u64, Error> {
        let cost = self.fetch_cost(target, thumb)?;
        let size = if thumb { 2 } else { 4 };
        let second = self.sequential_fetch(target.wrapping_add(size), thumb)?;
        let odd = if thumb && target & 2 != 0 {
            cost.odd_target_cycles
        } else {
            0
        };
        Ok(cost.first_cycles.max(cost.sequential_cycles) + second + odd)
    }

    /// The most expensive refill in the regions of these addresses.
    pub fn worst_refill(&self, regions: impl Iterator<Item = u32>) -> Result<u64, Error> {
        let mut worst = 0;
        for address in regions {
            for thumb in [false, true] {
                let upper = self.refill((address & !3) | if thumb { 2 } else { 0 }, thumb)?;
                worst = worst.max(upper).max(self.refill(address & !3, thumb)?);
            }
        }
        Ok(worst)
    }
}
