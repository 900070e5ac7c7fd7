// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Debug unit (AT91SAM7S datasheet, 6175M, chapter 26): only the chip identifiers. The pins of
//! its serial lines carry other signals on the boards that this model serves.

use crate::fault::{Access, FaultKind};

/// Read `DBGU_CIDR`, `DBGU_EXID`.
pub(crate) fn read(offset: u32, chip_identifier: u32) -> Access<u32> {
    match offset {
        0x40 => Ok(chip_identifier),
        0x44 => Ok(0),
        _ => Err(FaultKind::RegisterNotModelled {
            peripheral: "DBGU",
            offset,
        }),
    }
}

/// The identifiers ignore writes.
pub(crate) fn write(offset: u32) -> Access<()> {
    match offset {
        0x40 | 0x44 => Ok(()),
        _ => Err(FaultKind::RegisterNotModelled {
            peripheral: "DBGU",
            offset,
        }),
    }
}
