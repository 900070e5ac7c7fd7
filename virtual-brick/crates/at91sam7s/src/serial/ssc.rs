// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Synchronous serial controller, transmitter (AT91SAM7S datasheet, 6175M, chapter 32).
//!
//! The transmitter runs from the divided clock, MCK/(2 DIV), with continuous start: a word is
//! shifted as soon as one waits and the shifter is free, without gaps while words keep coming.
//! Words of up to 8, 16 and 32 bits are fetched as bytes, halfwords and words.

use arm7tdmi::bus::Width;

use crate::board::{Board, Cycles, SoundBits};
use crate::clock::NEVER;
use crate::fault::{clock_disabled, no_register, not_modelled, Access};
use crate::pins::pio::Pio;
use crate::registers::{check_written, flags, number_in_row, registers, unmodelled, Unmodelled};
use crate::serial::pdc::{Pdc, Stream};

registers! {
    SSC_CR = 0x00, SSC_CMR = 0x04, SSC_RCMR = 0x10, SSC_RFMR = 0x14, SSC_TCMR = 0x18,
    SSC_TFMR = 0x1C, SSC_RHR = 0x20, SSC_THR = 0x24, SSC_RSHR = 0x30, SSC_TSHR = 0x34,
    SSC_RC0R = 0x38, SSC_RC1R = 0x3C, SSC_SR = 0x40, SSC_IER = 0x44, SSC_IDR = 0x48,
    SSC_IMR = 0x4C,
}

const NAME: &str = "SSC";
pub(crate) const IDENTIFIER: u8 = 8;
/// Pin of the transmitted data, TD (peripheral A).
pub(crate) const DATA_PIN: u32 = 17;

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

/// Without effect are the receiver's registers and flags, since reception is refused, and what
/// concerns the pins TK and TF, which the board uses otherwise: CKO, CKI, PERIOD, FSLEN, FSEDGE.
/// DATDEF is the level of TD between words: silence.
const UNMODELLED: &[Unmodelled] = &[
    unmodelled(SSC_TCMR, 3, "a transmit clock from RK or TK"),
    unmodelled(SSC_TCMR, 3 << 6, "a gated transmit clock (CKG)"),
    unmodelled(SSC_TCMR, 0xF << 8, "a transmit start other than continuous"),
    unmodelled(SSC_TCMR, 0xFF << 16, "a start delay (STTDLY)"),
    unmodelled(SSC_TFMR, 7 << 20, "a frame synchronisation output (FSOS)"),
    unmodelled(SSC_TFMR, 1 << 23, "frame synchronisation data"),
];
/// Fields of RCMR and TCMR, of RFMR and TFMR.
const CLOCK_FIELDS: [u32; 2] = [0xFFFF_1FFF, 0xFFFF_0FFF];
const FRAME_FIELDS: [u32; 2] = [0x017F_0FBF, 0x01FF_0FBF];

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
    pdc: Pdc,
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
        flags(&[
            (self.enabled && !waiting, TXRDY),
            (self.enabled && !waiting && self.shifting.is_none(), TXEMPTY),
            (self.pdc.transmit.ended(), ENDTX),
            (self.pdc.transmit.exhausted(), TXBUFE),
            (self.pdc.receive.ended(), ENDRX),
            (self.pdc.receive.exhausted(), RXBUFF),
            (self.frame_started, TXSYN),
            (self.enabled, TXEN),
        ])
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

    /// Pass the word whose last bit has just ended to the board, if the pin belongs to the
    /// controller; true when the board got one.
    pub(crate) fn send<B: Board>(&mut self, at: Cycles, board: &mut B, pio: &Pio) -> bool {
        let sent = self.shifted(at).filter(|_| pio.is_peripheral_a(DATA_PIN));
        if let Some(sound) = sent {
            board.sound_bits(at, sound);
        }
        sent.is_some()
    }

    /// The word whose last bit has just ended, if one has; the next one follows at once.
    fn shifted(&mut self, at: Cycles) -> Option<SoundBits> {
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
            SSC_CR | SSC_RHR | SSC_THR | SSC_RSHR | SSC_IER | SSC_IDR => 0,
            SSC_CMR => self.divider,
            SSC_RCMR => self.receive_clock,
            SSC_RFMR => self.receive_frame,
            SSC_TCMR => self.transmit_clock,
            SSC_TFMR => self.transmit_frame,
            SSC_TSHR => self.synchronisation,
            SSC_RC0R | SSC_RC1R => self.compare[number_in_row(offset, SSC_RC0R)],
            SSC_SR => {
                let value = self.status();
                self.frame_started = false;
                value
            }
            SSC_IMR => self.mask,
            0x100..=0x124 => return self.pdc.read(offset, NAME),
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles, clocked: bool) -> Access {
        check_written(NAME, UNMODELLED, offset, value)?;
        match offset {
            SSC_CR => return self.control(value, now, clocked),
            SSC_CMR => {
                self.divider = value & 0xFFF;
                self.start(now);
            }
            SSC_RCMR => self.receive_clock = value & CLOCK_FIELDS[0],
            SSC_RFMR => self.receive_frame = value & FRAME_FIELDS[0],
            SSC_TCMR => self.transmit_clock = value & CLOCK_FIELDS[1],
            SSC_TFMR => self.transmit_frame = value & FRAME_FIELDS[1],
            SSC_THR => return self.transmit(value, now),
            SSC_TSHR => self.synchronisation = value & 0xFFFF,
            SSC_RC0R | SSC_RC1R => self.compare[number_in_row(offset, SSC_RC0R)] = value & 0xFFFF,
            SSC_IER => self.mask |= value & MASKABLE,
            SSC_IDR => self.mask &= !value,
            SSC_RHR | SSC_RSHR | SSC_SR | SSC_IMR => {}
            0x100..=0x124 => return self.pdc.write(offset, value, NAME),
            _ => return no_register(NAME, offset),
        }
        Ok(())
    }

    fn control(&mut self, value: u32, now: Cycles, clocked: bool) -> Access {
        if value & 1 << 15 != 0 {
            self.software_reset();
            return Ok(());
        }
        if value & 3 == 1 {
            return not_modelled(NAME, "reception");
        }
        if value & 1 << 9 != 0 {
            self.enabled = false;
            self.holding = None;
        } else if value & 1 << 8 != 0 {
            if !clocked {
                return clock_disabled(NAME, IDENTIFIER);
            }
            self.enabled = true;
            self.start(now);
        }
        Ok(())
    }
}

impl Stream for Ssc {
    fn name(&self) -> &'static str {
        NAME
    }

    fn pdc(&mut self) -> &mut Pdc {
        &mut self.pdc
    }

    fn transfer_width(&self) -> Width {
        match self.bits() {
            1..=8 => Width::Byte,
            9..=16 => Width::Halfword,
            _ => Width::Word,
        }
    }

    fn wants_data(&self) -> bool {
        self.enabled && self.holding.is_none() && self.pdc.transmit.ready()
    }

    fn transmit(&mut self, value: u32, now: Cycles) -> Access {
        if !self.enabled {
            return Ok(());
        }
        if self.bits() == 1 {
            return not_modelled(NAME, "a data length of 1 bit (DATLEN = 0)");
        }
        self.holding = Some(value);
        self.start(now);
        Ok(())
    }
}
