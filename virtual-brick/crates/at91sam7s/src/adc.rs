// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Analogue to digital converter (AT91SAM7S datasheet, 6175M, chapter 36).
//!
//! Triggered by software or by a rising edge of TIOA0, TIOA1 or TIOA2. A sequence converts the
//! enabled channels in ascending order; each takes SHTIM + 1 converter clocks of sampling and 10
//! of conversion (8 in low resolution). Start-up time is spent before the first conversion after
//! reset, and before each one in sleep mode.
//! The converter runs whether or not its clock bit in the PMC is set (section 36.4.1).

use crate::clock::{Cycles, NEVER};
use crate::fault::{no_register, not_modelled, Access};
use crate::registers::{number_in_row, registers};

registers! {
    ADC_CR = 0x00, ADC_MR = 0x04, ADC_CHER = 0x10, ADC_CHDR = 0x14, ADC_CHSR = 0x18,
    ADC_SR = 0x1C, ADC_LCDR = 0x20, ADC_IER = 0x24, ADC_IDR = 0x28, ADC_IMR = 0x2C,
    ADC_CDR0 = 0x30, ADC_CDR7 = 0x4C,
}

const NAME: &str = "ADC";
pub(crate) const IDENTIFIER: u8 = 4;
const TRGEN: u32 = 1 << 0;
const TRGSEL: u32 = 7 << 1;
const LOWRES: u32 = 1 << 4;
const SLEEP: u32 = 1 << 5;
const DRDY: u32 = 1 << 16;
const GOVRE: u32 = 1 << 17;
/// GOVRE and the overrun bits of the channels.
const READ_CLEARS: u32 = GOVRE | 0xFF00;
/// ENDRX and RXBUFF: the data controller of the converter is idle.
const IDLE_TRANSFER: u32 = 3 << 18;

/// Registers and the running sequence.
#[derive(Clone, Debug)]
pub(crate) struct Adc {
    mode: u32,
    channels: u32,
    status: u32,
    mask: u32,
    last: u32,
    data: [u32; 8],
    remaining: u32,
    ends: Cycles,
    warm: bool,
    /// Erratum: a read of a channel's result clears DRDY.
    channel_read_clears_drdy: bool,
}

impl Adc {
    pub(crate) fn new(channel_read_clears_drdy: bool) -> Self {
        Self {
            mode: 0,
            channels: 0,
            status: 0,
            mask: 0,
            last: 0,
            data: [0; 8],
            remaining: 0,
            ends: NEVER,
            warm: false,
            channel_read_clears_drdy,
        }
    }

    fn clock(&self) -> Cycles {
        2 * (Cycles::from(self.mode >> 8 & 0xFF) + 1)
    }

    fn conversion(&self) -> Cycles {
        let sampling = Cycles::from(self.mode >> 24 & 0xF) + 1;
        let bits = if self.mode & LOWRES != 0 { 8 } else { 10 };
        (sampling + bits) * self.clock()
    }

    fn start_up(&self) -> Cycles {
        if self.warm && self.mode & SLEEP == 0 {
            0
        } else {
            8 * (Cycles::from(self.mode >> 16 & 0x1F) + 1) * self.clock()
        }
    }

    /// Begin a sequence, unless one is running.
    pub(crate) fn trigger(&mut self, now: Cycles) {
        if self.remaining != 0 || self.channels == 0 {
            return;
        }
        self.remaining = self.channels;
        self.ends = now + self.start_up() + self.conversion();
        self.warm = true;
    }

    /// Timer channel whose TIOA triggers conversions.
    pub(crate) fn trigger_channel(&self) -> Option<usize> {
        (self.mode & TRGEN != 0).then_some((self.mode & TRGSEL) as usize >> 1)
    }

    pub(crate) fn next_event(&self) -> Cycles {
        self.ends
    }

    /// Channel whose conversion has just ended.
    pub(crate) fn converted(&self) -> u8 {
        self.remaining.trailing_zeros() as u8
    }

    /// Store the result of the conversion that ended and begin the next.
    pub(crate) fn store(&mut self, at: Cycles, count: u16) {
        let channel = self.converted();
        if channel > 7 {
            self.ends = NEVER;
            return;
        }
        let count = u32::from(count) & 0x3FF;
        let value = if self.mode & LOWRES != 0 {
            count >> 2
        } else {
            count
        };
        let ended = 1u32 << channel;
        if self.status & ended != 0 {
            self.status |= ended << 8;
        }
        if self.status & DRDY != 0 {
            self.status |= GOVRE;
        }
        self.status |= ended | DRDY;
        self.data[usize::from(channel)] = value;
        self.last = value;
        self.remaining &= !ended;
        self.ends = if self.remaining == 0 {
            NEVER
        } else {
            at + self.conversion()
        };
    }

    pub(crate) fn interrupt(&self) -> bool {
        (self.status | IDLE_TRANSFER) & self.mask != 0
    }

    /// What a read gives that changes nothing; of the registers that programs poll.
    pub(crate) fn polled(&self, offset: u32) -> Option<u32> {
        let kept = offset == ADC_SR && self.status & READ_CLEARS == 0;
        kept.then_some(self.status | IDLE_TRANSFER)
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            ADC_CR | ADC_CHER | ADC_CHDR | ADC_IER | ADC_IDR => 0,
            ADC_MR => self.mode,
            ADC_CHSR => self.channels,
            ADC_SR => {
                let value = self.status | IDLE_TRANSFER;
                self.status &= !READ_CLEARS;
                value
            }
            ADC_LCDR => {
                self.status &= !DRDY;
                self.last
            }
            ADC_IMR => self.mask,
            ADC_CDR0..=ADC_CDR7 => {
                let channel = number_in_row(offset, ADC_CDR0);
                self.status &= !(1 << channel);
                if self.channel_read_clears_drdy {
                    self.status &= !DRDY;
                }
                self.data[channel]
            }
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access {
        match offset {
            ADC_CR => {
                if value & 1 != 0 {
                    *self = Self::new(self.channel_read_clears_drdy);
                }
                if value & 2 != 0 {
                    self.trigger(now);
                }
            }
            ADC_MR => {
                if value & TRGEN != 0 && value & TRGSEL > 2 << 1 {
                    return not_modelled(NAME, "a hardware trigger other than TIOA0 to TIOA2");
                }
                self.mode = value & 0x0F1F_FF3F;
            }
            ADC_CHER => self.channels |= value & 0xFF,
            ADC_CHDR => self.channels &= !value,
            ADC_IER => self.mask |= value & 0x000F_FFFF,
            ADC_IDR => self.mask &= !value,
            ADC_CHSR | ADC_SR | ADC_LCDR | ADC_IMR => {}
            ADC_CDR0..=ADC_CDR7 => {}
            _ => return no_register(NAME, offset),
        }
        Ok(())
    }
}
