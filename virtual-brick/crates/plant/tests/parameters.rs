// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Errors of the configuration.

use crate::common::catalogue::{nxt, nxtway_body, NXTWAY_BODY};
use crate::common::{parameters, TABLE_1, VEHICLE};
use plant::{Robot, RobotParameters};

fn error(json: &str) -> String {
    Robot::new(&parameters(json)).unwrap_err().to_string()
}

fn with_motor(motor: &str) -> String {
    format!(r#"{{"motors": {{"B": {motor}}}}}"#)
}

#[test]
fn a_number_out_of_range_is_named_with_field_value_and_range() {
    let motor = TABLE_1.replace(&nxt("resistance").to_string(), "-1");
    assert_eq!(
        error(&with_motor(&format!(r#"{{"parameters": {motor}}}"#))),
        "motors.B.parameters.resistance = -1: expected a number from 0.1 to 100 (ohm)"
    );
}

#[test]
fn limits_are_those_that_the_error_says() {
    let field = format!(r#""electric_constant": {}"#, nxt("electric_constant"));
    assert!(TABLE_1.contains(&field), "{}", *TABLE_1);
    let with = |value: &str| {
        let motor = TABLE_1.replace(&field, &format!(r#""electric_constant": {value}"#));
        with_motor(&format!(r#"{{"parameters": {motor}}}"#))
    };
    assert!(Robot::new(&parameters(&with("10"))).is_ok());
    let with_inertia = |value: &str| {
        let set = TABLE_1.replace(
            &format!(r#""inertia": {}"#, nxt("inertia")),
            &format!(r#""inertia": {value}"#),
        );
        with_motor(&format!(r#"{{"parameters": {set}}}"#))
    };
    assert!(Robot::new(&parameters(&with_inertia("1e-6"))).is_ok());
    assert!(error(&with_inertia("0.9e-6")).starts_with("motors.B.parameters.inertia = 0.0000009"));
    assert_eq!(
        error(&with("10.1")),
        "motors.B.parameters.electric_constant = 10.1: expected a number from 0.0001 to 10 \
         (V s/rad)"
    );
}

#[test]
fn a_body_out_of_range_is_named() {
    let motors = format!(
        r#"{{"B": {{"parameters": {0}}}, "C": {{"parameters": {0}}}}}"#,
        *TABLE_1
    );
    let body = VEHICLE.replace(r#""mass": 0.6"#, r#""mass": 0.001"#);
    assert_eq!(
        error(&format!(r#"{{"motors": {motors}, "body": {body}}}"#)),
        "body.mass = 0.001: expected a number from 0.01 to 100 (kg)"
    );
}

#[test]
fn a_body_that_is_too_high_is_named() {
    let motors = format!(
        r#"{{"B": {{"parameters": {0}}}, "C": {{"parameters": {0}}}}}"#,
        *TABLE_1
    );
    let height = |value: &str| {
        let now = format!(r#""centre_height": {}"#, nxtway_body("centre_height"));
        let body = NXTWAY_BODY.replace(&now, &format!(r#""centre_height": {value}"#));
        format!(r#"{{"motors": {motors}, "body": {{{body}}}}}"#)
    };
    assert!(Robot::new(&parameters(&height("2"))).is_ok());
    assert_eq!(
        error(&height("2.1")),
        "body.centre_height = 2.1: expected a number from 0.001 to 2 (m)"
    );
}

#[test]
fn a_fuse_that_closes_only_above_its_trip_current_is_rejected() {
    let fuse = r#", "cut_out": {"trip_current": 0.9, "reset_current": 1, "time_constant": 66}}"#;
    let motor = TABLE_1.replace('}', fuse);
    assert_eq!(
        error(&with_motor(&format!(r#"{{"parameters": {motor}}}"#))),
        "motors.B.parameters.cut_out.reset_current = 1: expected a number from 0.001 to 0.9 \
         (A, not more than trip_current)"
    );
}

#[test]
fn static_friction_below_coulomb_friction_is_rejected() {
    let motor = TABLE_1.replace(
        "}",
        r#", "coulomb_friction": 0.02, "static_friction": 0.01}"#,
    );
    let message = error(&with_motor(&format!(r#"{{"parameters": {motor}}}"#)));
    assert!(
        message.starts_with("motors.B.parameters.static_friction = 0.01"),
        "{message}"
    );
}

#[test]
fn a_hand_without_a_rate_is_rejected() {
    let message = error(&with_motor(&format!(
        r#"{{"parameters": {}, "held_by_hand": true}}"#,
        *TABLE_1
    )));
    assert!(
        message.starts_with("motors.B.hand_rate = (absent)"),
        "{message}"
    );
}

#[test]
fn a_wheel_without_a_motor_is_rejected() {
    let motors = format!(r#"{{"B": {{"parameters": {}}}}}"#, *TABLE_1);
    let message = error(&format!(r#"{{"motors": {motors}, "body": {VEHICLE}}}"#));
    assert!(
        message.starts_with("body.right = C: expected a port"),
        "{message}"
    );
}

#[test]
fn the_left_wheel_needs_a_motor_as_the_right_one_does() {
    let motors = format!(r#"{{"C": {{"parameters": {}}}}}"#, *TABLE_1);
    let message = error(&format!(r#"{{"motors": {motors}, "body": {VEHICLE}}}"#));
    assert!(
        message.starts_with("body.left = B: expected a port"),
        "{message}"
    );
}

#[test]
fn both_wheels_on_one_motor_are_rejected() {
    let motors = format!(r#"{{"B": {{"parameters": {}}}}}"#, *TABLE_1);
    let body = VEHICLE.replace(r#""right": "C""#, r#""right": "B""#);
    let message = error(&format!(r#"{{"motors": {motors}, "body": {body}}}"#));
    assert_eq!(
        message,
        "body.right = B: expected another motor than body.left"
    );
}

#[test]
fn unknown_fields_are_rejected_at_every_level() {
    for json in [
        r#"{"wheels": 4}"#.to_owned(),
        r#"{"motors": {"D": null}}"#.to_owned(),
        with_motor(&format!(r#"{{"parameters": {}, "colour": 1}}"#, *TABLE_1)),
        with_motor(r#"{"parameters": {"resistance": 1.0, "mood": 2}}"#),
        r#"{"body": {"kind": "bench", "legs": 4}}"#.to_owned(),
        format!(
            r#"{{"body": {}, "legs": 4}}}}"#,
            VEHICLE.trim_end_matches('}')
        ),
        r#"{"body": {"kind": "boat"}}"#.to_owned(),
    ] {
        assert!(
            serde_json::from_str::<RobotParameters>(&json).is_err(),
            "{json}"
        );
    }
}

#[test]
fn an_empty_configuration_is_a_bench_with_nothing_plugged_in() {
    let mut robot = Robot::new(&parameters("{}")).unwrap();
    robot.step(1e-4, &[plant::MotorDrive::Brake; 3], 8.0);
    assert_eq!(robot, Robot::new(&RobotParameters::default()).unwrap());
}
