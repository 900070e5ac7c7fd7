// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Watchdog timer (AT91SAM7S datasheet, 6175M, chapter 16).
//!
//! A 12-bit down counter of the slow clock divided by 128; runs from reset for 16 s. The mode
//! register takes one write.

use crate::clock::{slow_clock_cycles, Cycles, NEVER};
use crate::fault::{no_register, Access};
use crate::registers::registers;

registers! {
    WDT_CR = 0x00, WDT_MR = 0x04, WDT_SR = 0x08,
}

const RESET_MODE: u32 = 0x3FFF_2FFF;
const WDFIEN: u32 = 1 << 12;
const WDRSTEN: u32 = 1 << 13;
const WDRPROC: u32 = 1 << 14;
const WDDIS: u32 = 1 << 15;
const WDIDLEHLT: u32 = 1 << 29;
const KEY: u32 = 0xA5;

/// What an expired watchdog does to the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expiry {
    Nothing,
    ResetProcessor,
    ResetAll,
}

/// Mode, status and the time of expiry.
#[derive(Clone, Debug)]
pub(crate) struct Wdt {
    mode: u32,
    mode_written: bool,
    status: u32,
    started: Cycles,
    expires: Cycles,
    halted_at: Option<Cycles>,
}

fn period(value: u32) -> Cycles {
    slow_clock_cycles(128 * (u64::from(value & 0xFFF) + 1))
}

impl Wdt {
    pub(crate) fn new(now: Cycles) -> Self {
        Self {
            mode: RESET_MODE,
            mode_written: false,
            status: 0,
            started: now,
            expires: now + period(RESET_MODE),
            halted_at: None,
        }
    }

    /// As the boot monitor leaves it: disabled, and the mode register used up.
    pub(crate) fn as_boot_monitor(&mut self) {
        self.mode = WDDIS;
        self.mode_written = true;
        self.expires = NEVER;
    }

    fn restart(&mut self, now: Cycles) {
        self.started = now;
        self.expires = if self.mode & WDDIS != 0 {
            NEVER
        } else {
            now + period(self.mode)
        };
    }

    pub(crate) fn next_event(&self) -> Cycles {
        if self.halted_at.is_some() {
            NEVER
        } else {
            self.expires
        }
    }

    /// The processor clock stopped: the counter halts if the mode says so.
    pub(crate) fn processor_stopped(&mut self, now: Cycles) {
        if self.mode & WDIDLEHLT != 0 && self.mode & WDDIS == 0 {
            self.halted_at = Some(now);
        }
    }

    pub(crate) fn processor_resumed(&mut self, now: Cycles) {
        if let Some(halted) = self.halted_at.take() {
            self.started += now - halted;
            self.expires += now - halted;
        }
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status != 0 && self.mode & WDFIEN != 0
    }

    fn fault(&mut self, flag: u32) -> Expiry {
        self.status |= flag;
        if self.mode & WDRSTEN == 0 {
            Expiry::Nothing
        } else if self.mode & WDRPROC != 0 {
            Expiry::ResetProcessor
        } else {
            Expiry::ResetAll
        }
    }

    /// The counter reached 0.
    pub(crate) fn serve(&mut self, at: Cycles) -> Expiry {
        self.restart(at);
        self.fault(1)
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        match offset {
            WDT_CR => Ok(0),
            WDT_MR => Ok(self.mode),
            WDT_SR => Ok(std::mem::take(&mut self.status)),
            _ => no_register("WDT", offset),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access<Expiry> {
        match offset {
            WDT_CR if value >> 24 == KEY && value & 1 != 0 && self.mode & WDDIS == 0 => {
                let elapsed = now - self.started;
                let opens = period(self.mode).saturating_sub(period(self.mode >> 16));
                if elapsed < opens {
                    return Ok(self.fault(2));
                }
                self.restart(now);
            }
            WDT_MR if !self.mode_written => {
                self.mode = value & 0x3FFF_FFFF;
                self.mode_written = true;
                self.restart(now);
            }
            WDT_CR | WDT_MR | WDT_SR => {}
            _ => return no_register("WDT", offset),
        }
        Ok(Expiry::Nothing)
    }
}
