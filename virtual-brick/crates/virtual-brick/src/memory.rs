// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip's memory as the program sees it, read without time and side effects.

use at91sam7s::AddressError;

use crate::assembly::Machine;
use crate::threads::Memory;

/// A read that met something other than memory.
pub type MemoryError = AddressError;

/// Memory of a chip.
pub(crate) struct ChipMemory<'a>(pub &'a Machine);

impl Memory for ChipMemory<'_> {
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool {
        self.0.peek_into(address, bytes).is_ok()
    }

    fn word(&self, address: u32) -> Option<u32> {
        self.0.peek_word(address).ok()
    }
}
