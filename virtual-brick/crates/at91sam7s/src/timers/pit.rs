// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Periodic interval timer (AT91SAM7S datasheet, 6175M, chapter 15).
//!
//! A 20-bit counter of MCK/16 and a 12-bit counter of its periods. Nothing happens between
//! accesses: the counters are worked out from the cycle at which they were last known. The
//! prescaler starts with the counter, so the first step comes 16 cycles after the enabling write.

use crate::clock::{Cycles, NEVER};
use crate::fault::{no_register, Access};
use crate::registers::registers;

registers! {
    PIT_MR = 0x00, PIT_SR = 0x04, PIT_PIVR = 0x08, PIT_PIIR = 0x0C,
}

const PITEN: u32 = 1 << 24;
const PITIEN: u32 = 1 << 25;
const PIV: u32 = 0x000F_FFFF;
const TICK: Cycles = 16;

/// Mode, counters and status.
#[derive(Clone, Debug)]
pub(crate) struct Pit {
    mode: u32,
    running: bool,
    /// Cycle at which the counters had the values below.
    base: Cycles,
    counter: u32,
    periods: u32,
    elapsed: bool,
}

impl Pit {
    pub(crate) fn new() -> Self {
        Self {
            mode: PIV,
            running: false,
            base: 0,
            counter: 0,
            periods: 0,
            elapsed: false,
        }
    }

    /// Ticks from the base to the next return to 0.
    fn ticks_to_wrap(&self) -> Cycles {
        let limit = self.mode & PIV;
        let distance = if self.counter <= limit {
            limit - self.counter
        } else {
            PIV + 1 - self.counter + limit
        };
        Cycles::from(distance) + 1
    }

    /// Bring the counters to `now`.
    fn advance(&mut self, now: Cycles) {
        if !self.running {
            return;
        }
        let mut ticks = now.saturating_sub(self.base) / TICK;
        self.base += ticks * TICK;
        let first = self.ticks_to_wrap();
        if ticks < first {
            self.counter = (self.counter.wrapping_add(ticks as u32)) & PIV;
            return;
        }
        self.elapsed = true;
        if self.mode & PITEN == 0 {
            self.running = false;
            self.counter = 0;
            self.periods = (self.periods + 1) & 0xFFF;
            return;
        }
        ticks -= first;
        let period = Cycles::from(self.mode & PIV) + 1;
        self.periods = (self.periods.wrapping_add(1 + (ticks / period) as u32)) & 0xFFF;
        self.counter = (ticks % period) as u32;
    }

    fn image(&self) -> u32 {
        self.periods << 20 | self.counter
    }

    /// What a read gives that changes nothing; of the registers that programs poll.
    pub(crate) fn polled(&self, offset: u32, now: Cycles) -> Option<u32> {
        let mut then = self.clone();
        then.advance(now);
        match offset {
            PIT_SR => Some(u32::from(then.elapsed)),
            PIT_PIIR => Some(then.image()),
            _ => None,
        }
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        self.advance(now);
        match offset {
            PIT_MR => Ok(self.mode),
            PIT_SR => Ok(u32::from(self.elapsed)),
            PIT_PIVR => {
                let value = self.image();
                self.periods = 0;
                self.elapsed = false;
                Ok(value)
            }
            PIT_PIIR => Ok(self.image()),
            _ => no_register("PIT", offset),
        }
    }

    /// True when this write started the counter from 0.
    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access<bool> {
        self.advance(now);
        match offset {
            PIT_MR => {
                self.mode = value & (PITEN | PITIEN | PIV);
                if self.running || value & PITEN == 0 {
                    return Ok(false);
                }
                self.running = true;
                self.base = now;
                self.counter = 0;
                Ok(true)
            }
            PIT_SR | PIT_PIVR | PIT_PIIR => Ok(false),
            _ => no_register("PIT", offset),
        }
    }

    pub(crate) fn serve(&mut self, at: Cycles) {
        self.advance(at);
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.elapsed && self.mode & PITIEN != 0
    }

    /// Next end of period, when it changes the interrupt line.
    pub(crate) fn next_event(&self) -> Cycles {
        if self.running && self.mode & PITIEN != 0 && !self.elapsed {
            self.base + self.ticks_to_wrap() * TICK
        } else {
            NEVER
        }
    }
}
