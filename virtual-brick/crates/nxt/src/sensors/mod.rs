// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What can be plugged into a sensor port.

mod color;
mod gyro;
mod light;
mod slave;
mod sound;
mod ultrasonic;

use at91sam7s::board::Cycles;

pub use color::ColorSensor;
pub use gyro::GyroSensor;
pub use light::LightSensor;
pub use sound::SoundSensor;
pub use ultrasonic::UltrasonicSensor;

use crate::configuration::SensorConfiguration;
use crate::time::NEVER;

/// Count of an open input: pulled up to the converter's reference.
pub const OPEN: u16 = 1023;
/// Count while the touch sensor is pressed: 2.2 kilo-ohm in it against the pull-up of 10.
const PRESSED: u16 = 183;

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

/// A physical quantity at a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Pressed,
    Raw,
    Light,
    Reflectance,
    SoundLevel,
    SoundFrequency,
    Distance,
    Rate,
    Ambient,
    Red,
    Green,
    Blue,
    WrongSum,
}

/// An input of a sensor: its name before and after the number of the port, lowest and highest
/// value, whether whole, unit.
pub type SensorInput = (
    Quantity,
    (&'static str, &'static str),
    (f64, f64),
    bool,
    &'static str,
);

/// What is plugged into a sensor port.
#[derive(Clone, Debug)]
pub enum Sensor {
    /// Nothing.
    Nothing,
    /// The touch sensor, pressed or not.
    Touch { pressed: bool },
    /// Anything that gives a count.
    Analogue { raw: u16 },
    /// The light sensor.
    Light(LightSensor),
    /// The sound sensor.
    Sound(SoundSensor),
    /// The ultrasonic sensor.
    Ultrasonic(UltrasonicSensor),
    /// The rate gyro.
    Gyro(GyroSensor),
    /// The colour sensor.
    Color(ColorSensor),
}

impl Sensor {
    pub fn new(configuration: Option<&SensorConfiguration>) -> Self {
        match configuration {
            None => Self::Nothing,
            Some(SensorConfiguration::Touch {}) => Self::Touch { pressed: false },
            Some(SensorConfiguration::Analogue { raw }) => Self::Analogue { raw: *raw },
            Some(SensorConfiguration::Light { .. }) => Self::Light(LightSensor::default()),
            Some(SensorConfiguration::Sound {}) => Self::Sound(SoundSensor::default()),
            Some(SensorConfiguration::Ultrasonic { .. }) => {
                Self::Ultrasonic(UltrasonicSensor::default())
            }
            Some(SensorConfiguration::Gyro { rest, .. }) => Self::Gyro(GyroSensor {
                rate: 0.0,
                rest: *rest,
            }),
            Some(SensorConfiguration::Color {}) => Self::Color(ColorSensor::default()),
        }
    }

