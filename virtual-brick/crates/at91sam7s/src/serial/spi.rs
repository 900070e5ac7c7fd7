// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Serial peripheral interface, master (AT91SAM7S datasheet, 6175M, chapter 28).
//!
//! A frame occupies DLYBS (when its chip select was inactive), its bits at MCK/SCBR, then
//! 32 times DLYBCT. The data register moves to the shifter at the end of that delay; the chip
//! select stays active from frame to frame as long as data are waiting.

use arm7tdmi::bus::Width;

use crate::board::Board;
use crate::clock::{Cycles, NEVER};
use crate::fault::{clock_disabled, no_register, not_modelled, Access};
use crate::pins::pio::Pio;
use crate::registers::{check_written, flags, number_in_row, registers, unmodelled, Unmodelled};
use crate::serial::pdc::{Pdc, Stream};

registers! {
    SPI_CR = 0x00, SPI_MR = 0x04, SPI_RDR = 0x08, SPI_TDR = 0x0C, SPI_SR = 0x10,
    SPI_IER = 0x14, SPI_IDR = 0x18, SPI_IMR = 0x1C, SPI_CSR0 = 0x30, SPI_CSR3 = 0x3C,
}

const RDRF: u32 = 1 << 0;
const TDRE: u32 = 1 << 1;
const OVRES: u32 = 1 << 3;
const ENDRX: u32 = 1 << 4;
const ENDTX: u32 = 1 << 5;
const RXBUFF: u32 = 1 << 6;
const TXBUFE: u32 = 1 << 7;
const TXEMPTY: u32 = 1 << 9;
const SPIENS: u32 = 1 << 16;

const MSTR: u32 = 1 << 0;
const PS: u32 = 1 << 1;
const PCSDEC: u32 = 1 << 2;
const FDIV: u32 = 1 << 3;
const LLB: u32 = 1 << 7;
const CSAAT: u32 = 1 << 3;
const CPOL: u32 = 1 << 0;
const NCPHA: u32 = 1 << 1;
const LASTXFER: u32 = 1 << 24;
/// MODFDIS and the flags MODF and NSSR have no effect: no other master drives the board's bus.
const UNMODELLED: &[Unmodelled] = &[unmodelled(
    SPI_MR,
    PCSDEC,
    "an external chip select decoder",
)];
/// Shortest delay between two chip selects.
const LEAST_SELECT_DELAY: Cycles = 6;

const NAME: &str = "SPI";
pub(crate) const IDENTIFIER: u8 = 5;
/// Pins of the data to the slaves and of the clock (peripheral A).
const DATA_PINS: [u32; 2] = [13, 14];
/// Pins of the select lines 0 to 3, as peripheral A and as peripheral B (datasheet, 6175M, PIO
/// controller A multiplexing).
const SELECT_PINS: [(u32, u32); 4] = [
    (1 << 11, 0),
    (1 << 31, 1 << 9),
    (0, 1 << 10 | 1 << 30),
    (0, 1 << 3 | 1 << 5 | 1 << 22),
];

/// One frame as the board sees it; `data` has no more than `bits` bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Frame {
    select: u8,
    data: u16,
    bits: u8,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    Idle,
    Shift {
        frame: Frame,
        end: Cycles,
        delay: Cycles,
    },
    Delay {
        end: Cycles,
    },
}

/// Registers, shifter and data controller.
#[derive(Clone, Debug)]
pub(crate) struct Spi {
    enabled: bool,
    mode: u32,
    chip_select: [u32; 4],
    receive: u32,
    received: bool,
    overrun: bool,
    transmit: Option<u32>,
    mask: u32,
    phase: Phase,
    active_select: Option<u8>,
    release_after: bool,
    /// Erratum: one software reset in a row leaves the chip select unconnected.
    reset_needs_two: bool,
    half_reset: bool,
    pdc: Pdc,
}

impl Spi {
    pub(crate) fn new(reset_needs_two: bool) -> Self {
        Self {
            enabled: false,
            mode: 0,
            chip_select: [0; 4],
            receive: 0,
            received: false,
            overrun: false,
            transmit: None,
            mask: 0,
            phase: Phase::Idle,
            active_select: None,
            release_after: false,
            reset_needs_two,
            half_reset: false,
            pdc: Pdc::new(),
        }
    }

