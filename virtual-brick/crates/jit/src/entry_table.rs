// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where JIT code is entered, and where it is left.

/// An entry of the table, which has one for each halfword of code: the key of a block (its address,
/// with bit 0 for Thumb state), the cycles of the fetches after a branch to it, its index in its
/// region; the address of the region's code.
pub(crate) type Entry = [u64; 2];

/// Offsets in an entry, in bytes.
pub(crate) const KEY: i32 = 0;
pub(crate) const REFILL_CYCLES: i32 = 4;
pub(crate) const INDEX: i32 = 6;
pub(crate) const CODE: i32 = 8;

/// Key 0 would be found at each halfword without these bits.
const OF_ADDRESS_0: usize = 0x7FFF;
/// No branch has this target.
const NO_KEY: u64 = 2;

pub(crate) const fn entry(key: u32, refill_cycles: u16, index: u16, code: usize) -> Entry {
    let first = key as u64 | (refill_cycles as u64) << 32 | (index as u64) << 48;
    [first, code as u64]
}

/// The entry of a halfword at which no code begins.
pub(crate) const fn no_entry(halfword: usize) -> Entry {
    let key = if halfword & OF_ADDRESS_0 == 0 {
        NO_KEY
    } else {
        0
    };
    [key, 0]
}

/// A table without entries, whose memory is taken when it is used.
pub(crate) fn empty_table(halfwords: usize) -> Box<[Entry]> {
    let mut table = vec![[0; 2]; halfwords].into_boxed_slice();
    for halfword in (0..halfwords).step_by(OF_ADDRESS_0 + 1) {
        table[halfword] = no_entry(halfword);
    }
    table
}

/// An exit of the code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Exit {
    /// Number of the block.
    pub block: u32,
    /// Operation in front of which the code is left, or [`arm7tdmi::EXIT_BY_BRANCH`].
    pub operation: u32,
    /// Address of the next instruction; bit 0 tells Thumb state.
    pub next: u32,
    /// Cycles to take from those left.
    pub pending_cycles: u32,
    pub after_store: AfterStore,
}

/// The exits of a region; their numbers are those of its engine, which has others already.
#[derive(Debug)]
pub(crate) struct Exits {
    pub first: u32,
    pub exits: Vec<Exit>,
}

impl Exits {
    /// Number of an exit more.
    pub fn add(&mut self, exit: Exit) -> u32 {
        let number = self.first + self.exits.len() as u32;
        self.exits.push(exit);
        number
    }
}

/// Was the instruction executed last a store?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AfterStore {
    No,
    /// The store at an address.
    At(u32),
    /// The state tells.
    InState,
}
