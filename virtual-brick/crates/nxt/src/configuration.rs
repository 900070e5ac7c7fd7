// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is in and on the brick, as it stands in a configuration.

use plant::{within, Mount, ParameterError};
use serde::Deserialize;

use crate::battery::BatteryConfiguration;
use crate::bluetooth::BluetoothConfiguration;

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
    pub port_1: Option<SensorConfiguration>,
    /// Port 2.
    #[serde(default, rename = "2")]
    pub port_2: Option<SensorConfiguration>,
    /// Port 3.
    #[serde(default, rename = "3")]
    pub port_3: Option<SensorConfiguration>,
    /// Port 4.
    #[serde(default, rename = "4")]
    pub port_4: Option<SensorConfiguration>,
}

impl SensorPorts {
    /// What is plugged into each port, 1 to 4.
    #[must_use]
    pub const fn all(&self) -> [Option<&SensorConfiguration>; 4] {
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

/// A sensor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SensorConfiguration {
    /// The touch sensor: a push button.
    Touch {},
    /// Any passive analogue sensor, given by the count that the converter reads.
    Analogue {
        /// Count at the start, 0 to 1023; an open input when absent.
        #[serde(default = "open_input")]
        raw: u16,
    },
    /// The light sensor, in darkness.
    Light {
        /// Where it looks down on the floor; an input gives what is before it when absent.
        #[serde(default)]
        mount: Option<Mount>,
        /// Radius of the spot that it sees in m.
        #[serde(default = "light_spot")]
        spot: f64,
    },
    /// The sound sensor, in silence.
    Sound {},
    /// The ultrasonic sensor, with nothing in its range.
    Ultrasonic {
        /// Where it looks at the walls; an input gives the distance when absent.
        #[serde(default)]
        mount: Option<Mount>,
    },
    /// The rate gyro.
    Gyro {
        /// The rotation of the body that it measures; an input gives the rate when absent.
        #[serde(default)]
        axis: Option<GyroAxis>,
        /// Count at rest.
        #[serde(default = "gyro_rest")]
        rest: f64,
    },
    /// The colour sensor, in darkness before a black surface.
    Color {},
}

/// A rotation of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GyroAxis {
    /// Forwards and backwards.
    Pitch,
    /// To the left.
    Yaw,
}

impl SensorConfiguration {
    fn check(&self, field: &str) -> Result<(), ParameterError> {
        match self {
            Self::Analogue { raw } if *raw > 1023 => Err(ParameterError {
                field: format!("{field}.raw"),
                value: raw.to_string(),
                expected: "an integer from 0 to 1023".to_owned(),
            }),
            Self::Light { mount, spot } => {
                within(&format!("{field}.spot"), *spot, 0.0, 0.1, "m")?;
                check_mount(mount.as_ref(), field)
            }
            Self::Ultrasonic { mount } => check_mount(mount.as_ref(), field),
            Self::Gyro { rest, .. } => {
                within(&format!("{field}.rest"), *rest, 0.0, 1023.0, "counts")
            }
            _ => Ok(()),
        }
    }
}

fn check_mount(mount: Option<&Mount>, field: &str) -> Result<(), ParameterError> {
    mount.map_or(Ok(()), |mount| mount.check(&format!("{field}.mount")))
}

/// Chosen: the sensor stands about as far above the floor.
const fn light_spot() -> f64 {
    0.004
}

/// Typical of the sensor on a charged battery (NXTway-GS sample data: 605; others 619 to 625).
const fn gyro_rest() -> f64 {
    600.0
}

const fn open_input() -> u16 {
    crate::sensors::OPEN
}
