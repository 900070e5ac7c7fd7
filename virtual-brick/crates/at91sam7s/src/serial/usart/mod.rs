// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Asynchronous serial lines: USART0, USART1 (AT91SAM7S datasheet, 6175M, chapter 31) and the
//! line of the debug unit (chapter 26), which is a USART with fewer registers.
//!
//! Normal, RS485 and hardware handshaking modes. A character lasts its start bit, data, parity,
//! stop bits and time guard. The line of a port with CD = 0 has no clock and stands still.

use arm7tdmi::bus::Width;

use crate::board::{Character, Cycles, SerialPort};
use crate::clock::NEVER;
use crate::fault::Access;
use crate::registers::flags;
use crate::serial::pdc::{Pdc, Stream};

mod control;
mod registers;

const RXRDY: u32 = 1 << 0;
const TXRDY: u32 = 1 << 1;
const ENDRX: u32 = 1 << 3;
const ENDTX: u32 = 1 << 4;
const OVRE: u32 = 1 << 5;
const FRAME: u32 = 1 << 6;
const TIMEOUT: u32 = 1 << 8;
const TXEMPTY: u32 = 1 << 9;
const TXBUFE: u32 = 1 << 11;
const RXBUFF: u32 = 1 << 12;
/// RIIC, DSRIC, DCDIC, CTSIC: a modem line changed since the status was last read.
const MODEM_CHANGES: u32 = 0xF << 16;
/// Levels of the modem lines.
pub(crate) const RI: u32 = 1 << 20;
pub(crate) const DSR: u32 = 1 << 21;
pub(crate) const DCD: u32 = 1 << 22;
pub(crate) const CTS: u32 = 1 << 23;

/// Line coding that a mode register asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handshake {
    None,
    Rs485,
    Hardware,
}

/// A character in the transmit shifter.
#[derive(Clone, Copy, Debug)]
struct Shifting {
    character: Character,
    /// End of the last stop bit.
    sent: Cycles,
    /// End of the time guard.
    end: Cycles,
    reported: bool,
}

/// One serial line.
#[derive(Clone, Debug)]
pub(crate) struct Usart {
    port: SerialPort,
    receiver: bool,
    transmitter: bool,
    mode: u32,
    mask: u32,
    divider: u32,
    time_out: u32,
    time_guard: u32,
    fi_over_di: u32,
    filter: u32,
    force_ntrst: u32,
    /// OVRE, FRAME, TIMEOUT and the changes of the modem lines.
    flags: u32,
    modem: u32,
    request_to_send: bool,
    received: Option<u16>,
    last: u16,
    holding: Option<u16>,
    shifting: Option<Shifting>,
    time_out_at: Cycles,
    pdc: Pdc,
}

impl Usart {
    pub(crate) fn new(port: SerialPort) -> Self {
        Self {
            port,
            receiver: false,
            transmitter: false,
            mode: 0,
            mask: 0,
            divider: 0,
            time_out: 0,
            time_guard: 0,
            fi_over_di: 0x174,
            filter: 0,
            force_ntrst: 0,
            flags: 0,
            modem: 0,
            request_to_send: false,
            received: None,
            last: 0,
            holding: None,
            shifting: None,
            time_out_at: NEVER,
            pdc: Pdc::new(),
        }
    }

    fn is_debug_unit(&self) -> bool {
        self.port == SerialPort::DebugUnit
    }

    fn handshake(&self) -> Handshake {
        match (self.is_debug_unit(), self.mode & 0xF) {
            (false, 1) => Handshake::Rs485,
            (false, 2) => Handshake::Hardware,
            _ => Handshake::None,
        }
    }

    /// Duration of one bit; nothing when the baud rate generator is off.
    fn bit_cycles(&self) -> Option<Cycles> {
        let whole = Cycles::from(self.divider & 0xFFFF);
        if whole == 0 {
            return None;
        }
        if self.is_debug_unit() {
            return Some(16 * whole);
        }
        // Sixteen or eight samples per bit, times CD + FP/8.
        let samples = if self.mode & 1 << 19 != 0 { 1 } else { 2 };
        let before = if self.mode >> 4 & 3 == 1 { 8 } else { 1 };
        Some(before * samples * (8 * whole + Cycles::from(self.divider >> 16 & 7)))
    }

    fn data_bits(&self) -> u32 {
        if self.is_debug_unit() {
            8
        } else if self.mode & 1 << 17 != 0 {
            9
        } else {
            5 + (self.mode >> 6 & 3)
        }
    }

    /// Half bits from the start bit to the end of the last stop bit.
    fn half_bits(&self) -> Cycles {
        let parity = u32::from(self.mode >> 9 & 7 < 4);
        let stop = if self.is_debug_unit() {
            2
        } else {
            2 + (self.mode >> 12 & 3).min(2)
        };
        Cycles::from(2 * (1 + self.data_bits() + parity) + stop)
    }

    fn status(&self) -> u32 {
        let idle = self.transmitter && self.holding.is_none() && self.shifting.is_none();
        let standing = flags(&[
            (self.received.is_some(), RXRDY),
            (self.transmitter && self.holding.is_none(), TXRDY),
            (self.pdc.receive.ended(), ENDRX),
            (self.pdc.transmit.ended(), ENDTX),
            (idle, TXEMPTY),
            (self.pdc.transmit.exhausted(), TXBUFE),
            (self.pdc.receive.exhausted(), RXBUFF),
        ]);
        standing | self.flags | self.modem
    }

