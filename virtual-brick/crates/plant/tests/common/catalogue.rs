// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Motors and bodies of the catalogue for the tests of several crates.
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
const BALANCER: [&str; 8] = [
    "wheel_radius",
    "wheel_mass",
    "wheel_inertia",
    "track",
    "mass",
    "centre_height",
    "pitch_inertia",
    "yaw_inertia",
];

/// A constant of an entry in SI units, as a member of JSON.
fn member(group: &str, entry: &str, name: &str) -> String {
    format!(r#""{name}": {}"#, constant(group, entry, name))
}

fn constant(group: &str, entry: &str, name: &str) -> f64 {
    let after = |text: &'static str, mark: &str| text.split_once(mark).unwrap().1;
    let group = after(PARTS, &format!(r#""{group}": {{"#));
    let entry = after(group, &format!(r#""{entry}": {{"#));
    let value = after(entry, &format!(r#""{name}": {{"value": "#));
    value.split_once(',').unwrap().0.parse().unwrap()
}

/// Constants of a motor as members of JSON.
pub fn motor_members(entry: &str, names: &[&str]) -> String {
    let members: Vec<String> = names
        .iter()
        .map(|name| member("motors", entry, name))
        .collect();
    members.join(", ")
}

fn linear_motor(entry: &str) -> String {
    format!("{{{}}}", motor_members(entry, &LINEAR))
}

/// A constant of the NXT motor in SI units.
pub fn nxt(name: &str) -> f64 {
    constant("motors", "nxt", name)
}

/// The NXT motor without dry friction and play, as JSON: Table 1 of Bradley et al. (2012).
pub static TABLE_1: LazyLock<String> = LazyLock::new(|| linear_motor("nxt"));

/// Winding and inertia of the motor that is fitted to published measurements, as JSON.
pub static FITTED_MOTOR: LazyLock<String> = LazyLock::new(|| linear_motor("nxt_fitted"));

/// The motor of NXTway-GS (Yamamoto 2008; constants of Watanabe), as JSON.
pub static NXTWAY_MOTOR: LazyLock<String> = LazyLock::new(|| linear_motor("nxtway"));

/// The body of NXTway-GS as members of JSON, without its pitch at the start.
pub static NXTWAY_BODY: LazyLock<String> = LazyLock::new(|| {
    let members = BALANCER.map(|name| member("bodies", "nxtway", name));
    let ports = r#""kind": "balancer", "left": "B", "right": "C""#;
    format!("{ports}, {}", members.join(", "))
});

/// A constant of the body of NXTway-GS in SI units.
pub fn nxtway_body(name: &str) -> f64 {
    constant("bodies", "nxtway", name)
}

/// A constant of the motor of NXTway-GS in SI units.
pub fn nxtway_motor(name: &str) -> f64 {
    constant("motors", "nxtway", name)
}

/// Torque per speed of the NXT motor with shorted windings in N m s/rad.
pub fn damping() -> f64 {
    nxt("viscous_friction") + nxt("torque_constant") * nxt("electric_constant") / nxt("resistance")
}
