// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The rate gyro (HiTechnic NGY1044): a voltage about a rest value, one count per degree/s.

/// Counts that the converter can give.
const COUNTS: (f64, f64) = (0.0, 1023.0);

/// The sensor and how it turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroSensor {
    /// Angular velocity about its axis in rad/s.
    pub rate: f64,
    /// Count at rest.
    pub rest: f64,
}

impl GyroSensor {
    /// Count of the converter.
    pub fn raw(self) -> u16 {
        let count = libm::round(self.rest + self.rate.to_degrees());
        count.clamp(COUNTS.0, COUNTS.1) as u16
    }
}
