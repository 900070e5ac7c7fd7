// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Power management controller and clock generator (AT91SAM7S datasheet, 6175M, chapter 25).

use crate::clock::{slow_clock_cycles, Cycles, NEVER, SLOW_CLOCK_HZ};
use crate::clock::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR};
use crate::fault::{no_register, not_modelled, Access};
use crate::registers::{check_written, number_in_row, registers, unmodelled, Unmodelled};

registers! {
    PMC_SCER = 0x00, PMC_SCDR = 0x04, PMC_SCSR = 0x08, PMC_PCER = 0x10, PMC_PCDR = 0x14,
    PMC_PCSR = 0x18, CKGR_MOR = 0x20, CKGR_MCFR = 0x24, CKGR_PLLR = 0x2C, PMC_MCKR = 0x30,
    PMC_PCK0 = 0x40, PMC_PCK1 = 0x44, PMC_PCK2 = 0x48, PMC_IER = 0x60, PMC_IDR = 0x64,
    PMC_SR = 0x68, PMC_IMR = 0x6C,
}

const MAIN_CLOCK_HZ: u64 = 18_432_000;
const MOSCS: u32 = 1 << 0;
const LOCK: u32 = 1 << 2;
const MCKRDY: u32 = 1 << 3;
/// Time from a write of `PMC_MCKR` to MCKRDY.
const SWITCH_CYCLES: Cycles = 16;
const PCK: u32 = 1 << 0;
const SYSTEM_CLOCKS: u32 = 1 << 7 | 7 << 8;
/// Peripheral identifiers 2 and 4 to 14 have a clock switch.
const PERIPHERAL_CLOCKS: u32 = 0x7FF4;
/// OUT has no effect: the PLL locks at any setting. The programmable clocks reach no pin.
const UNMODELLED: &[Unmodelled] = &[unmodelled(
    CKGR_MOR,
    1 << 1,
    "a clock on XIN in place of the crystal (OSCBYPASS)",
)];
/// Main clock periods in 16 slow clock periods.
const MAIN_FREQUENCY: u32 = (16 * MAIN_CLOCK_HZ / SLOW_CLOCK_HZ) as u32;

/// Clock registers and when each clock becomes ready.
#[derive(Clone, Debug)]
pub(crate) struct Pmc {
    system: u32,
    peripheral: u32,
    oscillator: u32,
    pll: u32,
    master: u32,
    programmable: [u32; 3],
    mask: u32,
    oscillator_at: Cycles,
    lock_at: Cycles,
    master_at: Cycles,
}

/// What a write asks of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Request {
    Nothing,
    StopProcessor,
}

impl Pmc {
    pub(crate) fn new() -> Self {
        Self {
            system: 0,
            peripheral: 0,
            oscillator: 0,
            pll: 0x3F00,
            master: 0,
            programmable: [0; 3],
            mask: 0,
            oscillator_at: NEVER,
            lock_at: NEVER,
            master_at: 0,
        }
    }

    /// Clocks as the boot monitor leaves them: crystal, PLL x73/14, master clock PLL/2.
    pub(crate) fn as_boot_monitor(&mut self, now: Cycles) {
        self.oscillator = 0x0601;
        self.pll = 0x1048_1C0E;
        self.master = 7;
        self.oscillator_at = now;
        self.lock_at = now;
        self.master_at = now;
    }

    pub(crate) fn clocked(&self, identifier: u8) -> bool {
        self.peripheral >> identifier & 1 != 0
    }

    /// A clock of `PMC_SCER` is on.
    pub(crate) fn system_clocked(&self, bit: u32) -> bool {
        self.system & bit != 0
    }

    /// The clock of the USB port, PLL / 2^USBDIV, is within 0.25 % of 48 MHz (USB 2.0, 7.1.11).
    pub(crate) fn usb_clock_fits(&self) -> bool {
        let factor = u64::from(self.pll >> 16 & 0x7FF) + 1;
        let divider = u64::from(self.pll & 0xFF) << (self.pll >> 28 & 3);
        let clock = MAIN_CLOCK_HZ * factor;
        clock.abs_diff(48_000_000 * divider) <= 120_000 * divider
    }

    fn status(&self, now: Cycles) -> u32 {
        let mut status = self.system & 7 << 8;
        for (at, bit) in [
            (self.oscillator_at, MOSCS),
            (self.lock_at, LOCK),
            (self.master_at, MCKRDY),
        ] {
            if at <= now {
                status |= bit;
            }
        }
        status
    }

    pub(crate) fn interrupt(&self, now: Cycles) -> bool {
        self.status(now) & self.mask != 0
    }

