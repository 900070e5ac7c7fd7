// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Synchronous serial controller, transmitter (AT91SAM7S datasheet, 6175M, chapter 32).
//!
//! The transmitter runs from the divided clock, MCK/(2 DIV), with continuous start: a word is
//! shifted as soon as one waits and the shifter is free, without gaps while words keep coming.
//! Words of up to 8, 16 and 32 bits are fetched as bytes, halfwords and words.

use crate::board::{Cycles, SoundBits};
use crate::fault::{Access, FaultKind};
use crate::pdc::Pdc;
use crate::NEVER;

pub(crate) const NAME: &str = "SSC";
pub(crate) const IDENTIFIER: u8 = 8;

const TXRDY: u32 = 1 << 0;
const TXEMPTY: u32 = 1 << 1;
const ENDTX: u32 = 1 << 2;
const TXBUFE: u32 = 1 << 3;
const ENDRX: u32 = 1 << 6;
const RXBUFF: u32 = 1 << 7;
const TXSYN: u32 = 1 << 10;
const TXEN: u32 = 1 << 16;
/// Flags that can interrupt.
const MASKABLE: u32 = 0xFFF;

const MSBF: u32 = 1 << 7;
const FSDEN: u32 = 1 << 23;

/// A word in the shifter and when its last bit ends.
#[derive(Clone, Copy, Debug)]
struct Shifting {
    word: SoundBits,
    end: Cycles,
}

/// Registers, transmit shifter and data controller.
#[derive(Clone, Debug)]
pub(crate) struct Ssc {
    enabled: bool,
    divider: u32,
    receive_clock: u32,
    receive_frame: u32,
    transmit_clock: u32,
    transmit_frame: u32,
    synchronisation: u32,
    compare: [u32; 2],
    mask: u32,
    holding: Option<u32>,
    shifting: Option<Shifting>,
    frame_started: bool,
    words_left: u32,
    pub(crate) pdc: Pdc,
}

impl Ssc {
    pub(crate) fn new() -> Self {
        Self {
            enabled: false,
            divider: 0,
            receive_clock: 0,
            receive_frame: 0,
            transmit_clock: 0,
            transmit_frame: 0,
            synchronisation: 0,
            compare: [0; 2],
            mask: 0,
            holding: None,
            shifting: None,
            frame_started: false,
            words_left: 0,
            pdc: Pdc::new(),
        }
    }

    /// Software reset: everything but the data controller.
    fn software_reset(&mut self) {
        let pdc = self.pdc.clone();
        *self = Self { pdc, ..Self::new() };
    }

    fn status(&self) -> u32 {
        let waiting = self.holding.is_some();
        let flags = [
            (self.enabled && !waiting, TXRDY),
            (self.enabled && !waiting && self.shifting.is_none(), TXEMPTY),
            (self.pdc.transmit.ended(), ENDTX),
            (self.pdc.transmit.exhausted(), TXBUFE),
            (self.pdc.receive.ended(), ENDRX),
            (self.pdc.receive.exhausted(), RXBUFF),
            (self.frame_started, TXSYN),
            (self.enabled, TXEN),
        ];
        flags
            .iter()
            .filter(|(on, _)| *on)
            .fold(0, |word, (_, bit)| word | bit)
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status() & self.mask != 0
    }

    pub(crate) fn next_event(&self) -> Cycles {
        self.shifting.map_or(NEVER, |shifting| shifting.end)
    }

    fn bits(&self) -> u32 {
        (self.transmit_frame & 0x1F) + 1
    }

    /// Size in bytes of one data controller transfer.
    pub(crate) fn transfer_size(&self) -> u32 {
        match self.bits() {
            1..=8 => 1,
            9..=16 => 2,
            _ => 4,
        }
    }

    /// The data controller may write the holding register.
    pub(crate) fn wants_data(&self) -> bool {
        self.enabled && self.holding.is_none() && self.pdc.transmit.ready()
    }

    /// Put a word in the holding register.
    pub(crate) fn transmit(&mut self, value: u32, now: Cycles) -> Access<()> {
        if !self.enabled {
            return Ok(());
        }
        if self.bits() == 1 {
            return missing("a data length of 1 bit (DATLEN = 0)");
        }
        self.holding = Some(value);
        self.start(now);
        Ok(())
    }

