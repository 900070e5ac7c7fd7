// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The colour sensor: three lamps, a phototransistor and a processor, fed by the port's 4.3 V.
//!
//! The first digital line is its clock, the second one its data, as LEGO's published firmware
//! uses them. A reset is the clock high, low, high and low for a tenth of a second with the data
//! high. Eight bits tell the mode; then each rise of the clock brings a bit of the calibration:
//! three rows of four factors, two limits and a check sum, 54 bytes. From then on the data line
//! carries the phototransistor's voltage. In the full mode each edge of the clock lights the next
//! lamp: none, red, green, blue; in the other modes one lamp stays on or all are off, and the
//! sensor holds the clock low as long as the brick does not drive it.

use at91sam7s::board::Cycles;
use serde::Deserialize;

use super::{Device, Lines};
use crate::time::{microseconds, milliseconds};

/// Count of the co-processor's converter: the sensor grounds that line (chosen; LEGO's firmware
/// takes more than 50 for no sensor).
const PRESENT: u16 = 12;

/// Shortest low clock that is a reset (chosen; LEGO's firmware gives 100 ms).
const RESET: Cycles = milliseconds(80);
/// Shortest half of the clock while the mode is sent (chosen; LEGO's firmware gives 30 us).
const SHORTEST_HALF_PERIOD: Cycles = microseconds(10);
/// Time that the light needs after a lamp was switched (chosen; LEGO's firmware gives 20 us).
const SETTLING: Cycles = microseconds(15);
const MODE_BITS: u8 = 8;

/// Counts of the chip's converter in darkness: LEGO's firmware takes 214 mV of 3.3 V off.
const DARK: f64 = 71.0;
/// Counts from darkness to the strongest light of the surroundings (chosen).
const AMBIENT: f64 = 750.0;
/// Counts that a white surface adds under the red, green and blue lamp (chosen).
const LAMPS: [f64; 3] = [330.0, 255.0, 280.0];
/// Below the second limit of the light of the surroundings a lamp adds all of it, below the first
/// one 90 %, else 80 % (chosen: the phototransistor saturates).
const LIMITS: [u16; 2] = [520, 300];
const SENSITIVITIES: [f64; 3] = [0.8, 0.9, 1.0];
/// What a white surface reads as with the calibration applied.
const WHITE: f64 = 255.0;
/// Share of the light of the surroundings in the same scale.
const BLANK_FACTOR: u32 = 16_336;
const ONE: f64 = 65_536.0;

const CALIBRATION_BYTES: usize = 54;
const CALIBRATION_BITS: u16 = CALIBRATION_BYTES as u16 * 8;

/// A lamp of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lamp {
    Off,
    Red,
    Green,
    Blue,
}

/// What the mode's code asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Each edge of the clock lights the next lamp.
    Full,
    Single(Lamp),
}

