// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reset controller (AT91SAM7S datasheet, 6175M, chapter 13).

use crate::clock::{slow_clock_cycles, Cycles};
use crate::fault::{no_register, Access};
use crate::registers::{flags, registers};

registers! {
    RSTC_CR = 0x00, RSTC_SR = 0x04, RSTC_MR = 0x08,
}

const KEY: u32 = 0xA5;
/// Flags of the status: an edge on NRST, brown-out, level of NRST, a software reset in progress.
const URSTS: u32 = 1 << 0;
const BODSTS: u32 = 1 << 1;
const NRSTL: u32 = 1 << 16;
const SRCMP: u32 = 1 << 17;
/// Fields of the mode: NRST resets, NRST interrupts when it does not reset, brown-out interrupts.
const URSTEN: u32 = 1 << 0;
const URSTIEN: u32 = 1 << 4;
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
    /// URSTS and BODSTS.
    seen: u32,
    /// End of the pulse on NRST that software asked for. Nothing on the board listens to it.
    pulse_until: Cycles,
}

impl Rstc {
    pub(crate) fn new() -> Self {
        Self {
            mode: 0,
            cause: ResetCause::PowerUp,
            seen: 0,
            pulse_until: 0,
        }
    }

    /// The detector saw a low supply and does not reset.
    pub(crate) fn brown_out(&mut self) {
        self.seen |= BODSTS;
    }

    pub(crate) fn interrupt(&self) -> bool {
        let user = self.mode & (URSTEN | URSTIEN) == URSTIEN;
        let masked = flags(&[(user, URSTS), (self.mode & BODIEN != 0, BODSTS)]);
        self.seen & masked != 0
    }

    pub(crate) fn set_cause(&mut self, cause: ResetCause) {
        self.cause = cause;
    }

    /// Reading the status clears the flags of NRST and of the brown-out.
    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        match offset {
            RSTC_CR => Ok(0),
            RSTC_SR => {
                let pulse = now < self.pulse_until;
                let pin = if pulse { SRCMP } else { NRSTL };
                Ok((self.cause as u32) << 8 | pin | std::mem::take(&mut self.seen))
            }
            RSTC_MR => Ok(self.mode),
            _ => no_register("RSTC", offset),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access<ResetRequest> {
        let keyed = value >> 24 == KEY;
        match offset {
            RSTC_CR if keyed => {
                if value & 1 << 3 != 0 {
                    self.seen |= URSTS;
                    self.pulse_until = now + slow_clock_cycles(2 << (self.mode >> 8 & 0xF));
                }
                return Ok(ResetRequest {
                    processor: value & 1 << 0 != 0,
                    peripherals: value & 1 << 2 != 0,
                });
            }
            RSTC_MR if keyed => self.mode = value & 0x0001_0F11,
            RSTC_CR | RSTC_SR | RSTC_MR => {}
            _ => return no_register("RSTC", offset),
        }
        Ok(ResetRequest::default())
    }
}
