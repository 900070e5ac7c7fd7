// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is in and on the brick, as it stands in a configuration.

use plant::ParameterError;
use serde::Deserialize;

use crate::battery::BatteryConfiguration;
use crate::bluetooth::BluetoothConfiguration;
use crate::sensors::Sensor;

/// The brick without motors and body.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoardConfiguration {
    /// The battery.
    #[serde(default)]
    pub battery: BatteryConfiguration,
    /// The Bluetooth module.
    #[serde(default)]
    pub bluetooth: BluetoothConfiguration,
    /// The sensor ports.
    #[serde(default)]
    pub sensors: SensorPorts,
}

impl BoardConfiguration {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// The first field that is not accepted.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.battery.check()?;
        self.sensors.check()
    }
}

/// The four sensor ports; an absent one has nothing plugged in.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorPorts {
    /// Port 1.
    #[serde(default, rename = "1")]
    pub port_1: Option<Sensor>,
    /// Port 2.
    #[serde(default, rename = "2")]
    pub port_2: Option<Sensor>,
    /// Port 3.
    #[serde(default, rename = "3")]
    pub port_3: Option<Sensor>,
    /// Port 4.
    #[serde(default, rename = "4")]
    pub port_4: Option<Sensor>,
}

impl SensorPorts {
    /// What is plugged into each port, 1 to 4.
    #[must_use]
    pub const fn all(&self) -> [Option<&Sensor>; 4] {
        [
            self.port_1.as_ref(),
            self.port_2.as_ref(),
            self.port_3.as_ref(),
            self.port_4.as_ref(),
        ]
    }

    fn check(&self) -> Result<(), ParameterError> {
        for (index, sensor) in self.all().into_iter().enumerate() {
            if let Some(sensor) = sensor {
                sensor.check(&format!("sensors.{}", index + 1))?;
            }
        }
        Ok(())
    }
}