    pub const fn inputs(&self) -> &'static [SensorInput] {
        use Quantity::{
            Ambient, Blue, Distance, Green, Light, Pressed, Rate, Raw, Red, Reflectance,
            SoundFrequency, SoundLevel, WrongSum,
        };
        match self {
            Self::Nothing => &[],
            Self::Touch { .. } => &[(Pressed, ("touch.", ""), (0.0, 1.0), true, "")],
            Self::Analogue { .. } => &[(Raw, ("sensor.", ".raw"), (0.0, 1023.0), true, "")],
            Self::Light(_) => &[
                (Light, ("light.", ""), (0.0, 1.0), false, ""),
                (
                    Reflectance,
                    ("light.", ".reflectance"),
                    (0.0, 1.0),
                    false,
                    "",
                ),
            ],
            Self::Sound(_) => &[
                (SoundLevel, ("sound.", ""), (0.0, 140.0), false, "dB"),
                (
                    SoundFrequency,
                    ("sound.", ".frequency"),
                    (20.0, 20_000.0),
                    false,
                    "Hz",
                ),
            ],
            Self::Gyro(_) => &[(Rate, ("gyro.", ""), (-100.0, 100.0), false, "rad/s")],
            Self::Ultrasonic(_) => &[(Distance, ("distance.", ""), (0.0, 100.0), false, "m")],
            Self::Color(_) => &[
                (Ambient, ("color.", ""), (0.0, 1.0), false, ""),
                (Red, ("color.", ".red"), (0.0, 1.0), false, ""),
                (Green, ("color.", ".green"), (0.0, 1.0), false, ""),
                (Blue, ("color.", ".blue"), (0.0, 1.0), false, ""),
                (WrongSum, ("fault.", ".checksum"), (0.0, 1.0), true, ""),
            ],
        }
    }

    pub fn set(&mut self, quantity: Quantity, value: f64) {
        match (self, quantity) {
            (Self::Touch { pressed }, Quantity::Pressed) => *pressed = value != 0.0,
            (Self::Analogue { raw }, Quantity::Raw) => *raw = value as u16,
            (Self::Light(light), Quantity::Light) => light.ambient = value,
            (Self::Light(light), Quantity::Reflectance) => light.reflectance = value,
            (Self::Sound(sound), Quantity::SoundLevel) => sound.level = value,
            (Self::Sound(sound), Quantity::SoundFrequency) => sound.frequency = value,
            (Self::Gyro(gyro), Quantity::Rate) => gyro.rate = value,
            (Self::Ultrasonic(ultrasonic), Quantity::Distance) => ultrasonic.distance = value,
            (Self::Color(color), Quantity::Ambient) => color.ambient = value,
            (Self::Color(color), Quantity::Red) => color.reflectance[0] = value,
            (Self::Color(color), Quantity::Green) => color.reflectance[1] = value,
            (Self::Color(color), Quantity::Blue) => color.reflectance[2] = value,
            (Self::Color(color), Quantity::WrongSum) => color.spoilt = value != 0.0,
            _ => {}
        }
    }

    /// Count that the co-processor's converter reads.
    pub fn raw(&self, lines: Lines) -> u16 {
        match self {
            Self::Nothing | Self::Touch { pressed: false } | Self::Ultrasonic(_) => OPEN,
            Self::Touch { pressed: true } => PRESSED,
            Self::Analogue { raw } => *raw,
            Self::Light(light) => light.raw(lines.drives_high(0)),
            Self::Gyro(gyro) => gyro.raw(),
            Self::Color(_) => color::PRESENT,
            Self::Sound(sound) => sound.raw(lines.drives_high(0), lines.drives_high(1)),
        }
    }

    /// Counts of the chip's converter on the second digital line while the sensor puts a voltage
    /// there.
    pub fn analogue(&self, now: Cycles) -> Option<u16> {
        match self {
            Self::Color(color) => color.analogue(now),
            _ => None,
        }
    }

    /// The 9 V that the sensor gets without pauses come or go.
    pub fn set_supply(&mut self, now: Cycles, on: bool) {
        if let Self::Ultrasonic(ultrasonic) = self {
            ultrasonic.set_supply(now, on);
        }
    }

    /// The cable is put in or pulled out.
    pub fn set_plugged(&mut self, now: Cycles) {
        if let Self::Color(color) = self {
            color.restart(now);
        }
    }

    /// The brick drives the digital lines in another way.
    pub fn lines_changed(&mut self, now: Cycles, lines: Lines) {
        match self {
            Self::Ultrasonic(ultrasonic) => ultrasonic.lines_changed(now, lines),
            Self::Color(color) => color.lines_changed(now, lines),
            _ => {}
        }
    }

    /// Which of the digital lines the sensor pulls low.
    pub const fn pulls_low(&self) -> [bool; 2] {
        match self {
            Self::Ultrasonic(ultrasonic) => [false, ultrasonic.pulls_data_low()],
            Self::Color(color) => color.pulls_low(),
            _ => [false; 2],
        }
    }

    pub fn next_event(&self) -> Cycles {
        match self {
            Self::Ultrasonic(ultrasonic) => ultrasonic.next_event(),
            _ => NEVER,
        }
    }

    pub fn advance(&mut self, now: Cycles) {
        if let Self::Ultrasonic(ultrasonic) = self {
            ultrasonic.advance(now);
        }
    }
}
