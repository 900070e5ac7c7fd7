// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a brick is made of and stands in: read from JSON, checked, with errors that name the field.
//!
//! Floating quantities are SI; the unit of each is told at its field.

mod body;
mod error;
mod motors;

use serde::Deserialize;

pub use body::{Body, DifferentialDrive};
pub use error::ConfigurationError;
pub use motors::{Hand, Motor, MotorParameters};

use body::BodyFields;
use error::{check, Range};
use motors::MotorFields;

/// One millisecond of the master clock, rounded up.
const SIGNAL_PERIOD_CYCLES: u64 = 48_055;

/// A brick, its battery, what is plugged in, and the mechanics.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Seed of every random quantity.
    pub seed: u64,
    /// Battery.
    pub battery: Battery,
    /// Motors at ports A, B, C; none when nothing is plugged in.
    pub motors: [Option<Motor>; 3],
    /// Mechanics.
    pub body: Body,
    /// Sensors at ports 1 to 4; none when nothing is plugged in.
    pub sensors: [Option<Sensor>; 4],
    /// Period of sampling the signals.
    pub signal_period_cycles: u64,
    /// How much the trace may hold.
    pub trace_limits: trace::Limits,
}

/// Battery as a source behind a resistance.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Battery {
    /// Kind of pack.
    pub kind: BatteryKind,
    /// Voltage without load, V.
    pub voltage: f64,
    /// Internal resistance, ohm.
    #[serde(default)]
    pub internal_resistance: f64,
}

/// Kind of pack, seen by the switch in the battery bay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BatteryKind {
    /// Rechargeable lithium pack.
    LiIon,
    /// Six AA cells.
    Aa,
}

/// A sensor plugged in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Touch sensor.
    Touch,
    /// Any passive sensor, driven by the input `sensor.<port>.raw`.
    Analogue,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    #[serde(default = "default_seed")]
    seed: u64,
    battery: Battery,
    #[serde(default)]
    motors: MotorPorts,
    body: Option<BodyFields>,
    #[serde(default)]
    sensors: SensorPorts,
    #[serde(default = "default_signal_period")]
    signal_period_cycles: u64,
    #[serde(default)]
    trace_limits: LimitFields,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotorPorts {
    #[serde(rename = "A")]
    a: Option<MotorFields>,
    #[serde(rename = "B")]
    b: Option<MotorFields>,
    #[serde(rename = "C")]
    c: Option<MotorFields>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorPorts {
    #[serde(rename = "1")]
    one: Option<SensorFields>,
    #[serde(rename = "2")]
    two: Option<SensorFields>,
    #[serde(rename = "3")]
    three: Option<SensorFields>,
    #[serde(rename = "4")]
    four: Option<SensorFields>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorFields {
    kind: SensorKind,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SensorKind {
    Touch,
    Analogue,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitFields {
    events: Option<usize>,
    signal_values: Option<usize>,
}

fn default_seed() -> u64 {
    1
}

fn default_signal_period() -> u64 {
    SIGNAL_PERIOD_CYCLES
}

impl Configuration {
    /// Read and check a configuration.
    ///
    /// # Errors
    /// The text is no JSON, or a field is unknown, missing, of a wrong type or out of range; the
    /// error names the field by its path.
    pub fn from_json(json: &str) -> Result<Self, ConfigurationError> {
        let mut reader = serde_json::Deserializer::from_str(json);
        let fields: Fields = serde_path_to_error::deserialize(&mut reader)?;
        reader.end().map_err(ConfigurationError::text)?;
        fields.check()
    }
}

impl Fields {
    fn check(self) -> Result<Configuration, ConfigurationError> {
        check("battery.voltage", self.battery.voltage, Range::Positive)?;
        check(
            "battery.internal_resistance",
            self.battery.internal_resistance,
            Range::NotNegative,
        )?;
        if self.signal_period_cycles == 0 {
            return Err(ConfigurationError::field(
                "signal_period_cycles",
                "must be at least 1",
            ));
        }
        let motors = [
            self.motors
                .a
                .map(|motor| motor.check("motors.A"))
                .transpose()?,
            self.motors
                .b
                .map(|motor| motor.check("motors.B"))
                .transpose()?,
            self.motors
                .c
                .map(|motor| motor.check("motors.C"))
                .transpose()?,
        ];
        let body = self
            .body
            .map_or(Ok(Body::Bench), |body| body.check(&motors))?;
        let ports = [
            self.sensors.one,
            self.sensors.two,
            self.sensors.three,
            self.sensors.four,
        ];
        let defaults = trace::Limits::default();
        Ok(Configuration {
            seed: self.seed,
            battery: self.battery,
            motors,
            body,
            sensors: ports.map(|port| port.map(|fields| fields.kind.into())),
            signal_period_cycles: self.signal_period_cycles,
            trace_limits: trace::Limits {
                events: self.trace_limits.events.unwrap_or(defaults.events),
                signal_values: self
                    .trace_limits
                    .signal_values
                    .unwrap_or(defaults.signal_values),
            },
        })
    }
}

impl From<SensorKind> for Sensor {
    fn from(kind: SensorKind) -> Self {
        match kind {
            SensorKind::Touch => Self::Touch,
            SensorKind::Analogue => Self::Analogue,
        }
    }
}
