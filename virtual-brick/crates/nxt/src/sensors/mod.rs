// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What can be plugged into a sensor port: one file per device, named in [`sensors!`] below.
//!
//! Kinds and inputs stand in `catalogue/sensors.json`, which the host and the page read as well.

mod analogue;
mod color;
mod gyro;
mod kinds;
mod light;
mod slave;
mod sound;
mod touch;
mod ultrasonic;

use std::fmt::Debug;
use std::ops::{Deref, DerefMut};

use at91sam7s::board::Cycles;
use plant::{Mount, ParameterError};
use serde::Deserialize;

pub use gyro::GyroAxis;
pub use kinds::SensorInput;

use crate::time::NEVER;

/// Count of an open input: pulled up to the converter's reference.
pub const OPEN: u16 = 1023;

/// What the brick does with the two digital lines of a port: drives them high or low, or lets
/// them be pulled up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lines {
    /// Level that the brick drives on each line; nothing while the line is its input.
    pub driven: [Option<bool>; 2],
}

impl Lines {
    /// The brick drives the line high; its pull-up alone does not.
    pub fn drives_high(self, line: usize) -> bool {
        self.driven[line] == Some(true)
    }

    /// The line is high unless somebody pulls it low.
    pub fn is_high(self, line: usize) -> bool {
        self.driven[line] != Some(false)
    }
}

/// What a sensor on the robot measures of the plant.
#[derive(Clone, Debug)]
pub enum Measurement {
    /// Reflectance of the floor below it, in a spot of this radius in m.
    Floor { mount: Mount, spot: f64 },
    /// Distance of the nearest wall before it.
    Wall(Mount),
    /// Rate of a rotation of the body.
    Rotation(GyroAxis),
}

/// A device at a sensor port. Each has what makes it up, as a configuration gives it, and its
/// state; what it does not have keeps the behaviour of an open port.
pub trait Device: Debug {
    /// Checks every number of the configuration, which stands in `field`, against its range.
    ///
    /// # Errors
    /// The first field that is not accepted.
    fn check(&self, _field: &str) -> Result<(), ParameterError> {
        Ok(())
    }

    /// What it measures; nothing when inputs tell it.
    fn measurement(&self) -> Option<Measurement> {
        None
    }

    /// Sets the input with this key in the catalogue; false when it has none.
    fn set(&mut self, _key: &str, _value: f64) -> bool {
        false
    }

    /// Count that the co-processor's converter reads.
    fn raw(&self, _lines: Lines) -> u16 {
        OPEN
    }

    /// Counts of the chip's converter on the second digital line while the sensor puts a voltage
    /// there.
    fn analogue(&self, _now: Cycles) -> Option<u16> {
        None
    }

    /// The 9 V of its port come or go; pauses while the co-processor samples count as on.
    fn set_supply(&mut self, _now: Cycles, _on: bool) {}

    /// The cable is put in or pulled out.
    fn set_plugged(&mut self, _now: Cycles) {}

    /// The brick drives the digital lines in another way.
    fn lines_changed(&mut self, _now: Cycles, _lines: Lines) {}

    /// Which of the digital lines the sensor pulls low.
    fn pulls_low(&self) -> [bool; 2] {
        [false; 2]
    }

    /// When it wants to be advanced.
    fn next_event(&self) -> Cycles {
        NEVER
    }

    /// Does what is due.
    fn advance(&mut self, _now: Cycles) {}
}

/// Nothing is plugged in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Nothing;

impl Device for Nothing {}

/// The enumeration of all devices, each with the kind that a configuration names.
macro_rules! sensors {
    ($($kind:literal => $name:ident($device:ty),)*) => {
        /// A sensor, or nothing, in a port.
        #[derive(Clone, Debug, PartialEq, Deserialize)]
        #[serde(tag = "kind")]
        pub enum Sensor {
            $(
                #[doc = concat!("The device of kind `", $kind, "`.")]
                #[serde(rename = $kind)]
                $name($device),
            )*
            /// An empty port.
            #[serde(skip)]
            Nothing(Nothing),
        }

        impl Sensor {
            /// Kinds of the catalogue that have a device.
            #[cfg(test)]
            pub const KINDS: &'static [&'static str] = &[$($kind,)*];

            /// The inputs that the catalogue gives its kind.
            #[must_use]
            pub fn inputs(&self) -> &'static [SensorInput] {
                kinds::inputs(match self {
                    $(Self::$name(_) => $kind,)*
                    Self::Nothing(_) => "",
                })
            }
        }

        impl Deref for Sensor {
            type Target = dyn Device;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$name(device) => device,)*
                    Self::Nothing(device) => device,
                }
            }
        }

        impl DerefMut for Sensor {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$name(device) => device,)*
                    Self::Nothing(device) => device,
                }
            }
        }
    };
}

sensors! {
    "touch" => Touch(touch::TouchSensor),
    "analogue" => Analogue(analogue::AnalogueSensor),
    "light" => Light(light::LightSensor),
    "sound" => Sound(sound::SoundSensor),
    "ultrasonic" => Ultrasonic(ultrasonic::UltrasonicSensor),
    "gyro" => Gyro(gyro::GyroSensor),
    "color" => Color(color::ColorSensor),
}

/// Checks where a sensor sits.
fn check_mount(mount: Option<&Mount>, field: &str) -> Result<(), ParameterError> {
    mount.map_or(Ok(()), |mount| mount.check(&format!("{field}.mount")))
}
