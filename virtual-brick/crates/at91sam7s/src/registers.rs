// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Register tables: offsets under the datasheet's mnemonics, fields that are not modelled, and
//! helpers for values.

use crate::fault::{not_modelled, Access};

/// Constants for the offsets of a peripheral's registers from its base address.
macro_rules! registers {
    ($($name:ident = $offset:literal),* $(,)?) => { $(const $name: u32 = $offset;)* };
}
pub(crate) use registers;

/// A field of a register some of whose values the model does not carry out: writing one is a fault.
pub(crate) struct Unmodelled {
    register: u32,
    field: u32,
    /// Highest value of the field, in its place, that is modelled.
    highest: u32,
    feature: &'static str,
}

/// Every value of `field` but 0 asks for `feature`.
pub(crate) const fn unmodelled(register: u32, field: u32, feature: &'static str) -> Unmodelled {
    Unmodelled {
        register,
        field,
        highest: 0,
        feature,
    }
}

impl Unmodelled {
    /// Values up to `highest`, in the field's place, are modelled.
    pub(crate) const fn above(self, highest: u32) -> Self {
        Self { highest, ..self }
    }
}

/// Refuse a value that asks the peripheral for what its table says is not modelled.
pub(crate) fn check_written(
    peripheral: &'static str,
    table: &[Unmodelled],
    register: u32,
    value: u32,
) -> Access {
    let asks = |row: &&Unmodelled| row.register == register && value & row.field > row.highest;
    match table.iter().find(asks) {
        Some(row) => not_modelled(peripheral, row.feature),
        None => Ok(()),
    }
}

/// Number of the register at `offset` in a row of registers that begins at `first`.
pub(crate) const fn number_in_row(offset: u32, first: u32) -> usize {
    (offset - first) as usize / 4
}

/// The bits whose condition holds.
pub(crate) fn flags(bits: &[(bool, u32)]) -> u32 {
    let set = bits.iter().filter(|(on, _)| *on);
    set.fold(0, |word, (_, bit)| word | bit)
}
