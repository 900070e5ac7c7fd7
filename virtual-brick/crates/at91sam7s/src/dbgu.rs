// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Debug unit (AT91SAM7S datasheet, 6175M, chapter 26): the chip identifiers. Its serial line is
//! a [`crate::usart::Usart`].

/// `DBGU_CIDR` or `DBGU_EXID`; nothing for the registers of the serial line. Both ignore writes.
pub(crate) fn identifier(offset: u32, chip_identifier: u32) -> Option<u32> {
    match offset {
        0x40 => Some(chip_identifier),
        0x44 => Some(0),
        _ => None,
    }
}
