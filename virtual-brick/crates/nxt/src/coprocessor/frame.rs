// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Frames of the two-wire link.
//!
//! To the co-processor 9 bytes: power, PWM frequency in kHz, four duty cycles in percent (the
//! fourth unused), output mode (bit n: brake motor n), input power, checksum. From it 13 bytes:
//! four port words, button word, battery word (low byte first), checksum. The bytes of a frame
//! add up to 16#FF#. A write that begins with 16#CC# carries the handshake string.

const COMMAND_LENGTH: usize = 9;
const STATUS_LENGTH: usize = 13;
const HANDSHAKE_MARK: u8 = 0xCC;
const HANDSHAKE: &[u8; 46] = b"Let's samba nxt arm in arm, (c)LEGO System A/S";
const POWER_DOWN: u8 = 0x5A;
const BOOT_MONITOR: [u8; 2] = [0xA5, 0x5A];

/// What a motor was told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotorCommand {
    /// Duty cycle in percent as received.
    pub duty: i8,
    /// Winding shorted in the off phase.
    pub brake: bool,
}

/// 9 V supply of a sensor port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorSupply {
    /// Off.
    Off,
    /// On between the samplings.
    Pulsed,
    /// Always on.
    Constant,
}

/// Content of an accepted frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command {
    pub frequency_khz: u8,
    pub motors: [MotorCommand; 3],
    input_power: u8,
    /// What the frame asks of the supply.
    pub request: PowerRequest,
}

impl Command {
    /// What is in force before the first frame: all braked, all ports pulsed, 4 kHz.
    pub const fn at_reset() -> Self {
        let motor = MotorCommand {
            duty: 0,
            brake: true,
        };
        Self {
            frequency_khz: 4,
            motors: [motor; 3],
            input_power: 0x0F,
            request: PowerRequest::StayOn,
        }
    }

    /// What is in force without supply: all motors open.
    pub const fn off() -> Self {
        let motor = MotorCommand {
            duty: 0,
            brake: false,
        };
        Self {
            motors: [motor; 3],
            ..Self::at_reset()
        }
    }

    pub const fn sensor_supply(&self, port: usize) -> SensorSupply {
        match (
            self.input_power >> (port + 4) & 1,
            self.input_power >> port & 1,
        ) {
            (0, 0) => SensorSupply::Off,
            (0, _) => SensorSupply::Pulsed,
            _ => SensorSupply::Constant,
        }
    }

    fn decode(bytes: &[u8; COMMAND_LENGTH]) -> Self {
        let motor = |index: usize| MotorCommand {
            duty: i8::from_le_bytes([bytes[2 + index]]),
            brake: bytes[6] >> index & 1 != 0,
        };
        Self {
            frequency_khz: bytes[1],
            motors: [motor(0), motor(1), motor(2)],
            input_power: bytes[7],
            request: match [bytes[0], bytes[1]] {
                [POWER_DOWN, _] => PowerRequest::PowerDown,
                BOOT_MONITOR => PowerRequest::BootMonitor,
                _ => PowerRequest::StayOn,
            },
        }
    }
}

/// What a byte completes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// Nothing, or the handshake so far.
    Part,
    Handshake,
    Command(Command),
    /// A frame with a wrong sum.
    BadFrame,
}

/// The first bytes of a frame with outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerRequest {
    StayOn,
    PowerDown,
    BootMonitor,
}

/// A write while its bytes come in. Bytes beyond the frame are ignored.
#[derive(Clone, Copy, Debug, Default)]
pub struct Incoming {
    count: usize,
    bytes: [u8; COMMAND_LENGTH],
    /// A byte of the handshake string was wrong.
    mismatch: bool,
}

impl Incoming {
    /// Takes one byte; tells what it completes.
    pub fn push(&mut self, byte: u8) -> Received {
        let index = self.count;
        self.count += 1;
        if let Some(place) = self.bytes.get_mut(index) {
            *place = byte;
        }
        if self.bytes[0] == HANDSHAKE_MARK {
            return self.push_handshake(index, byte);
        }
        match self.count {
            COMMAND_LENGTH if sum(&self.bytes) == 0xFF => {
                Received::Command(Command::decode(&self.bytes))
            }
            COMMAND_LENGTH => Received::BadFrame,
            _ => Received::Part,
        }
    }

    fn push_handshake(&mut self, index: usize, byte: u8) -> Received {
        let expected = index.checked_sub(1).and_then(|place| HANDSHAKE.get(place));
        self.mismatch |= expected.is_some_and(|expected| byte != *expected);
        if index == HANDSHAKE.len() && !self.mismatch {
            Received::Handshake
        } else {
            Received::Part
        }
    }
}

/// A read while its bytes go out. Beyond the frame the last byte is repeated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outgoing {
    next: usize,
    bytes: [u8; STATUS_LENGTH],
}

impl Outgoing {
    pub fn new(words: [u16; 6]) -> Self {
        let mut bytes = [0; STATUS_LENGTH];
        for (pair, word) in bytes.chunks_exact_mut(2).zip(words) {
            pair.copy_from_slice(&word.to_le_bytes());
        }
        bytes[STATUS_LENGTH - 1] = !sum(&bytes);
        Self { next: 0, bytes }
    }

    /// Makes the checksum wrong.
    pub fn corrupt_checksum(&mut self) {
        self.bytes[STATUS_LENGTH - 1] ^= 1;
    }

    /// Nothing was sent yet.
    pub const fn is_whole(&self) -> bool {
        self.next == 0
    }

    pub fn next_byte(&mut self) -> u8 {
        let byte = self.bytes[self.next];
        self.next = (self.next + 1).min(STATUS_LENGTH - 1);
        byte
    }
}

fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
}
