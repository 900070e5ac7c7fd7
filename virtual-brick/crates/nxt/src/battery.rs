// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The battery and how the co-processor sees it.

use plant::{within, ParameterError};
use serde::Deserialize;

/// Volts per count of the 10-bit converter: divider 22 k / 12 k, reference 5 V.
const VOLTS_PER_COUNT: f64 = 0.013_848;
/// Firmware version 1.1 of the co-processor in bits 10 to 14 of the battery word.
const VERSION_BITS: u16 = 0x2400;
/// Rechargeable pack: its switch in the battery bay.
const PACK_BIT: u16 = 0x8000;
/// Lowest and highest voltage in V with which a run may begin: above, the co-processor does not
/// switch on.
const VOLTAGE_RANGE: (f64, f64) = (5.0, 11.8);
/// What the voltage may become in a run.
pub const VOLTAGE_LIMITS: (f64, f64) = (0.0, 11.8);
/// Below this voltage in V the chip's core supply is below the level of its brown-out detector
/// (chosen: the two regulators in between need about 2 V).
pub const BROWN_OUT_VOLTAGE: f64 = 3.6;
/// Below this voltage in V nothing on the brick works (chosen).
pub const LOST_VOLTAGE: f64 = 2.0;
/// Lowest voltage in V with which the co-processor starts on a rechargeable pack.
pub const PACK_VOLTAGE_AT_START: f64 = 6.5;

/// What is in the battery bay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BatteryKind {
    /// The rechargeable pack.
    #[default]
    LiIon,
    /// Six AA cells.
    Aa,
}

/// The battery, as it stands in a configuration.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatteryConfiguration {
    /// What it is.
    #[serde(default)]
    pub kind: BatteryKind,
    /// Voltage without load in V.
    pub voltage: f64,
    /// Internal resistance in ohm. Only the motors' current is thought to flow through it.
    #[serde(default)]
    pub internal_resistance: f64,
}

impl Default for BatteryConfiguration {
    fn default() -> Self {
        Self {
            kind: BatteryKind::LiIon,
            voltage: 8.0,
            internal_resistance: 0.0,
        }
    }
}

impl BatteryConfiguration {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let (lowest, highest) = VOLTAGE_RANGE;
        within("battery.voltage", self.voltage, lowest, highest, "V")?;
        let resistance = self.internal_resistance;
        within("battery.internal_resistance", resistance, 0.0, 2.0, "ohm")
    }
}

/// The battery under load.
#[derive(Clone, Debug, PartialEq)]
pub struct Battery {
    configuration: BatteryConfiguration,
    current: f64,
}

impl Battery {
    pub const fn new(configuration: BatteryConfiguration) -> Self {
        Self {
            configuration,
            current: 0.0,
        }
    }

    /// Sets the voltage without load.
    pub fn set_voltage(&mut self, voltage: f64) {
        self.configuration.voltage = voltage;
    }

    /// Sets the current that the motors take.
    pub fn set_current(&mut self, current: f64) {
        self.current = current;
    }

    /// Voltage at the terminals in V.
    pub fn voltage(&self) -> f64 {
        let drop = self.current * self.configuration.internal_resistance;
        libm::fmax(self.configuration.voltage - drop, 0.0)
    }

    /// A rechargeable pack whose voltage is too low to start.
    pub fn refuses_start(&self) -> bool {
        self.configuration.kind == BatteryKind::LiIon && self.voltage() < PACK_VOLTAGE_AT_START
    }

    /// The battery word of the co-processor's frame.
    pub fn word(&self) -> u16 {
        let count = libm::fmin(self.voltage() / VOLTS_PER_COUNT, 1023.0) as u16;
        let pack = match self.configuration.kind {
            BatteryKind::LiIon => PACK_BIT,
            BatteryKind::Aa => 0,
        };
        pack | VERSION_BITS | count
    }
}
