// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The catalogue's motor for the tests of several crates.
#![allow(dead_code, clippy::unwrap_used)]

use std::sync::LazyLock;

const PARTS: &str = include_str!("../../../../../catalogue/parts.json");
const LINEAR: [&str; 5] = [
    "resistance",
    "torque_constant",
    "electric_constant",
    "viscous_friction",
    "inertia",
];

/// A constant of the NXT motor in SI units.
pub fn nxt(name: &str) -> f64 {
    let motor = PARTS.split(r#""nxt": {"#).nth(1).unwrap();
    let constant = motor.split(&format!(r#""{name}": {{"value": "#)).nth(1);
    constant
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap()
}

/// The NXT motor without dry friction and play, as JSON: Table 1 of Bradley et al. (2012).
pub static TABLE_1: LazyLock<String> = LazyLock::new(|| {
    let members = LINEAR.map(|name| format!(r#""{name}": {}"#, nxt(name)));
    format!("{{{}}}", members.join(", "))
});

/// Torque per speed of the motor with shorted windings in N m s/rad.
pub fn damping() -> f64 {
    nxt("viscous_friction") + nxt("torque_constant") * nxt("electric_constant") / nxt("resistance")
}