    pub(crate) fn next_event(&self, now: Cycles) -> Cycles {
        [
            (self.oscillator_at, MOSCS),
            (self.lock_at, LOCK),
            (self.master_at, MCKRDY),
        ]
        .into_iter()
        .filter(|(at, bit)| *at > now && self.mask & bit != 0)
        .map(|(at, _)| at)
        .min()
        .unwrap_or(NEVER)
    }

    pub(crate) fn read(&self, offset: u32, now: Cycles) -> Access<u32> {
        Ok(match offset {
            PMC_SCER | PMC_SCDR | PMC_PCER | PMC_PCDR | PMC_IER | PMC_IDR => 0,
            PMC_SCSR => self.system | PCK,
            PMC_PCSR => self.peripheral,
            CKGR_MOR => self.oscillator,
            CKGR_MCFR if self.oscillator_at <= now => MAIN_FREQUENCY | 1 << 16,
            CKGR_MCFR => 0,
            CKGR_PLLR => self.pll,
            PMC_MCKR => self.master,
            PMC_PCK0 | PMC_PCK1 | PMC_PCK2 => self.programmable[number_in_row(offset, PMC_PCK0)],
            PMC_SR => self.status(now),
            PMC_IMR => self.mask,
            _ => return no_register("PMC", offset),
        })
    }

    /// This write stops the processor clock and changes no other: how programs wait.
    pub(crate) fn only_stops_processor(offset: u32, value: u32) -> bool {
        offset == PMC_SCDR && value == PCK
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access<Request> {
        check_written("PMC", UNMODELLED, offset, value)?;
        match offset {
            PMC_SCER => self.system |= value & SYSTEM_CLOCKS,
            PMC_SCDR => {
                self.system &= !value;
                if value & PCK != 0 {
                    return Ok(Request::StopProcessor);
                }
            }
            PMC_PCER => self.peripheral |= value & PERIPHERAL_CLOCKS,
            PMC_PCDR => self.peripheral &= !value,
            CKGR_MOR => self.set_oscillator(value, now),
            CKGR_PLLR => self.set_pll(value, now),
            PMC_MCKR => {
                self.master = value & 0x1F;
                self.master_at = now + SWITCH_CYCLES;
                self.processor_ratio()?;
            }
            PMC_PCK0 | PMC_PCK1 | PMC_PCK2 => {
                self.programmable[number_in_row(offset, PMC_PCK0)] = value & 0x1F
            }
            PMC_IER => self.mask |= value & (MOSCS | LOCK | MCKRDY | 7 << 8),
            PMC_IDR => self.mask &= !value,
            PMC_SCSR | PMC_PCSR | CKGR_MCFR | PMC_SR | PMC_IMR => {}
            _ => return no_register("PMC", offset),
        }
        Ok(Request::Nothing)
    }

    fn set_oscillator(&mut self, value: u32, now: Cycles) {
        let was_on = self.oscillator & 1 != 0;
        self.oscillator = value & 0xFF01;
        self.oscillator_at = match (value & 1 != 0, was_on) {
            (false, _) => NEVER,
            (true, true) => self.oscillator_at,
            (true, false) => now + slow_clock_cycles(8 * u64::from(value >> 8 & 0xFF)),
        };
    }

    fn set_pll(&mut self, value: u32, now: Cycles) {
        const FREQUENCY_FIELDS: u32 = 0x07FF_C0FF;
        let same = (self.pll ^ value) & FREQUENCY_FIELDS == 0 && self.lock_at != NEVER;
        self.pll = value & 0x37FF_FFFF;
        if value & 0xFF == 0 || value >> 16 & 0x7FF == 0 {
            self.lock_at = NEVER;
        } else if !same {
            self.lock_at = now + slow_clock_cycles(u64::from(value >> 8 & 0x3F));
        }
    }

    /// Cycles of the time base in one processor cycle, rounded to the nearest integer.
    pub(crate) fn processor_ratio(&self) -> Access<Cycles> {
        let (numerator, denominator) = match self.master & 3 {
            0 => (SLOW_CLOCK_HZ, 1),
            1 => (MAIN_CLOCK_HZ, 1),
            _ => {
                let factor = u64::from(self.pll >> 16 & 0x7FF) + 1;
                (MAIN_CLOCK_HZ * factor, u64::from(self.pll & 0xFF))
            }
        };
        let prescaler = u32::min(self.master >> 2 & 7, 6);
        if denominator == 0 {
            return not_modelled("PMC", "a stopped master clock");
        }
        let base = (MASTER_CLOCK_HZ_NUMERATOR * denominator) << prescaler;
        let clock = MASTER_CLOCK_HZ_DENOMINATOR * numerator;
        if clock * 1000 > base * 1001 {
            return not_modelled("PMC", "a master clock above 48.06 MHz");
        }
        Ok((base + clock / 2) / clock)
    }
}
