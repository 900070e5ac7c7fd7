// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The border between the core and everything else: one trait, no addresses known.

/// Width of a bus access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// 8 bits.
    Byte,
    /// 16 bits; bit 0 of the address is ignored by memory.
    Halfword,
    /// 32 bits; bits 1:0 of the address are ignored by memory.
    Word,
}

/// Kind of a memory cycle (DDI 0029E, chapter 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// N-cycle: the address has no relation to the previous one.
    Nonsequential,
    /// S-cycle: the address follows the previous one.
    Sequential,
}

/// The memory system signalled an abort for this access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abort;

/// What the core needs from the machine around it.
///
/// The bus owns time: every call takes at least one clock cycle and the bus adds wait states.
/// Addresses of data accesses are given as the core computes them; the bus ignores the low bits
/// that `Width` excludes and the core rotates the result.
pub trait Bus {
    /// Fetch an ARM opcode.
    fn fetch_word(&mut self, address: u32, cycle: Cycle) -> Result<u32, Abort>;
    /// Fetch a Thumb opcode.
    fn fetch_halfword(&mut self, address: u32, cycle: Cycle) -> Result<u16, Abort>;
    /// Read data, zero-extended.
    fn read(&mut self, address: u32, width: Width, cycle: Cycle) -> Result<u32, Abort>;
    /// Write the low `width` bits of `value`.
    fn write(&mut self, address: u32, width: Width, value: u32, cycle: Cycle) -> Result<(), Abort>;
    /// Let `count` internal cycles pass; never stretched.
    fn internal(&mut self, count: u32);
    /// Level of nIRQ (true: asserted) as the core's synchroniser shows it at this boundary.
    /// A machine without interrupts need not define it.
    #[inline(always)]
    fn irq(&self) -> bool {
        false
    }
    /// Level of nFIQ, likewise.
    #[inline(always)]
    fn fiq(&self) -> bool {
        false
    }
}