    /// The data controller may write memory.
    pub(crate) fn stores_data(&self) -> bool {
        self.pdc.receive.ready()
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status() & self.mask != 0
    }

    pub(crate) fn next_event(&self) -> Cycles {
        let shifter = self.shifting.map_or(NEVER, |shifting| {
            if shifting.reported {
                shifting.end
            } else {
                shifting.sent
            }
        });
        shifter.min(self.time_out_at)
    }

    /// Level of the RTS pin. In hardware handshaking it is low while characters may come, in
    /// RS485 mode it is high while characters leave.
    pub(crate) fn rts_level(&self) -> bool {
        match self.handshake() {
            Handshake::None => !self.request_to_send,
            Handshake::Rs485 => self.holding.is_some() || self.shifting.is_some(),
            Handshake::Hardware => !self.receiver || self.pdc.receive.exhausted(),
        }
    }

    /// Levels of the modem lines; a change is flagged unless it comes from a reset.
    pub(crate) fn set_modem_lines(&mut self, levels: u32, flag: bool, now: Cycles) {
        if flag {
            self.flags |= (self.modem ^ levels) >> 4;
        } else {
            self.flags &= !MODEM_CHANGES;
        }
        self.modem = levels;
        self.start(now);
    }

    /// Shift the waiting character if the shifter is free and the other side is ready.
    fn start(&mut self, now: Cycles) {
        let held = self.handshake() == Handshake::Hardware && self.modem & CTS != 0;
        if self.shifting.is_some() || held {
            return;
        }
        let Some(bit_cycles) = self.bit_cycles() else {
            return;
        };
        let Some(value) = self.holding.take() else {
            return;
        };
        let data = if self.mode & 1 << 16 != 0 && !self.is_debug_unit() {
            value.reverse_bits() >> (16 - self.data_bits())
        } else {
            value
        };
        let sent = now + self.half_bits() * bit_cycles / 2;
        self.shifting = Some(Shifting {
            character: Character { data, bit_cycles },
            sent,
            end: sent + Cycles::from(self.time_guard) * bit_cycles,
            reported: false,
        });
    }

    /// The character whose last stop bit has just ended, if one has.
    pub(crate) fn shifted(&mut self, at: Cycles) -> Option<Character> {
        let shifting = self.shifting.as_mut()?;
        if shifting.reported || shifting.sent > at {
            return None;
        }
        shifting.reported = true;
        let character = shifting.character;
        if self.mode >> 14 & 3 == 2 {
            self.arrived(character, at);
            return None;
        }
        Some(character)
    }

    /// End the time guard and begin the next character; let the time-out run out.
    pub(crate) fn continue_at(&mut self, at: Cycles) {
        if self.shifting.is_some_and(|s| s.reported && s.end <= at) {
            self.shifting = None;
            self.start(at);
        }
        if self.time_out_at <= at {
            self.time_out_at = NEVER;
            self.flags |= TIMEOUT;
        }
    }

    /// A character came in from outside, unless the line is looped back.
    pub(crate) fn receive(&mut self, character: Character, at: Cycles) {
        if self.mode >> 14 & 3 == 0 {
            self.arrived(character, at);
        }
    }

    /// A character ended on the line. One whose bits are more than 5 % off is a framing error.
    fn arrived(&mut self, character: Character, at: Cycles) {
        let Some(bit_cycles) = self.bit_cycles() else {
            return;
        };
        if !self.receiver {
            return;
        }
        if character.bit_cycles.abs_diff(bit_cycles) * 20 > bit_cycles {
            self.flags |= FRAME;
        }
        if self.received.is_some() {
            self.flags |= OVRE;
        }
        let bits = self.data_bits();
        let data = if self.mode & 1 << 16 != 0 && !self.is_debug_unit() {
            character.data.reverse_bits() >> (16 - bits)
        } else {
            character.data
        };
        self.last = data & ((1 << bits) - 1);
        self.received = Some(self.last);
        self.restart_time_out(at);
    }

    /// Reload the time-out counter and let it run.
    fn restart_time_out(&mut self, at: Cycles) {
        self.time_out_at = match (self.time_out, self.bit_cycles()) {
            (0, _) | (_, None) => NEVER,
            (bits, Some(bit_cycles)) => at + Cycles::from(bits) * bit_cycles,
        };
    }
}

impl Stream for Usart {
    fn name(&self) -> &'static str {
        match self.port {
            SerialPort::Usart0 => "USART0",
            SerialPort::Usart1 => "USART1",
            SerialPort::DebugUnit => "DBGU",
        }
    }

    fn pdc(&mut self) -> &mut Pdc {
        &mut self.pdc
    }

    fn transfer_width(&self) -> Width {
        if self.data_bits() > 8 {
            Width::Halfword
        } else {
            Width::Byte
        }
    }

    fn wants_data(&self) -> bool {
        self.transmitter && self.holding.is_none() && self.pdc.transmit.ready()
    }

    /// A character that waits already stays.
    fn transmit(&mut self, value: u32, now: Cycles) -> Access {
        if self.transmitter && self.holding.is_none() {
            self.holding = Some((value & ((1 << self.data_bits()) - 1)) as u16);
            self.start(now);
        }
        Ok(())
    }

    fn has_data(&self) -> bool {
        self.received.is_some() && self.pdc.receive.ready()
    }

    fn take_received(&mut self) -> u32 {
        self.received = None;
        u32::from(self.last)
    }
}