    /// Software reset: everything but the data controller.
    fn software_reset(&mut self) {
        let pdc = self.pdc.clone();
        *self = Self {
            pdc,
            half_reset: self.reset_needs_two && !self.half_reset,
            ..Self::new(self.reset_needs_two)
        };
    }

    /// Status flags without side effects.
    fn status(&self) -> u32 {
        let idle = matches!(self.phase, Phase::Idle);
        flags(&[
            (self.received, RDRF),
            (self.enabled && self.transmit.is_none(), TDRE),
            (self.overrun, OVRES),
            (self.pdc.receive.ended(), ENDRX),
            (self.pdc.transmit.ended(), ENDTX),
            (self.pdc.receive.exhausted(), RXBUFF),
            (self.pdc.transmit.exhausted(), TXBUFE),
            (self.enabled && self.transmit.is_none() && idle, TXEMPTY),
            (self.enabled, SPIENS),
        ])
    }

    /// The data controller may write memory.
    pub(crate) fn stores_data(&self) -> bool {
        self.pdc.receive.ready()
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status() & self.mask != 0
    }

    pub(crate) fn next_event(&self) -> Cycles {
        match self.phase {
            Phase::Idle => NEVER,
            Phase::Shift { end, .. } | Phase::Delay { end } => end,
        }
    }

    fn fixed_select(&self) -> u8 {
        decode_select(self.mode >> 16)
    }

    fn settings(&self, select: u8) -> u32 {
        self.chip_select[usize::from(select & 3)]
    }

    fn bits(&self, select: u8) -> u8 {
        (8 + (self.settings(select) >> 4 & 0xF)).min(16) as u8
    }

    /// Begin a frame if the shifter is free and a word waits.
    fn start(&mut self, now: Cycles) -> Access {
        if !matches!(self.phase, Phase::Idle) {
            return Ok(());
        }
        let Some(word) = self.transmit.take() else {
            if self.release_after {
                self.active_select = None;
            }
            return Ok(());
        };
        let variable = self.mode & PS != 0;
        let select = if variable {
            decode_select(word >> 16)
        } else {
            self.fixed_select()
        };
        let settings = self.settings(select);
        let divider = Cycles::from(settings >> 8 & 0xFF);
        if divider == 0 {
            return not_modelled(NAME, "SCBR = 0");
        }
        if (settings & CPOL != 0) == (settings & NCPHA != 0) {
            return not_modelled(NAME, "a slave that samples at falling edges (CPOL = NCPHA)");
        }
        let period = if self.mode & FDIV != 0 {
            32 * divider
        } else {
            divider
        };
        let bits = self.bits(select);
        let lead = self.lead(select, settings, period);
        self.active_select = Some(select);
        self.release_after = settings & CSAAT == 0 || (variable && word & LASTXFER != 0);
        self.phase = Phase::Shift {
            frame: Frame {
                select,
                data: cut(word, bits),
                bits,
            },
            end: now + lead + Cycles::from(bits) * period,
            delay: 32 * Cycles::from(settings >> 24),
        };
        Ok(())
    }

    /// Cycles from loading the shifter to the first clock edge.
    fn lead(&self, select: u8, settings: u32, period: Cycles) -> Cycles {
        let before_clock = match Cycles::from(settings >> 16 & 0xFF) {
            0 => period / 2,
            delay => delay,
        };
        match self.active_select {
            Some(active) if active == select => 0,
            Some(_) => before_clock + Cycles::from(self.mode >> 24).max(LEAST_SELECT_DELAY),
            None => before_clock,
        }
    }

    /// Exchange the frame whose last bit has just been shifted with the board; false when none
    /// has.
    pub(crate) fn exchange<B: Board>(&mut self, at: Cycles, board: &mut B, pio: &Pio) -> bool {
        let Some(frame) = self.shifted(at) else {
            return false;
        };
        let answer = if DATA_PINS.iter().all(|&pin| pio.is_peripheral_a(pin)) {
            let select = usize::from(frame.select);
            let (a, b) = SELECT_PINS.get(select).copied().unwrap_or_default();
            let selected = if self.half_reset {
                0
            } else {
                pio.given_to_peripherals(a, b)
            };
            board.spi_frame(at, selected, frame.data, frame.bits)
        } else {
            0
        };
        self.receive(frame, answer);
        true
    }

