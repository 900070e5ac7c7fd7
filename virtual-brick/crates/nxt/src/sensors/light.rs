// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The light sensor: a phototransistor and, switched by the first digital line, a red lamp.

use plant::{within, Mount, ParameterError};
use serde::Deserialize;

use super::{check_mount, Device, Lines, Measurement};

/// Counts in darkness and in the strongest light that it tells apart: LEGO's firmware scales
/// 4.4 V to 0.8 V of the 5 V range to 0 to 100 %. More light gives a lower voltage.
const DARK: f64 = 900.0;
const BRIGHT: f64 = 164.0;

/// Share of the range that the lamp reaches on a white surface in front of the lens (chosen).
const LAMP: f64 = 0.6;

/// The sensor and what is in front of it: darkness at the start.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightSensor {
    /// Where it looks down on the floor; an input gives what is before it when absent.
    mount: Option<Mount>,
    /// Radius of the spot that it sees in m.
    spot: f64,
    /// Light from elsewhere: 0 is darkness, 1 the strongest that the sensor tells apart.
    #[serde(skip)]
    ambient: f64,
    /// Share of the lamp's light that the surface in front of it throws back, 0 to 1.
    #[serde(skip)]
    reflectance: f64,
}

impl Default for LightSensor {
    fn default() -> Self {
        Self {
            mount: None,
            // Chosen: the sensor stands about as far above the floor.
            spot: 0.004,
            ambient: 0.0,
            reflectance: 0.0,
        }
    }
}

impl Device for LightSensor {
    fn check(&self, field: &str) -> Result<(), ParameterError> {
        within(&format!("{field}.spot"), self.spot, 0.0, 0.1, "m")?;
        check_mount(self.mount.as_ref(), field)
    }

    fn measurement(&self) -> Option<Measurement> {
        let (mount, spot) = (self.mount?, self.spot);
        Some(Measurement::Floor { mount, spot })
    }

    fn set(&mut self, key: &str, value: f64) -> bool {
        match key {
            "ambient" => self.ambient = value,
            "reflectance" => self.reflectance = value,
            _ => return false,
        }
        true
    }

    fn raw(&self, lines: Lines) -> u16 {
        let own = if lines.drives_high(0) {
            LAMP * self.reflectance
        } else {
            0.0
        };
        let light = (self.ambient + own).min(1.0);
        libm::round(DARK + light * (BRIGHT - DARK)) as u16
    }
}
