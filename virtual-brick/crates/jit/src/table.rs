// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where code of the host is entered, and where it is left.

/// An entry of the table of places, which code reads: the address of a block with its state in bit
/// 0, the cycles of the fetches after a branch to it, its number in its region; the address of the
/// region's code.
pub(crate) type Entry = [u64; 2];

/// Offsets in an entry, in bytes.
pub(crate) const KEY: i32 = 0;
pub(crate) const REFILL_CYCLES: i32 = 4;
pub(crate) const INDEX: i32 = 6;
pub(crate) const CODE: i32 = 8;

/// Where key 0 would be found.
const OF_ADDRESS_0: usize = 0x7FFF;
/// No branch has this target.
const NO_KEY: u64 = 2;

pub(crate) const fn entry(key: u32, refill_cycles: u16, index: u16, code: usize) -> Entry {
    let first = key as u64 | (refill_cycles as u64) << 32 | (index as u64) << 48;
    [first, code as u64]
}

/// In place of an entry at this place of the table.
pub(crate) const fn no_entry(place: usize) -> Entry {
    [if place & OF_ADDRESS_0 == 0 { NO_KEY } else { 0 }, 0]
}

/// A table without entries, whose memory is taken when it is used.
pub(crate) fn no_entries(places: usize) -> Box<[Entry]> {
    let mut table = vec![[0; 2]; places].into_boxed_slice();
    for place in (0..places).step_by(OF_ADDRESS_0 + 1) {
        table[place] = no_entry(place);
    }
    table
}

/// How code is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Exit {
    /// Number of the block.
    pub block: u32,
    /// Operation before which it is left, or [`arm7tdmi::BRANCHED`].
    pub operation: u32,
    /// Address to go on at; bit 0 tells Thumb state.
    pub next: u32,
    /// Cycles to take from those left.
    pub pending_cycles: u32,
    pub after_store: AfterStore,
}

/// What was executed last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AfterStore {
    /// No store.
    Not,
    /// The store at an address.
    At(u32),
    /// The state tells.
    Told,
}