    /// Shift the waiting word if the shifter is free and has a clock.
    fn start(&mut self, now: Cycles) {
        if self.shifting.is_some() || self.divider == 0 {
            return;
        }
        let Some(value) = self.holding.take() else {
            return;
        };
        let count = self.bits();
        let kept = value & u32::MAX >> (32 - count);
        let bits = if self.transmit_frame & MSBF != 0 {
            kept
        } else {
            kept.reverse_bits() >> (32 - count)
        };
        let bit_cycles = 2 * Cycles::from(self.divider);
        if self.words_left == 0 {
            self.words_left = (self.transmit_frame >> 8 & 0xF) + 1;
            self.frame_started = true;
        }
        self.words_left -= 1;
        self.shifting = Some(Shifting {
            word: SoundBits {
                bits,
                count: count as u8,
                bit_cycles,
            },
            end: now + bit_cycles * Cycles::from(count),
        });
    }

    /// The word whose last bit has just ended, if one has; the next one follows at once.
    pub(crate) fn shifted(&mut self, at: Cycles) -> Option<SoundBits> {
        let Shifting { word, end } = self.shifting?;
        if end > at {
            return None;
        }
        self.shifting = None;
        self.start(end);
        Some(word)
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x20 | 0x24 | 0x30 | 0x44 | 0x48 => 0,
            0x04 => self.divider,
            0x10 => self.receive_clock,
            0x14 => self.receive_frame,
            0x18 => self.transmit_clock,
            0x1C => self.transmit_frame,
            0x34 => self.synchronisation,
            0x38 | 0x3C => self.compare[(offset as usize - 0x38) / 4],
            0x40 => {
                let value = self.status();
                self.frame_started = false;
                value
            }
            0x4C => self.mask,
            0x100..=0x124 => return self.pdc.read(offset, NAME),
            _ => return unknown(offset),
        })
    }

    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: Cycles,
        clocked: bool,
    ) -> Access<()> {
        match offset {
            0x00 => return self.control(value, now, clocked),
            0x04 => {
                self.divider = value & 0xFFF;
                self.start(now);
            }
            0x10 => self.receive_clock = value,
            0x14 => self.receive_frame = value,
            0x18 => self.set_clock(value)?,
            0x1C => {
                if value & FSDEN != 0 {
                    return missing("frame synchronisation data");
                }
                self.transmit_frame = value;
            }
            0x24 => return self.transmit(value, now),
            0x34 => self.synchronisation = value & 0xFFFF,
            0x38 | 0x3C => self.compare[(offset as usize - 0x38) / 4] = value & 0xFFFF,
            0x44 => self.mask |= value & MASKABLE,
            0x48 => self.mask &= !value,
            0x20 | 0x30 | 0x40 | 0x4C => {}
            0x100..=0x124 => return self.pdc.write(offset, value, NAME),
            _ => return unknown(offset),
        }
        Ok(())
    }

    fn set_clock(&mut self, value: u32) -> Access<()> {
        if value & 3 != 0 {
            return missing("a transmit clock from RK or TK");
        }
        if value >> 8 & 0xF != 0 {
            return missing("a transmit start other than continuous");
        }
        if value >> 16 & 0xFF != 0 {
            return missing("a start delay (STTDLY)");
        }
        self.transmit_clock = value;
        Ok(())
    }

    fn control(&mut self, value: u32, now: Cycles, clocked: bool) -> Access<()> {
        if value & 1 << 15 != 0 {
            self.software_reset();
            return Ok(());
        }
        if value & 3 == 1 {
            return missing("reception");
        }
        if value & 1 << 9 != 0 {
            self.enabled = false;
            self.holding = None;
        } else if value & 1 << 8 != 0 {
            if !clocked {
                return Err(FaultKind::ClockDisabled {
                    peripheral: NAME,
                    identifier: IDENTIFIER,
                });
            }
            self.enabled = true;
            self.start(now);
        }
        Ok(())
    }
}

fn missing<T>(feature: &'static str) -> Access<T> {
    Err(FaultKind::FeatureNotModelled {
        peripheral: NAME,
        feature,
    })
}

fn unknown<T>(offset: u32) -> Access<T> {
    Err(FaultKind::RegisterNotModelled {
        peripheral: NAME,
        offset,
    })
}
