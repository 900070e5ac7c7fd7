// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Memory controller: remap toggle and abort status (AT91SAM7S datasheet, 6175M, chapter 18).

use arm7tdmi::bus::Width;

/// What was attempted when an access was aborted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AbortedAccess {
    Read = 0,
    Write = 1,
    Fetch = 2,
}

/// Why the memory controller aborted an access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AbortCause {
    Undefined = 1,
    Misaligned = 2,
}

const MASTER_PROCESSOR: u32 = 1 << 17;
const SAVED_PROCESSOR: u32 = 1 << 25;

/// Remap state and abort registers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mc {
    pub(crate) remapped: bool,
    abort_status: u32,
    abort_address: u32,
}

impl Mc {
    pub(crate) fn record_abort(
        &mut self,
        cause: AbortCause,
        access: AbortedAccess,
        width: Width,
        address: u32,
    ) {
        let size = match width {
            Width::Byte => 0,
            Width::Halfword => 1,
            Width::Word => 2,
        };
        self.abort_status =
            cause as u32 | size << 8 | (access as u32) << 10 | MASTER_PROCESSOR | SAVED_PROCESSOR;
        self.abort_address = address;
    }

    /// `MC_ASR`; the saved-master flag clears on reading.
    pub(crate) fn read_abort_status(&mut self) -> u32 {
        let value = self.abort_status;
        self.abort_status &= !SAVED_PROCESSOR;
        value
    }

    pub(crate) fn abort_address(&self) -> u32 {
        self.abort_address
    }

    /// The last access was aborted because it was not aligned.
    pub(crate) fn abort_misaligned(&self) -> bool {
        self.abort_status & AbortCause::Misaligned as u32 != 0
    }

    /// `MC_RCR`: writing 1 to bit 0 toggles what is seen at address 0.
    pub(crate) fn write_remap(&mut self, value: u32) {
        if value & 1 != 0 {
            self.remapped = !self.remapped;
        }
    }
}
