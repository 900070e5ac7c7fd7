// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The bus as decoded blocks need it: code memories, their costs, accesses without side effects.

use crate::bus::{Bus, Width};

/// Where code lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodePlace {
    /// Number of the halfword among all halfwords that can hold code, below
    /// [`BlockBus::CODE_HALFWORDS`]. Appearances of one memory at several addresses share it.
    pub halfword: u32,
    /// Number of the memory; within one, the costs of fetches follow uniform rules.
    pub memory: u8,
}

/// A data read that only reads memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainRead {
    /// As [`Bus::read`] returns it.
    pub value: u32,
    /// Cycles of the access.
    pub cycles: u32,
}

/// The effect of an access through the bus on memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusAccess {
    /// Misaligned, or a store to code: the reference engine must make it.
    Refused,
    /// Memory that holds code does not change before the end of the access.
    KeepsMemory,
    /// Memory may change with it.
    ChangesMemory,
}

/// Words that lie one after the other in memory.
pub struct PlainWords<W> {
    /// The words.
    pub words: W,
    /// Cycles of the access to each.
    pub cycles: u32,
}

/// RAM as JIT code sees it.
#[derive(Debug)]
pub struct RamView<'a> {
    /// Address of the first word.
    pub address: u32,
    /// All words.
    pub words: &'a mut [u32],
    /// Of each word, not zero: stores to it must go through the bus.
    pub marks: &'a [u8],
}

/// A bus whose code memories can be decoded ahead of execution.
///
/// Costs are in cycles of the processor clock and hold until [`BlockBus::code_epoch`] changes or
/// something happens that a plain access does not do.
pub trait BlockBus: Bus {
    /// Number of halfwords that can hold code.
    const CODE_HALFWORDS: u32;

    /// Where the code at `address` lies; none outside the memories that can hold code.
    fn code_place(&self, address: u32) -> Option<CodePlace>;
    /// Where the target of a branch lies; none where arrivals are observed.
    fn target_place(&self, address: u32) -> Option<CodePlace>;
    /// A block may begin at `address`, which has a place.
    fn can_enter(&self, address: u32) -> bool;
    /// The instruction at `address` is observed, so no block contains it.
    fn observes_arrival(&self, _address: u32) -> bool {
        false
    }
    /// The word that a fetch at `address` would bring, without the fetch. Called only for
    /// addresses that have a place.
    fn code_word(&self, address: u32) -> u32;
    /// Changes with everything that invalidates all decoded code or its costs.
    fn code_epoch(&self) -> u32;
    /// Report the next change of the word at `address` through [`BlockBus::next_code_change`].
    fn mark_code(&mut self, address: u32);
    /// Halfword number (even) of a marked word that was written, once per write of each.
    fn next_code_change(&mut self) -> Option<u32>;

    /// Cycles of the opcode fetch at `address` that continues the fetch before it.
    fn sequential_fetch_cycles(&self, address: u32, width: Width) -> u32;
    /// [`BlockBus::refill_cycles`] if `target` is a place for branches in this memory.
    #[inline(always)]
    fn branch_cycles(&self, sequence: u32, target: u32, width: Width, memory: u8) -> Option<u32> {
        let place = self.target_place(target)?;
        (place.memory == memory).then(|| self.refill_cycles(sequence, target, width))
    }
    /// Cycles of the two fetches that fill the pipeline at `target`, when a fetch at `sequence`
    /// would have continued the last one. Both lie in one memory.
    fn refill_cycles(&self, sequence: u32, target: u32, width: Width) -> u32;
    /// A fetch at `address` would continue the last one in its memory, at its regular cost.
    fn in_sequence(&self, address: u32) -> bool;
    /// Fetches were made without the bus; one at `address` would continue the last.
    fn continue_at(&mut self, address: u32);

    /// No fetch, no plain access and no access to a register costs more.
    fn access_cycles_max(&self) -> u32;
    /// Cycles of an access to RAM.
    fn ram_cycles(&self) -> u32;
    /// Read RAM at an aligned address.
    fn ram_read(&self, address: u32, width: Width) -> Option<u32>;
    /// Write RAM at an aligned address, if writing does nothing else; true when written.
    fn ram_write(&mut self, address: u32, width: Width, value: u32) -> bool;
    /// Read memory, if reading does nothing else and needs no waiting.
    fn plain_read(&self, address: u32, width: Width) -> Option<PlainRead>;
    /// Cycles of an access to a register.
    fn register_cycles(&self) -> u32;
    /// Read the register at a word's address after so many cycles, before which nothing is due, if
    /// reading changes nothing; and whether it reads the same until something is due.
    fn register_read(&self, address: u32, after_cycles: u32) -> Option<(u32, bool)>;
    /// Write the register at a word's address after so many cycles, before which nothing is due, if
    /// the same is due afterwards; true when written.
    fn register_write(&mut self, address: u32, value: u32, after_cycles: u32) -> bool;
    /// Words of memory, if reading them does nothing else and needs no waiting.
    fn plain_words(&self, address: u32, count: u32) -> Option<PlainWords<&[u32]>>;
    /// Words of memory to write, if writing them does nothing else.
    fn plain_words_mut(&mut self, address: u32, count: u32) -> Option<PlainWords<&mut [u32]>>;
    /// The effect that [`Bus::read`] or [`Bus::write`] would have at `address`, between two blocks
    /// and after so many cycles.
    fn access_between(
        &self,
        address: u32,
        width: Width,
        write: bool,
        after_cycles: u32,
    ) -> BusAccess;
    /// Number of the first halfword of a memory, and the bits of an address, in halfwords, that
    /// give the distance from it.
    fn code_window(&self, memory: u8) -> (u32, u32);
    /// All of RAM, for JIT code; none if it cannot be accessed in this way.
    fn ram_view(&mut self) -> Option<RamView<'_>>;
    /// Something besides the processor must act before the next instruction.
    fn needs_attention(&self) -> bool;
    /// Cycles in which nothing can act on the processor and `limit` (in the bus's time) is not
    /// reached, as long as the processor accesses only memory. `irq` and `fiq` tell which
    /// interrupts are not masked. Less than 2^31.
    fn cycles_until_event(&self, limit: u64, irq: bool, fiq: bool) -> u32;
    /// Lets cycles of the processor pass in which nothing happens.
    fn pass(&mut self, cycles: u32);
}
