// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Where code of the host is entered, and where it is left.

/// An entry of the table of places. Code reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Address of the block that is entered; bit 0 tells Thumb state.
    pub key: u32,
    /// Cycles of the fetches after a branch to it.
    pub refill_cycles: u16,
    /// Number of the block in its region.
    pub index: u16,
    /// Address of the region's code.
    pub code: usize,
}

/// No block has this address.
pub(crate) const NO_KEY: u32 = u32::MAX - 1;

impl Entry {
    pub const NONE: Self = Self {
        key: NO_KEY,
        refill_cycles: 0,
        index: 0,
        code: 0,
    };
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
