// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Units of the recorded signals, and the units that people may write instead.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::LazyLock;

use serde::Deserialize;

/// Written unit, unit of the signals, and its size in it.
const UNITS: [(&str, &str, f64); 24] = [
    ("rad/s", "rad/s", 1.0),
    ("deg/s", "rad/s", PI / 180.0),
    ("°/s", "rad/s", PI / 180.0),
    ("rpm", "rad/s", PI / 30.0),
    ("rad", "rad", 1.0),
    ("deg", "rad", PI / 180.0),
    ("°", "rad", PI / 180.0),
    ("V", "V", 1.0),
    ("mV", "V", 1e-3),
    ("A", "A", 1.0),
    ("mA", "A", 1e-3),
    ("m", "m", 1.0),
    ("cm", "m", 1e-2),
    ("mm", "m", 1e-3),
    ("N m", "N m", 1.0),
    ("N", "N", 1.0),
    ("dB", "dB", 1.0),
    ("Hz", "Hz", 1.0),
    ("s", "s", 1.0),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("µs", "s", 1e-6),
    ("counts", "counts", 1.0),
    ("%", "", 1e-2),
];

const QUANTITIES: [(&str, &str); 15] = [
    ("angle", "rad"),
    ("load_angle", "rad"),
    ("hand_angle", "rad"),
    ("angular_velocity", "rad/s"),
    ("voltage", "V"),
    ("current", "A"),
    ("encoder", "counts"),
    ("load_torque", "N m"),
    ("x", "m"),
    ("y", "m"),
    ("heading", "rad"),
    ("pitch", "rad"),
    ("pitch_rate", "rad/s"),
    ("rate", "rad/s"),
    ("push", "N"),
];

const CATALOGUE: &str = include_str!("../../../../catalogue/sensors.json");

#[derive(Deserialize)]
struct Kind {
    inputs: Vec<SensorInput>,
    #[serde(default)]
    test_only: bool,
}

#[derive(Deserialize)]
struct SensorInput {
    name: String,
    unit: String,
}

/// A catalogue that cannot be read has no kinds: a test below says so.
static KINDS: LazyLock<BTreeMap<String, Kind>> =
    LazyLock::new(|| serde_json::from_str(CATALOGUE).unwrap_or_default());

/// The unit of the signals that a written unit stands for, and its size in it.
pub fn unit(written: &str) -> Option<(&'static str, f64)> {
    let found = UNITS.iter().find(|(name, _, _)| *name == written);
    found.map(|&(_, unit, size)| (unit, size))
}

/// Unit of a signal or input; empty for a ratio, a switch or a variable of the program.
#[must_use]
pub fn signal_unit(name: &str) -> &'static str {
    if name.starts_with("probe.") {
        return "";
    }
    let kinds = KINDS.values().filter(|kind| !kind.test_only);
    let mut inputs = kinds.flat_map(|kind| &kind.inputs);
    if let Some(input) = inputs.find(|input| is_input(&input.name, name)) {
        return &input.unit;
    }
    let quantity = name.rsplit('.').next().unwrap_or_default();
    let found = QUANTITIES.iter().find(|(known, _)| *known == quantity);
    found.map_or("", |(_, unit)| unit)
}

/// Whether `name` is the input `pattern` with some word for its port.
fn is_input(pattern: &str, name: &str) -> bool {
    let port = pattern
        .split_once("{port}")
        .and_then(|(before, after)| name.strip_prefix(before)?.strip_suffix(after));
    port.is_some_and(|port| {
        !port.is_empty() && port.chars().all(|c| c.is_alphanumeric() || c == '_')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_has_the_unit_of_its_quantity_or_of_the_catalogue() {
        assert!(KINDS.len() > 4);
        assert_eq!(signal_unit("motor.B.angular_velocity"), "rad/s");
        assert_eq!(signal_unit("motor.B.duty"), "");
        assert_eq!(signal_unit("distance.4"), "m");
        assert_eq!(signal_unit("sound.2.frequency"), "Hz");
        assert_eq!(signal_unit("probe.x"), "");
        assert_eq!(signal_unit("x"), "m");
    }
}
