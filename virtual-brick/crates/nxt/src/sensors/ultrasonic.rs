// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The ultrasonic sensor: a range finder on the digital lines, whose transmitter needs the 9 V.
//!
//! Registers and modes as in the NXT Hardware Developer Kit, appendix of the ultrasonic sensor.
//! Its processor lives on the 4.3 V that a port always has: programs that measured distances on
//! real bricks speak to it 5 ms after they have switched on the 9 V, and with pauses in them.

use at91sam7s::board::Cycles;
use plant::{Mount, ParameterError};
use serde::Deserialize;

use super::slave::{Registers, Slave};
use super::{check_mount, Device, Lines, Measurement};
use crate::time::{milliseconds, NEVER};

/// Address byte of a write.
const ADDRESS: u8 = 0x02;
/// From a ping to the readings; drivers wait 30 to 50 ms.
const MEASUREMENT: Cycles = milliseconds(30);
const NO_ECHO: u8 = 255;
/// Registers of readings, from 16#42# on; only the first echo is modelled.
const READINGS: usize = 8;
/// Factory zero, scale factor and scale divisor.
const FACTORY: [u8; 3] = [0, 1, 14];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Off,
    SinglePing,
    Continuous,
    /// Listens for other sensors, which are not modelled: it hears nothing.
    Capture,
}

impl Mode {
    const fn code(self) -> u8 {
        match self {
            Self::Off => 0,
            Self::SinglePing => 1,
            Self::Continuous => 2,
            Self::Capture => 3,
        }
    }
}

/// The sensor and the wall in front of it: nothing in its range at the start.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UltrasonicSensor {
    /// Where it looks at the walls; an input gives the distance when absent.
    mount: Option<Mount>,
    /// Distance in m of what throws the echo back.
    #[serde(skip)]
    distance: f64,
    #[serde(skip)]
    slave: Slave,
    #[serde(skip)]
    program: Program,
}

/// What the sensor's processor knows.
#[derive(Clone, Debug, PartialEq)]
struct Program {
    /// The transmitter has its 9 V.
    transmits: bool,
    mode: Mode,
    /// Interval of the continuous mode, in measurements (the unit is chosen).
    interval: u8,
    readings: [u8; READINGS],
    calibration: [u8; 3],
    measured_at: Cycles,
}

impl Default for UltrasonicSensor {
    fn default() -> Self {
        Self {
            mount: None,
            distance: 100.0,
            slave: Slave::new(ADDRESS),
            program: Program::started(0),
        }
    }
}

impl Device for UltrasonicSensor {
    fn check(&self, field: &str) -> Result<(), ParameterError> {
        check_mount(self.mount.as_ref(), field)
    }

    fn measurement(&self) -> Option<Measurement> {
        self.mount.map(Measurement::Wall)
    }

    fn set(&mut self, key: &str, value: f64) -> bool {
        self.distance = value;
        key == "distance"
    }

    fn pulls_low(&self) -> [bool; 2] {
        [false, self.slave.pulls_data_low()]
    }

    fn next_event(&self) -> Cycles {
        self.program.measured_at
    }

    /// The sensor starts anew.
    fn set_plugged(&mut self, now: Cycles) {
        self.slave = Slave::new(ADDRESS);
        self.program = Program::started(now);
    }

    fn set_supply(&mut self, _now: Cycles, on: bool) {
        self.program.transmits = on;
    }

    fn lines_changed(&mut self, now: Cycles, lines: Lines) {
        let (clock, data) = (lines.is_high(0), lines.is_high(1));
        self.slave.levels(now, clock, data, &mut self.program);
    }

    fn advance(&mut self, now: Cycles) {
        if now >= self.program.measured_at {
            self.program.measured(self.distance);
        }
    }
}

impl Program {
    const fn at_rest(transmits: bool) -> Self {
        Self {
            transmits,
            mode: Mode::Off,
            interval: 1,
            readings: [NO_ECHO; READINGS],
            calibration: FACTORY,
            measured_at: NEVER,
        }
    }

    /// Continuous measurement is the default.
    const fn started(now: Cycles) -> Self {
        Self {
            mode: Mode::Continuous,
            measured_at: now + MEASUREMENT,
            ..Self::at_rest(false)
        }
    }

    fn measured(&mut self, distance: f64) {
        self.readings = [NO_ECHO; READINGS];
        if self.transmits && self.mode != Mode::Capture {
            self.readings[0] = self.reading(distance);
        }
        self.measured_at = match self.mode {
            Mode::Continuous | Mode::Capture => {
                self.measured_at + MEASUREMENT * Cycles::from(self.interval.max(1))
            }
            Mode::Off | Mode::SinglePing => NEVER,
        };
    }

    /// With the factory's calibration in whole centimetres.
    fn reading(&self, distance: f64) -> u8 {
        let [zero, scale, divisor] = self.calibration.map(f64::from);
        let count = distance * 100.0 * f64::from(FACTORY[2]);
        let scaled = zero + count * scale / divisor;
        if scaled < f64::from(NO_ECHO) {
            libm::floor(scaled + 1e-9) as u8
        } else {
            NO_ECHO
        }
    }

    /// A warm reset leaves it off. The readings are kept until the next measurement ends: programs
    /// that worked on real bricks read them just after the command for it.
    fn set_mode(&mut self, now: Cycles, code: u8) {
        let mode = match code {
            1 => Mode::SinglePing,
            2 => Mode::Continuous,
            3 => Mode::Capture,
            4 => {
                *self = Self::at_rest(self.transmits);
                return;
            }
            _ => Mode::Off,
        };
        self.mode = mode;
        self.measured_at = if mode == Mode::Off {
            NEVER
        } else {
            now + MEASUREMENT
        };
    }

    /// The texts overlap with the numbers that follow them: where a read begins tells which of
    /// them is meant.
    const fn text(register: u8) -> Option<&'static [u8]> {
        Some(match register {
            0x00 => b"V1.0",
            0x08 => b"LEGO",
            0x10 => b"Sonar",
            0x14 => b"10E-2m",
            _ => return None,
        })
    }
}

impl Registers for Program {
    fn read(&mut self, register: u8, index: u8) -> u8 {
        if let Some(text) = Self::text(register) {
            return text.get(usize::from(index)).copied().unwrap_or(0);
        }
        let register = register.wrapping_add(index);
        match register {
            0x11..=0x13 => FACTORY[usize::from(register - 0x11)],
            0x40 => self.interval,
            0x41 => self.mode.code(),
            0x42..=0x49 => self.readings[usize::from(register - 0x42)],
            0x4A..=0x4C => self.calibration[usize::from(register - 0x4A)],
            0x50..=0x52 => self.calibration[usize::from(register - 0x50)],
            _ => 0,
        }
    }

    /// Other registers take the byte and forget it.
    fn write(&mut self, now: Cycles, register: u8, value: u8) {
        match register {
            0x40 => self.interval = value,
            0x41 => self.set_mode(now, value),
            0x4A..=0x4C => self.calibration[usize::from(register - 0x4A)] = value,
            0x50..=0x52 => self.calibration[usize::from(register - 0x50)] = value,
            _ => {}
        }
    }
}