    /// The frame whose last bit has just been shifted, if one has.
    fn shifted(&mut self, at: Cycles) -> Option<Frame> {
        let Phase::Shift { frame, end, delay } = self.phase else {
            return None;
        };
        if end > at {
            return None;
        }
        self.phase = Phase::Delay { end: end + delay };
        Some(frame)
    }

    /// Store what came in while `frame` went out.
    fn receive(&mut self, frame: Frame, answer: u16) {
        let value = if self.mode & LLB != 0 {
            frame.data
        } else {
            answer
        };
        let kept = u32::from(cut(value.into(), frame.bits));
        self.overrun |= self.received;
        self.received = true;
        self.receive = kept | self.mode & 0x000F_0000;
    }

    /// End the delay after a frame and begin the next.
    pub(crate) fn continue_at(&mut self, at: Cycles) -> Access {
        if matches!(self.phase, Phase::Delay { end } if end <= at) {
            self.phase = Phase::Idle;
            return self.start(at);
        }
        Ok(())
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            SPI_CR | SPI_TDR | SPI_IER | SPI_IDR => 0,
            SPI_MR => self.mode,
            SPI_RDR => self.take_received(),
            SPI_SR => {
                let value = self.status();
                self.overrun = false;
                value
            }
            SPI_IMR => self.mask,
            SPI_CSR0..=SPI_CSR3 => self.chip_select[number_in_row(offset, SPI_CSR0)],
            0x100..=0x124 => return self.pdc.read(offset, NAME),
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles, clocked: bool) -> Access {
        check_written(NAME, UNMODELLED, offset, value)?;
        match offset {
            SPI_CR => return self.control(value, clocked),
            SPI_MR => self.mode = value & 0xFF0F_009F,
            SPI_TDR => return self.transmit(value, now),
            SPI_IER => self.mask |= value & 0x3FF,
            SPI_IDR => self.mask &= !value,
            SPI_CSR0..=SPI_CSR3 => {
                self.chip_select[number_in_row(offset, SPI_CSR0)] = value & !(1 << 2);
            }
            SPI_RDR | SPI_SR | SPI_IMR => {}
            0x100..=0x124 => return self.pdc.write(offset, value, NAME),
            _ => return no_register(NAME, offset),
        }
        Ok(())
    }

    fn control(&mut self, value: u32, clocked: bool) -> Access {
        if value & 1 << 7 != 0 {
            self.software_reset();
        }
        if value & 1 << 1 != 0 {
            self.enabled = false;
        } else if value & 1 << 0 != 0 {
            if !clocked {
                return clock_disabled(NAME, IDENTIFIER);
            }
            self.enabled = true;
        }
        if value & LASTXFER != 0 {
            self.release_after = true;
        }
        Ok(())
    }
}

impl Stream for Spi {
    fn name(&self) -> &'static str {
        NAME
    }

    fn pdc(&mut self) -> &mut Pdc {
        &mut self.pdc
    }

    fn transfer_width(&self) -> Width {
        if self.mode & PS != 0 {
            Width::Word
        } else if self.bits(self.fixed_select()) > 8 {
            Width::Halfword
        } else {
            Width::Byte
        }
    }

    fn wants_data(&self) -> bool {
        self.enabled && self.transmit.is_none() && self.pdc.transmit.ready()
    }

    fn transmit(&mut self, value: u32, now: Cycles) -> Access {
        if !self.enabled {
            return Ok(());
        }
        if self.mode & MSTR == 0 {
            return not_modelled(NAME, "slave mode");
        }
        self.transmit = Some(value);
        self.start(now)
    }

    fn has_data(&self) -> bool {
        self.received && self.pdc.receive.ready()
    }

    fn take_received(&mut self) -> u32 {
        self.received = false;
        self.receive
    }
}

/// The bits of a data register that a frame of `bits` bits moves, right-justified (section 28.7.4).
fn cut(word: u32, bits: u8) -> u16 {
    (word & ((1 << bits) - 1)) as u16
}

/// PCS without decoder: the lowest zero bit selects; 4 when all are one.
fn decode_select(field: u32) -> u8 {
    (!field & 0xF | 0x10).trailing_zeros() as u8
}
