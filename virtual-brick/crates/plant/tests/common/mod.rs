// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Robots for the tests.
#![allow(dead_code, clippy::unwrap_used, clippy::expect_used)]

pub mod catalogue;
pub mod points;

pub use catalogue::TABLE_1;
use plant::{Decay, MotorDrive, MotorParameters, MotorPort, Robot, RobotParameters};

/// Step in s: 4,800 cycles of the brick's clock.
pub const DT: f64 = 4800.0 * 7.0 / 336_384_000.0;

/// The set identified for the MinSeg robot (MATLAB parameter file, header "NXT parameters").
pub const SET_A: &str = r#"{"resistance": 5.262773292, "torque_constant": 0.3233728703,
    "electric_constant": 0.4952900056, "viscous_friction": 6.001689451e-4,
    "coulomb_friction": 7.299397206e-3, "inertia": 1.321184025e-3}"#;

pub const VEHICLE: &str = r#"{"kind": "differential_drive", "left": "B", "right": "C",
    "wheel_radius": 0.028, "track": 0.115, "mass": 0.6, "yaw_inertia": 0.003,
    "castor_friction": 0.05, "rolling_resistance": 0.05}"#;

pub fn parameters(json: &str) -> RobotParameters {
    serde_json::from_str(json).unwrap()
}

pub fn robot(json: &str) -> Robot {
    Robot::new(&parameters(json)).unwrap()
}

pub fn motor(json: &str) -> MotorParameters {
    serde_json::from_str(json).unwrap()
}

/// One motor in port B on the bench, with extra members of its parameters.
pub fn bench(set: &str, extra: &str) -> Robot {
    let set = set.trim_end_matches('}');
    robot(&format!(
        r#"{{"motors": {{"B": {{"parameters": {set}{extra}}}}}}}}}"#
    ))
}

/// Motors of Table 1 in ports B and C under a vehicle.
pub fn vehicle(extra: &str) -> Robot {
    let set = format!("{}{extra}}}", TABLE_1.trim_end_matches('}'));
    let motors = format!(r#"{{"B": {{"parameters": {set}}}, "C": {{"parameters": {set}}}}}"#);
    robot(&format!(r#"{{"motors": {motors}, "body": {VEHICLE}}}"#))
}

pub const fn slow(duty: f64) -> MotorDrive {
    MotorDrive::Pwm {
        duty,
        decay: Decay::Slow,
        period: 125e-6,
    }
}

pub const fn fast(duty: f64) -> MotorDrive {
    MotorDrive::Pwm {
        duty,
        decay: Decay::Fast,
        period: 125e-6,
    }
}

/// Steps for `time` s with the same drive in ports B and C.
pub fn run(robot: &mut Robot, time: f64, left: MotorDrive, right: MotorDrive, supply: f64) {
    let steps = (time / DT).round() as usize;
    for _ in 0..steps {
        robot.step(DT, &[MotorDrive::Coast, left, right], supply);
    }
}

pub fn angle(robot: &Robot, port: MotorPort) -> f64 {
    robot.motor(port).unwrap().angle()
}

pub fn velocity(robot: &Robot, port: MotorPort) -> f64 {
    robot.motor(port).unwrap().angular_velocity()
}

pub fn current(robot: &Robot, port: MotorPort) -> f64 {
    robot.motor(port).unwrap().current()
}

pub fn near(value: f64, wanted: f64, share: f64) {
    assert!(
        (value - wanted).abs() <= share * wanted.abs(),
        "{value} is not {wanted}"
    );
}
