// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Register tables: offsets under the datasheet's mnemonics, and helpers for their values.

/// Constants for the offsets of a peripheral's registers from its base address.
macro_rules! registers {
    ($($name:ident = $offset:literal),* $(,)?) => { $(const $name: u32 = $offset;)* };
}
pub(crate) use registers;

/// Number of the register at `offset` in a row of registers that begins at `first`.
pub(crate) const fn number_in_row(offset: u32, first: u32) -> usize {
    (offset - first) as usize / 4
}

/// The bits whose condition holds.
pub(crate) fn flags(bits: &[(bool, u32)]) -> u32 {
    let set = bits.iter().filter(|(on, _)| *on);
    set.fold(0, |word, (_, bit)| word | bit)
}
