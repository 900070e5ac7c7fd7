// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The inputs of each kind of sensor, from the catalogue.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

/// An input of a kind of sensor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct SensorInput {
    /// What the device calls it.
    pub key: String,
    name: String,
    signal: Option<String>,
    /// Lowest and highest value.
    pub range: (f64, f64),
    /// Value before anybody sets it.
    #[serde(default)]
    pub start: f64,
    /// Only whole numbers.
    #[serde(default)]
    pub whole: bool,
    /// Unit of the value; empty for a count, a share or a switch.
    pub unit: String,
    /// The plant gives it when the sensor sits on the robot.
    #[serde(default)]
    pub measured: bool,
}

impl SensorInput {
    /// Its name at a port, 1 to 4.
    #[must_use]
    pub fn name(&self, port: usize) -> String {
        self.name.replace("{port}", &port.to_string())
    }

    /// Name of the signal that records what the sensor at a port measures.
    #[must_use]
    pub fn signal(&self, port: usize) -> String {
        let signal = self.signal.as_ref().unwrap_or(&self.name);
        signal.replace("{port}", &port.to_string())
    }
}

#[derive(Deserialize)]
struct Kind {
    inputs: Vec<SensorInput>,
}

const CATALOGUE: &str = include_str!("../../../../../catalogue/sensors.json");

/// A catalogue that cannot be read has no kinds: a test below says so.
static KINDS: LazyLock<BTreeMap<String, Kind>> =
    LazyLock::new(|| serde_json::from_str(CATALOGUE).unwrap_or_default());

/// The inputs of a kind; none of an unknown one.
pub fn inputs(kind: &str) -> &'static [SensorInput] {
    KINDS.get(kind).map_or(&[], |kind| &kind.inputs)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sensors::Sensor;

    #[test]
    fn every_sensor_of_the_catalogue_takes_each_of_its_inputs_and_starts_as_it_says() {
        let kinds: BTreeMap<String, Kind> = serde_json::from_str(CATALOGUE).unwrap();
        for kind in Sensor::KINDS {
            assert!(kinds.contains_key(*kind), "{kind} is not in the catalogue");
        }
        for (kind, entry) in kinds {
            let text = format!(r#"{{"kind": "{kind}"}}"#);
            let mut sensor: Sensor = serde_json::from_str(&text).unwrap();
            assert_eq!(sensor.inputs(), entry.inputs, "{kind}");
            for input in entry.inputs {
                let fresh = sensor.clone();
                assert!(sensor.set(&input.key, input.start), "{kind}: {}", input.key);
                assert_eq!(sensor, fresh, "{kind} does not start so");
                assert!(input.range.0 <= input.start && input.start <= input.range.1);
            }
            assert!(!sensor.set("no such input", 0.0), "{kind}");
        }
    }
}
