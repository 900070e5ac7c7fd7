// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Serial peripheral interface, master (AT91SAM7S datasheet, 6175M, chapter 28).
//!
//! A frame occupies DLYBS (when its chip select was inactive), its bits at MCK/SCBR, then
//! 32 times DLYBCT. The data register moves to the shifter at the end of that delay; the chip
//! select stays active from frame to frame as long as data are waiting.

use crate::board::Cycles;
use crate::fault::{Access, FaultKind};
use crate::pdc::Pdc;
use crate::NEVER;

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
const LASTXFER: u32 = 1 << 24;
/// Shortest delay between two chip selects.
const LEAST_SELECT_DELAY: Cycles = 6;

pub(crate) const NAME: &str = "SPI";
pub(crate) const IDENTIFIER: u8 = 5;

/// One frame as the board sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Frame {
    pub(crate) select: u8,
    pub(crate) data: u16,
    pub(crate) bits: u8,
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
    pub(crate) pdc: Pdc,
}

impl Spi {
    pub(crate) fn new() -> Self {
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
            pdc: Pdc::new(),
        }
    }

    /// Software reset: everything but the data controller.
    fn software_reset(&mut self) {
        let pdc = self.pdc.clone();
        *self = Self { pdc, ..Self::new() };
    }

    /// Status flags without side effects.
    fn status(&self) -> u32 {
        let idle = matches!(self.phase, Phase::Idle);
        let flags = [
            (self.received, RDRF),
            (self.enabled && self.transmit.is_none(), TDRE),
            (self.overrun, OVRES),
            (self.pdc.receive.ended(), ENDRX),
            (self.pdc.transmit.ended(), ENDTX),
            (self.pdc.receive.exhausted(), RXBUFF),
            (self.pdc.transmit.exhausted(), TXBUFE),
            (self.enabled && self.transmit.is_none() && idle, TXEMPTY),
            (self.enabled, SPIENS),
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
        match self.phase {
            Phase::Idle => NEVER,
            Phase::Shift { end, .. } | Phase::Delay { end } => end,
        }
    }

    /// The data controller may write the transmit register.
    pub(crate) fn wants_data(&self) -> bool {
        self.enabled && self.transmit.is_none() && self.pdc.transmit.ready()
    }

    /// The data controller may read the receive register.
    pub(crate) fn has_data(&self) -> bool {
        self.received && self.pdc.receive.ready()
    }

    /// Size in bytes of one data controller transfer.
    pub(crate) fn transfer_size(&self) -> u32 {
        if self.mode & PS != 0 {
            4
        } else if self.bits(self.fixed_select()) > 8 {
            2
        } else {
            1
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

    /// Put a word in the transmit register.
    pub(crate) fn transmit(&mut self, value: u32, now: Cycles) -> Access<()> {
        let missing = |feature| {
            Err(FaultKind::FeatureNotModelled {
                peripheral: NAME,
                feature,
            })
        };
        if !self.enabled {
            return Ok(());
        }
        if self.mode & MSTR == 0 {
            return missing("slave mode");
        }
        if self.mode & PCSDEC != 0 {
            return missing("an external chip select decoder");
        }
        self.transmit = Some(value);
        self.start(now)
    }

    /// Begin a frame if the shifter is free and a word waits.
    fn start(&mut self, now: Cycles) -> Access<()> {
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
            return Err(FaultKind::FeatureNotModelled {
                peripheral: NAME,
                feature: "SCBR = 0",
            });
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
                data: word as u16,
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

    /// The frame whose last bit has just been shifted, if one has.
    pub(crate) fn shifted(&mut self, at: Cycles) -> Option<Frame> {
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
    pub(crate) fn receive(&mut self, frame: Frame, answer: u16) {
        let value = if self.mode & LLB != 0 {
            frame.data
        } else {
            answer
        };
        let kept = u32::from(value) & ((1u32 << frame.bits) - 1);
        self.overrun |= self.received;
        self.received = true;
        self.receive = kept | self.mode & 0x000F_0000;
    }

    /// Read the receive register.
    pub(crate) fn take_received(&mut self) -> u32 {
        self.received = false;
        self.receive
    }

    /// End the delay after a frame and begin the next.
    pub(crate) fn continue_at(&mut self, at: Cycles) -> Access<()> {
        if matches!(self.phase, Phase::Delay { end } if end <= at) {
            self.phase = Phase::Idle;
            return self.start(at);
        }
        Ok(())
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x0C | 0x14 | 0x18 => 0,
            0x04 => self.mode,
            0x08 => self.take_received(),
            0x10 => {
                let value = self.status();
                self.overrun = false;
                value
            }
            0x1C => self.mask,
            0x30 | 0x34 | 0x38 | 0x3C => self.chip_select[offset as usize / 4 - 12],
            0x100..=0x124 => return self.pdc.read(offset, NAME),
            _ => {
                return Err(FaultKind::RegisterNotModelled {
                    peripheral: NAME,
                    offset,
                })
            }
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
            0x00 => return self.control(value, clocked),
            0x04 => self.mode = value & 0xFF0F_009F,
            0x0C => return self.transmit(value, now),
            0x14 => self.mask |= value & 0x3FF,
            0x18 => self.mask &= !value,
            0x30 | 0x34 | 0x38 | 0x3C => self.chip_select[offset as usize / 4 - 12] = value,
            0x08 | 0x10 | 0x1C => {}
            0x100..=0x124 => return self.pdc.write(offset, value, NAME),
            _ => {
                return Err(FaultKind::RegisterNotModelled {
                    peripheral: NAME,
                    offset,
                })
            }
        }
        Ok(())
    }

    fn control(&mut self, value: u32, clocked: bool) -> Access<()> {
        if value & 1 << 7 != 0 {
            self.software_reset();
        }
        if value & 1 << 1 != 0 {
            self.enabled = false;
        } else if value & 1 << 0 != 0 {
            if !clocked {
                return Err(FaultKind::ClockDisabled {
                    peripheral: NAME,
                    identifier: IDENTIFIER,
                });
            }
            self.enabled = true;
        }
        if value & LASTXFER != 0 {
            self.release_after = true;
        }
        Ok(())
    }
}

/// PCS without decoder: the lowest zero bit selects; 4 when all are one.
fn decode_select(field: u32) -> u8 {
    (!field & 0xF | 0x10).trailing_zeros() as u8
}
