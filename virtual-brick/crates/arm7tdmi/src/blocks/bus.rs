// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a bus offers besides its accesses so that code can run from decoded blocks.

use crate::bus::{Bus, Width};

/// Where code lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodePlace {
    /// Number of the halfword among all halfwords that can hold code, below
    /// [`BlockBus::CODE_HALFWORDS`]. Appearances of one memory at several addresses share it.
    pub halfword: u32,
    /// Memory that it belongs to; costs of fetches are uniform rules within one.
    pub region: u8,
}

/// A data read that only reads memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainRead {
    /// As [`Bus::read`] returns it.
    pub value: u32,
    /// Cycles of the access.
    pub cycles: u32,
}

/// Words that lie one after the other in memory.
pub struct PlainWords<W> {
    /// The words.
    pub words: W,
    /// Cycles of the access to each.
    pub cycles: u32,
}

/// A bus whose code memories can be decoded ahead of execution.
///
/// Costs are in cycles of the processor clock and hold until [`BlockBus::code_epoch`] changes or
/// something happens that a plain access does not do.
pub trait BlockBus: Bus {
    /// Number of halfwords that can hold code.
    const CODE_HALFWORDS: u32;

    /// Where the code at `address` lies; none where no block may be.
    fn code_place(&self, address: u32) -> Option<CodePlace>;
    /// The word that a fetch at `address` would bring, without the fetch. Called only for
    /// addresses that have a place.
    fn code_word(&self, address: u32) -> u32;
    /// Changes with everything that makes all decoded code or its costs void.
    fn code_epoch(&self) -> u32;
    /// Report the next change of the word at `address` through [`BlockBus::next_code_change`].
    fn mark_code(&mut self, address: u32);
    /// Halfword number (even) of a marked word that was written, once per write of each.
    fn next_code_change(&mut self) -> Option<u32>;

    /// Cycles of the opcode fetch at `address` that continues the fetch before it.
    fn sequential_fetch_cycles(&self, address: u32, width: Width) -> u32;
    /// Cycles of the two fetches that fill the pipeline at `target`, when a fetch at `sequence`
    /// would have continued the last one. Both lie in one region.
    fn refill_cycles(&self, sequence: u32, target: u32, width: Width) -> u32;
    /// A fetch at `address` would continue the last one in its region, at its regular cost.
    fn in_sequence(&self, address: u32) -> bool;
    /// Fetches were made without the bus; one at `address` would continue the last.
    fn continue_at(&mut self, address: u32);

    /// No fetch and no plain access costs more.
    fn access_cycles_max(&self) -> u32;
    /// Read memory, if reading does nothing else and needs no waiting.
    fn plain_read(&self, address: u32, width: Width) -> Option<PlainRead>;
    /// Write memory, if writing does nothing else; cycles of the access.
    fn plain_write(&mut self, address: u32, width: Width, value: u32) -> Option<u32>;
    /// Words of memory, if reading them does nothing else and needs no waiting.
    fn plain_words(&self, address: u32, count: u32) -> Option<PlainWords<&[u32]>>;
    /// Words of memory to write, if writing them does nothing else.
    fn plain_words_mut(&mut self, address: u32, count: u32) -> Option<PlainWords<&mut [u32]>>;
    /// Let processor cycles pass in which nothing happens.
    fn pass(&mut self, cycles: u32);
}
