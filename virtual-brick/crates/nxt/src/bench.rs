// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The measuring bench: a record of what passes on the chip's buses, and scripts that answer there
//! instead of the devices.

use std::collections::VecDeque;
use std::fmt;

use at91sam7s::board::{Character, Cycles, SerialPort, TwiReply};

use crate::bluetooth::BIT_CYCLES;
use crate::time::NEVER;

/// Start bit, eight data bits, stop bit.
const CHARACTER_CYCLES: Cycles = 10 * BIT_CYCLES;

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

/// How a scripted slave of the two-wire bus answers one START.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TwiTurn {
    /// Bytes that it acknowledges, the address included.
    pub acknowledged: usize,
    /// What it gives; FF after the last.
    pub data: Vec<u8>,
    /// How long it holds the clock after each byte.
    pub stretch_cycles: Cycles,
}

/// The script of the two-wire bus: after its last turn nobody acknowledges.
#[derive(Clone, Debug, Default)]
pub struct TwiScript {
    turns: VecDeque<TwiTurn>,
    current: TwiTurn,
    given: usize,
}

impl TwiScript {
    pub fn new(turns: Vec<TwiTurn>) -> Self {
        Self {
            turns: turns.into(),
            ..Self::default()
        }
    }

    pub fn start(&mut self) -> TwiReply {
        self.current = self.turns.pop_front().unwrap_or_default();
        self.given = 0;
        self.written()
    }

    pub fn written(&mut self) -> TwiReply {
        let acknowledged = self.current.acknowledged > 0;
        self.current.acknowledged = self.current.acknowledged.saturating_sub(1);
        TwiReply {
            acknowledged,
            stretch_cycles: self.current.stretch_cycles,
        }
    }

    pub fn read(&mut self) -> (u8, Cycles) {
        let byte = self.current.data.get(self.given).copied().unwrap_or(0xFF);
        self.given += 1;
        (byte, self.current.stretch_cycles)
    }
}

/// The record and the scripts in force.
#[derive(Clone, Debug, Default)]
pub struct Bench {
    recording: bool,
    log: Vec<(Cycles, BusEvent)>,
    pub twi: Option<TwiScript>,
    /// Counts of the converter's channels, the last one for good.
    counts: [VecDeque<u16>; 8],
    module: Option<ModuleScript>,
}

impl Bench {
    pub fn record(&mut self) {
        self.recording = true;
    }

    pub fn note(&mut self, now: Cycles, event: BusEvent) {
        if self.recording {
            self.log.push((now, event));
        }
    }

    pub fn take_log(&mut self) -> Vec<(Cycles, BusEvent)> {
        std::mem::take(&mut self.log)
    }

    pub fn script_converter(&mut self, channel: u8, counts: &[u16]) {
        self.counts[usize::from(channel & 7)] = counts.iter().copied().collect();
    }

    /// The next scripted count of a channel.
    pub fn count(&mut self, channel: u8) -> Option<u16> {
        let counts = &mut self.counts[usize::from(channel & 7)];
        if counts.len() > 1 {
            counts.pop_front()
        } else {
            counts.front().copied()
        }
    }

    /// From now on these turns stand for the Bluetooth module.
    pub fn script_module(&mut self, now: Cycles, turns: Vec<ModuleTurn>) {
        let script = self.module.insert(ModuleScript {
            turns: turns.into(),
            ..ModuleScript::default()
        });
        script.answer(now);
    }

    pub fn module(&mut self) -> Option<&mut ModuleScript> {
        self.module.as_mut()
    }

    pub fn next_event(&self) -> Cycles {
        self.module.as_ref().map_or(NEVER, ModuleScript::next_event)
    }
}

/// What a scripted module sends after the program has sent so much.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleTurn {
    /// Bytes that the program sends since the turn before.
    pub after_bytes: usize,
    /// From the last of them to the begin of the answer.
    pub delay_cycles: Cycles,
    /// The answer.
    pub bytes: Vec<u8>,
}

/// A script in place of the Bluetooth module.
#[derive(Clone, Debug, Default)]
pub struct ModuleScript {
    turns: VecDeque<ModuleTurn>,
    heard: usize,
    outgoing: VecDeque<(Cycles, Character)>,
}

impl ModuleScript {
    /// A byte of the program.
    pub fn hear(&mut self, now: Cycles) {
        self.heard += 1;
        self.answer(now);
    }

    fn answer(&mut self, now: Cycles) {
        while self
            .turns
            .front()
            .is_some_and(|turn| turn.after_bytes <= self.heard)
        {
            let Some(turn) = self.turns.pop_front() else {
                return;
            };
            self.heard = 0;
            let free_at = self.outgoing.back().map_or(now, |(at, _)| *at);
            let mut ends = free_at.max(now) + turn.delay_cycles;
            for byte in turn.bytes {
                ends += CHARACTER_CYCLES;
                let character = Character {
                    data: u16::from(byte),
                    bit_cycles: BIT_CYCLES,
                };
                self.outgoing.push_back((ends, character));
            }
        }
    }

    fn next_event(&self) -> Cycles {
        self.outgoing.front().map_or(NEVER, |(at, _)| *at)
    }

    /// The character that has reached the chip by now.
    pub fn take(&mut self, now: Cycles) -> Option<Character> {
        if self.next_event() > now {
            return None;
        }
        self.outgoing.pop_front().map(|(_, character)| character)
    }
}
