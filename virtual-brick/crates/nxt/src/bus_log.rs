// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A record of what passes on the chip's buses, for driver tests.

use std::fmt;

use at91sam7s::board::{Cycles, SerialPort};

/// Something that passed on a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusEvent {
    /// START and address byte on the two-wire bus.
    TwiStart {
        /// The byte: twice the address, one more for a read.
        byte: u8,
        /// It was acknowledged.
        acknowledged: bool,
    },
    /// A byte to the slave.
    TwiWritten {
        /// The byte.
        byte: u8,
        /// It was acknowledged.
        acknowledged: bool,
    },
    /// A byte from the slave.
    TwiRead(u8),
    /// STOP.
    TwiStop,
    /// A frame to the display.
    Display {
        /// Its data line is high.
        data: bool,
        /// The frame.
        frame: u16,
    },
    /// A character left a serial line.
    Sent(SerialPort, u8),
    /// A character reached the chip on a serial line.
    Received(SerialPort, u8),
    /// The chip's converter took a channel's count.
    Converted {
        /// Channel, 0 to 7.
        channel: u8,
        /// Count, 0 to 1023.
        count: u16,
    },
    /// A command to the flash controller.
    Flash {
        /// Its code, 0 to 15.
        command: u8,
        /// Page or bit.
        page: u16,
    },
}

impl fmt::Display for BusEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = |acknowledged: bool| if acknowledged { 'a' } else { 'n' };
        match *self {
            Self::TwiStart { byte, acknowledged } => {
                write!(f, "twi S {byte:02X}{}", mark(acknowledged))
            }
            Self::TwiWritten { byte, acknowledged } => {
                write!(f, "twi {byte:02X}{}", mark(acknowledged))
            }
            Self::TwiRead(byte) => write!(f, "twi {byte:02X}"),
            Self::TwiStop => write!(f, "twi P"),
            Self::Display { data, frame } => {
                let kind = if data { "data" } else { "command" };
                write!(f, "display {kind} {frame:02X}")
            }
            Self::Sent(port, byte) => write!(f, "{} out {byte:02X}", name(port)),
            Self::Received(port, byte) => write!(f, "{} in {byte:02X}", name(port)),
            Self::Converted { channel, count } => write!(f, "adc {channel} {count}"),
            Self::Flash { command, page } => write!(f, "flash {command:X} {page}"),
        }
    }
}

const fn name(port: SerialPort) -> &'static str {
    match port {
        SerialPort::Usart0 => "usart0",
        SerialPort::Usart1 => "usart1",
        SerialPort::DebugUnit => "dbgu",
    }
}

/// The record, once it was asked for.
#[derive(Clone, Debug, Default)]
pub struct BusLog {
    recording: bool,
    events: Vec<(Cycles, BusEvent)>,
}

impl BusLog {
    pub fn record(&mut self) {
        self.recording = true;
    }

    pub fn add(&mut self, now: Cycles, event: BusEvent) {
        if self.recording {
            self.events.push((now, event));
        }
    }

    pub fn take(&mut self) -> Vec<(Cycles, BusEvent)> {
        std::mem::take(&mut self.events)
    }
}
