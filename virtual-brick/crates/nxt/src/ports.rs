// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The analogue side of the four sensor ports.

use crate::configuration::{SensorConfiguration, SensorPorts};

/// Count of an open input: pulled up to the converter's reference.
pub const OPEN: u16 = 1023;
/// Count while the touch sensor is pressed: 2.2 kilo-ohm in it against the pull-up of 10.
const PRESSED: u16 = 183;

/// What is plugged into a sensor port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Nothing.
    Nothing,
    /// The touch sensor, pressed or not.
    Touch { pressed: bool },
    /// Anything that gives a count.
    Analogue { raw: u16 },
}

impl Sensor {
    /// Count that the co-processor's converter reads.
    pub const fn raw(self) -> u16 {
        match self {
            Self::Nothing | Self::Touch { pressed: false } => OPEN,
            Self::Touch { pressed: true } => PRESSED,
            Self::Analogue { raw } => raw,
        }
    }
}

/// The sensors in the four ports.
pub fn plug(ports: &SensorPorts) -> [Sensor; 4] {
    ports.all().map(|sensor| match sensor {
        None => Sensor::Nothing,
        Some(SensorConfiguration::Touch {}) => Sensor::Touch { pressed: false },
        Some(SensorConfiguration::Analogue { raw }) => Sensor::Analogue { raw: *raw },
    })
}
