// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The rate gyro (HiTechnic NGY1044): a voltage about a rest value, one count per degree/s.

use plant::{within, ParameterError};
use serde::Deserialize;

use super::{Device, Lines, Measurement};

/// Counts that the converter can give.
const COUNTS: (f64, f64) = (0.0, 1023.0);

/// A rotation of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GyroAxis {
    /// Forwards and backwards.
    Pitch,
    /// To the left.
    Yaw,
}

/// The sensor and how it turns.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GyroSensor {
    /// The rotation of the body that it measures; an input gives the rate when absent.
    axis: Option<GyroAxis>,
    /// Count at rest.
    rest: f64,
    /// Angular velocity about its axis in rad/s.
    #[serde(skip)]
    rate: f64,
}

impl Default for GyroSensor {
    fn default() -> Self {
        Self {
            axis: None,
            // Typical on a charged battery (NXTway-GS sample data: 605; others 619 to 625).
            rest: 600.0,
            rate: 0.0,
        }
    }
}

impl Device for GyroSensor {
    fn check(&self, field: &str) -> Result<(), ParameterError> {
        within(
            &format!("{field}.rest"),
            self.rest,
            COUNTS.0,
            COUNTS.1,
            "counts",
        )
    }

    fn measurement(&self) -> Option<Measurement> {
        self.axis.map(Measurement::Rotation)
    }

    fn set(&mut self, key: &str, value: f64) -> bool {
        self.rate = value;
        key == "rate"
    }

    fn raw(&self, _lines: Lines) -> u16 {
        let count = libm::round(self.rest + self.rate.to_degrees());
        count.clamp(COUNTS.0, COUNTS.1) as u16
    }
}
