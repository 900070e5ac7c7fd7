// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The processor's state while blocks and JIT code run.

/// In place of the address of an instruction: none.
pub const NO_ADDRESS: u32 = u32::MAX;

/// General registers, flags apart from each other, cycles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GuestState {
    /// r0 to r15; r15 has no meaning here.
    pub registers: [u32; 16],
    /// Bit 31 is N.
    pub negative: u32,
    /// Zero means Z.
    pub zero: u32,
    /// C: 0 or 1.
    pub carry: u32,
    /// Bit 31 is V.
    pub overflow: u32,
    /// Cycles passed since the bus was told the time.
    pub cycles: u32,
    /// Address of the next instruction; bit 0 tells Thumb state.
    pub next: u32,
    /// Address of the store that was executed last, if no branch came after it; else
    /// [`NO_ADDRESS`].
    pub after_store: u32,
    /// Cycles left until JIT code must return.
    pub cycles_left: u32,
}