impl Mode {
    const fn of(code: u8) -> Option<Self> {
        Some(match code {
            13 => Self::Full,
            14 => Self::Single(Lamp::Red),
            15 => Self::Single(Lamp::Green),
            16 => Self::Single(Lamp::Blue),
            17 => Self::Single(Lamp::Off),
            _ => return None,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waits for a reset.
    Waiting,
    /// Bits of the mode that have come, the first one lowest.
    Mode { bits: u8, code: u8 },
    /// Bits of the calibration that were put on the data line.
    Calibration { mode: Mode, put: u16 },
    Measuring {
        mode: Mode,
        lamp: Lamp,
        before: Lamp,
        since: Cycles,
    },
}

/// The sensor and the surface in front of it: black and in darkness at the start.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColorSensor {
    /// Light from elsewhere: 0 is darkness, 1 the strongest that the sensor tells apart.
    #[serde(skip)]
    ambient: f64,
    /// Share of the red, green and blue light that the surface throws back, 0 to 1 each.
    #[serde(skip)]
    reflectance: [f64; 3],
    /// The check sum that it sends is wrong.
    #[serde(skip)]
    spoilt: bool,
    #[serde(skip)]
    state: State,
    #[serde(skip)]
    clock: bool,
    #[serde(skip)]
    edge_at: Cycles,
    #[serde(skip)]
    calibration: [u8; CALIBRATION_BYTES],
}

impl Default for ColorSensor {
    fn default() -> Self {
        Self {
            ambient: 0.0,
            reflectance: [0.0; 3],
            spoilt: false,
            state: State::Waiting,
            clock: false,
            edge_at: 0,
            calibration: calibration(),
        }
    }
}

impl Device for ColorSensor {
    fn set(&mut self, key: &str, value: f64) -> bool {
        match key {
            "ambient" => self.ambient = value,
            "red" => self.reflectance[0] = value,
            "green" => self.reflectance[1] = value,
            "blue" => self.reflectance[2] = value,
            "wrong_sum" => self.spoilt = value != 0.0,
            _ => return false,
        }
        true
    }

    fn raw(&self, _lines: Lines) -> u16 {
        PRESENT
    }

    /// The sensor starts anew.
    fn set_plugged(&mut self, now: Cycles) {
        (self.state, self.clock, self.edge_at) = (State::Waiting, false, now);
    }

    /// It holds the clock low while it measures, and sends zeros of its calibration. The last bit
    /// outlasts the clock's fall, as the others do: LEGO's firmware takes bits after it.
    fn pulls_low(&self) -> [bool; 2] {
        match self.state {
            State::Waiting | State::Mode { .. } => [false, false],
            State::Calibration { put, .. } => [true, put > 0 && !self.calibration_bit(put - 1)],
            State::Measuring { .. } => [true, !self.calibration_bit(CALIBRATION_BITS - 1)],
        }
    }

    /// Counts of the chip's converter on the data line while it carries a voltage.
    fn analogue(&self, now: Cycles) -> Option<u16> {
        let State::Measuring {
            lamp,
            before,
            since,
            ..
        } = self.state
        else {
            return None;
        };
        let lit = if now < since + SETTLING { before } else { lamp };
        Some(self.count(lit))
    }

    fn lines_changed(&mut self, now: Cycles, lines: Lines) {
        let clock = lines.drives_high(0);
        if clock == self.clock {
            return;
        }
        self.clock = clock;
        let length = now - self.edge_at;
        self.edge_at = now;
        if clock {
            self.clock_rose(now, length, lines.drives_high(1));
        } else {
            self.clock_fell(now, length, lines.is_high(1));
        }
    }
}

impl ColorSensor {
    const fn calibration_bit(&self, number: u16) -> bool {
        let bit = self.calibration[number as usize / 8] >> (number % 8) & 1 != 0;
        let last = number + 1 == CALIBRATION_BITS;
        bit != (last && self.spoilt)
    }

    fn count(&self, lamp: Lamp) -> u16 {
        let blank = libm::round(DARK + self.ambient * AMBIENT);
        let place = match lamp {
            Lamp::Off => return blank as u16,
            Lamp::Red => 0,
            Lamp::Green => 1,
            Lamp::Blue => 2,
        };
        let added = LAMPS[place] * SENSITIVITIES[range(blank)] * self.reflectance[place];
        libm::round(blank + added).min(1023.0) as u16
    }

    fn clock_rose(&mut self, now: Cycles, low_for: Cycles, data_high: bool) {
        if low_for >= RESET && data_high {
            self.state = State::Mode { bits: 0, code: 0 };
            return;
        }
        match &mut self.state {
            State::Mode { .. } if low_for < SHORTEST_HALF_PERIOD => self.state = State::Waiting,
            State::Calibration { put, .. } => *put += 1,
            State::Measuring { .. } => self.next_lamp(now),
            State::Waiting | State::Mode { .. } => {}
        }
    }

    fn clock_fell(&mut self, now: Cycles, high_for: Cycles, data_high: bool) {
        match self.state {
            State::Mode { .. } if high_for < SHORTEST_HALF_PERIOD => self.state = State::Waiting,
            State::Mode { bits, code } => {
                let code = code | u8::from(data_high) << bits;
                self.state = if bits + 1 < MODE_BITS {
                    State::Mode {
                        bits: bits + 1,
                        code,
                    }
                } else {
                    Mode::of(code)
                        .map_or(State::Waiting, |mode| State::Calibration { mode, put: 0 })
                };
            }
            State::Calibration { mode, put } if put == CALIBRATION_BITS => {
                let lamp = match mode {
                    Mode::Full => Lamp::Off,
                    Mode::Single(lamp) => lamp,
                };
                self.state = State::Measuring {
                    mode,
                    lamp,
                    before: Lamp::Off,
                    since: now,
                };
            }
            State::Measuring { .. } => self.next_lamp(now),
            State::Waiting | State::Calibration { .. } => {}
        }
    }

    fn next_lamp(&mut self, now: Cycles) {
        if let State::Measuring {
            mode: Mode::Full,
            lamp,
            before,
            since,
        } = &mut self.state
        {
            (*before, *since) = (*lamp, now);
            *lamp = match *lamp {
                Lamp::Off => Lamp::Red,
                Lamp::Red => Lamp::Green,
                Lamp::Green => Lamp::Blue,
                Lamp::Blue => Lamp::Off,
            };
        }
    }
}

/// Row of the calibration for a count without lamp.
fn range(blank: f64) -> usize {
    LIMITS
        .iter()
        .filter(|&&limit| blank < f64::from(limit))
        .count()
}

/// What the sensor sends: rows, limits and check sum, numbers with the lowest byte first, the sum
/// with the highest.
fn calibration() -> [u8; CALIBRATION_BYTES] {
    let rows = SENSITIVITIES.iter().flat_map(|sensitivity| {
        let factor = |lamp: f64| libm::ceil(WHITE * ONE / (lamp * sensitivity)) as u32;
        let [red, green, blue] = LAMPS.map(factor);
        [red, green, blue, BLANK_FACTOR]
    });
    let limits = LIMITS.iter().flat_map(|limit| limit.to_le_bytes());
    let data: Vec<u8> = rows.flat_map(u32::to_le_bytes).chain(limits).collect();
    let sum = check_sum(&data).to_be_bytes();
    let mut bytes = [0; CALIBRATION_BYTES];
    for (place, byte) in bytes.iter_mut().zip(data.iter().chain(&sum)) {
        *place = *byte;
    }
    bytes
}

/// CRC-16 with the polynomial 8005 in reversed order, begun with 5AA5.
fn check_sum(data: &[u8]) -> u16 {
    let bit = |sum: u16| sum >> 1 ^ if sum & 1 != 0 { 0xA001 } else { 0 };
    data.iter().fold(0x5AA5, |sum, &byte| {
        (0..8).fold(sum ^ u16::from(byte), |sum, _| bit(sum))
    })
}
