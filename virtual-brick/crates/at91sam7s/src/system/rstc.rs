// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reset controller (AT91SAM7S datasheet, 6175M, chapter 13).

use crate::fault::{no_register, Access};
use crate::registers::registers;

registers! {
    RSTC_CR = 0x00, RSTC_SR = 0x04, RSTC_MR = 0x08,
}

const KEY: u32 = 0xA5;
/// Brown-out flag of the status, and its interrupt enable of the mode.
const BODSTS: u32 = 1 << 1;
const BODIEN: u32 = 1 << 16;

/// What reset the chip last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// Power came on.
    PowerUp = 0,
    /// The watchdog expired.
    Watchdog = 2,
    /// Software wrote `RSTC_CR`.
    Software = 3,
    /// The NRST pin was pulled low.
    User = 4,
    /// The core supply fell.
    BrownOut = 5,
}

/// Parts of the chip that a write of `RSTC_CR` resets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ResetRequest {
    pub(crate) processor: bool,
    pub(crate) peripherals: bool,
}

/// Reset registers.
#[derive(Clone, Debug)]
pub(crate) struct Rstc {
    mode: u32,
    cause: ResetCause,
    brown_out: bool,
}

impl Rstc {
    pub(crate) fn new() -> Self {
        Self {
            mode: 0,
            cause: ResetCause::PowerUp,
            brown_out: false,
        }
    }

    /// The detector saw a low supply and does not reset.
    pub(crate) fn brown_out(&mut self) {
        self.brown_out = true;
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.brown_out && self.mode & BODIEN != 0
    }

    pub(crate) fn set_cause(&mut self, cause: ResetCause) {
        self.cause = cause;
    }

    /// Reading the status clears the brown-out flag.
    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        match offset {
            RSTC_CR => Ok(0),
            RSTC_SR => {
                let flag = if std::mem::take(&mut self.brown_out) {
                    BODSTS
                } else {
                    0
                };
                Ok((self.cause as u32) << 8 | 1 << 16 | flag)
            }
            RSTC_MR => Ok(self.mode),
            _ => no_register("RSTC", offset),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<ResetRequest> {
        let keyed = value >> 24 == KEY;
        match offset {
            RSTC_CR if keyed => {
                return Ok(ResetRequest {
                    processor: value & 1 << 0 != 0,
                    peripherals: value & 1 << 2 != 0,
                })
            }
            RSTC_MR if keyed => self.mode = value & 0x0001_0F11,
            RSTC_CR | RSTC_SR | RSTC_MR => {}
            _ => return no_register("RSTC", offset),
        }
        Ok(ResetRequest::default())
    }
}
