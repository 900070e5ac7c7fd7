// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The sound sensor: a microphone whose rectified output is a voltage, plain (dB) while the first
//! digital line is driven high, weighted as the ear hears (dBA) while the second one is.
//!
//! The output is proportional to the sound pressure: LEGO's user guide gives 90 dB as 100 % and
//! normal conversation, 60 to 80 dB, as 5 to 30 %. It follows the level at once.

use serde::Deserialize;

use super::{Device, Lines, OPEN};

/// Counts in silence and at full scale: LEGO's firmware scales 4.98 V to 0.65 V of the 5 V range
/// to 0 to 100 %. More sound gives a lower voltage.
const SILENT: f64 = 1019.0;
const LOUD: f64 = 133.0;
/// Level of full scale in dB.
const FULL_SCALE: f64 = 90.0;

/// The sensor and what it hears: silence at the start.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SoundSensor {
    /// Sound pressure level in dB.
    #[serde(skip)]
    level: f64,
    /// Frequency of the sound in Hz.
    #[serde(skip)]
    frequency: f64,
}

impl Default for SoundSensor {
    fn default() -> Self {
        Self {
            level: 0.0,
            frequency: 1000.0,
        }
    }
}

impl Device for SoundSensor {
    fn set(&mut self, key: &str, value: f64) -> bool {
        match key {
            "level" => self.level = value,
            "frequency" => self.frequency = value,
            _ => return false,
        }
        true
    }

    /// With neither line high the amplifier is off; with both the plain path prevails (chosen).
    fn raw(&self, lines: Lines) -> u16 {
        let heard = match (lines.drives_high(0), lines.drives_high(1)) {
            (false, false) => return OPEN,
            (true, _) => self.level,
            (false, true) => self.level + a_weighting(self.frequency),
        };
        let share = libm::exp10((heard - FULL_SCALE) / 20.0).min(1.0);
        libm::round(SILENT + share * (LOUD - SILENT)) as u16
    }
}

/// A-weighting in dB at a frequency in Hz (IEC 61672-1, annex E).
fn a_weighting(frequency: f64) -> f64 {
    let square = |x: f64| x * x;
    let f2 = square(frequency);
    let response = square(12_194.0) * square(f2)
        / ((f2 + square(20.6))
            * libm::sqrt((f2 + square(107.7)) * (f2 + square(737.9)))
            * (f2 + square(12_194.0)));
    20.0 * libm::log10(response) + 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weighting_has_the_values_of_the_standard() {
        for (frequency, expected) in [
            (31.623, -39.4),
            (100.0, -19.1),
            (1000.0, 0.0),
            (8000.0, -1.1),
        ] {
            let weighting = a_weighting(frequency);
            assert!(
                (weighting - expected).abs() < 0.1,
                "{frequency}: {weighting}"
            );
        }
    }
}
