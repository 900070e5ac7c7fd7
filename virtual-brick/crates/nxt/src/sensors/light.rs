// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The light sensor: a phototransistor and, switched by the first digital line, a red lamp.

/// Counts in darkness and in the strongest light that it tells apart: LEGO's firmware scales
/// 4.4 V to 0.8 V of the 5 V range to 0 to 100 %. More light gives a lower voltage.
const DARK: f64 = 900.0;
const BRIGHT: f64 = 164.0;

/// Share of the range that the lamp reaches on a white surface in front of the lens (chosen).
const LAMP: f64 = 0.6;

/// The sensor and what is in front of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightSensor {
    /// Light from elsewhere: 0 is darkness, 1 the strongest that the sensor tells apart.
    pub ambient: f64,
    /// Share of the lamp's light that the surface in front of it throws back, 0 to 1.
    pub reflectance: f64,
}

impl LightSensor {
    /// Count of the converter.
    pub fn raw(self, lamp_on: bool) -> u16 {
        let own = if lamp_on {
            LAMP * self.reflectance
        } else {
            0.0
        };
        let light = (self.ambient + own).min(1.0);
        libm::round(DARK + light * (BRIGHT - DARK)) as u16
    }
}
