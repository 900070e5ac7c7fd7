// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a brick is made of and stands in: read from JSON, checked, with errors that name the field.
//!
//! Floating quantities are SI; the unit of each is told at its field.

mod error;
mod timing;
mod timing_fields;
mod timing_parameters;

use at91sam7s::Errata;
use nxt::{BatteryConfiguration, BluetoothConfiguration, BoardConfiguration, SensorPorts};
use plant::{BodyParameters, MotorPorts, RobotParameters, Surroundings};
use serde::Deserialize;

use crate::engine::{Engine, JIT_THRESHOLD_RUNS};

pub use error::ConfigurationError;
pub use timing::Timing;
pub use timing_parameters::{TimingParameter, Values as TimingValues, TIMING_PARAMETERS};

/// One millisecond of the master clock, rounded up.
const SIGNAL_PERIOD_CYCLES: u64 = 48_055;

/// A brick, its battery, what is plugged in, and the mechanics.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Seed of every random quantity.
    pub seed: u64,
    /// Battery and sensors.
    pub board: BoardConfiguration,
    /// Motors and mechanics.
    pub robot: RobotParameters,
    /// Period of sampling the signals.
    pub signal_period_cycles: u64,
    /// How much the trace may hold.
    pub trace_limits: trace::Limits,
    /// What executes instructions; the run is the same with each.
    pub engine: Engine,
    /// Compile threshold: runs of a block before the fast engine compiles it.
    pub jit_threshold_runs: u32,
    /// The run waits for the compiler. Otherwise it continues with interpreted blocks, which is
    /// faster, and the host decides when the code arrives.
    pub jit_synchronous: bool,
    /// Timing that no document fixes.
    pub timing: Timing,
    /// Faults of the silicon that the chip has.
    pub errata: Errata,
    /// A program that writes what only the run-time writes of its threads ends the run.
    pub guards_threads: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    #[serde(default = "default_seed")]
    seed: u64,
    #[serde(default)]
    battery: BatteryConfiguration,
    #[serde(default)]
    bluetooth: BluetoothConfiguration,
    #[serde(default)]
    motors: MotorPorts,
    #[serde(default)]
    body: BodyParameters,
    #[serde(default)]
    surroundings: Surroundings,
    #[serde(default)]
    sensors: SensorPorts,
    #[serde(default = "default_signal_period")]
    signal_period_cycles: u64,
    #[serde(default)]
    trace_limits: LimitFields,
    #[serde(default)]
    engine: Engine,
    #[serde(default)]
    timing: serde_json::Map<String, serde_json::Value>,
    #[serde(default)]
    errata: Errata,
    #[serde(default)]
    guards_threads: bool,
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
        if self.signal_period_cycles == 0 {
            return Err(ConfigurationError::field(
                "signal_period_cycles",
                "must be at least 1",
            ));
        }
        let robot = RobotParameters {
            motors: self.motors,
            body: self.body,
            surroundings: self.surroundings,
        };
        robot.check()?;
        let board = BoardConfiguration {
            battery: self.battery,
            bluetooth: self.bluetooth,
            sensors: self.sensors,
        };
        board.check()?;
        let timing = Timing::from_fields(&self.timing)?;
        let defaults = trace::Limits::default();
        Ok(Configuration {
            seed: self.seed,
            board,
            robot,
            signal_period_cycles: self.signal_period_cycles,
            trace_limits: trace::Limits {
                events: self.trace_limits.events.unwrap_or(defaults.events),
                signal_values: self
                    .trace_limits
                    .signal_values
                    .unwrap_or(defaults.signal_values),
            },
            engine: timing.engine(self.engine),
            jit_threshold_runs: JIT_THRESHOLD_RUNS,
            jit_synchronous: false,
            timing,
            errata: self.errata,
            guards_threads: self.guards_threads,
        })
    }
}
