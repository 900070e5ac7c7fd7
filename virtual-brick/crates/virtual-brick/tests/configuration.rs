// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Reading configurations: defaults, and errors that name the field.

use crate::support::catalogue::nxt as constant;
use crate::support::VEHICLE;
use nxt::{BatteryKind, SensorPorts};
use plant::{BodyParameters, MotorPort};
use virtual_brick::Configuration;

fn problem(json: &str) -> (String, String) {
    let error = Configuration::from_json(json).unwrap_err();
    assert!(error.to_string().starts_with("configuration"));
    (error.path, error.problem)
}

#[test]
fn a_whole_vehicle_is_read() {
    let configuration = Configuration::from_json(&VEHICLE).unwrap();
    assert_eq!(configuration.seed, 1);
    assert_eq!(configuration.board.battery.kind, BatteryKind::LiIon);
    let motors = &configuration.robot.motors;
    assert_eq!(motors.get(MotorPort::A).unwrap().hand_rate, Some(4.0));
    assert!(!motors.get(MotorPort::B).unwrap().held_by_hand);
    let sensors = configuration.board.sensors.all();
    assert_eq!(sensors[0].unwrap().inputs().len(), 1);
    assert_eq!(sensors[1..], [None; 3]);
    let track = match &configuration.robot.body {
        BodyParameters::DifferentialDrive(drive) => Some(drive.track),
        BodyParameters::Bench {} | BodyParameters::Balancer(_) => None,
    };
    assert_eq!(track, Some(0.115));
}

#[test]
fn an_absent_device_is_not_plugged_in() {
    let json = r#"{"battery": {"kind": "aa", "voltage": 9.0}}"#;
    let configuration = Configuration::from_json(json).unwrap();
    assert_eq!(configuration.robot.motors.get(MotorPort::A), None);
    assert_eq!(configuration.board.sensors, SensorPorts::default());
    assert_eq!(configuration.robot.body, BodyParameters::Bench {});
    assert_eq!(configuration.signal_period_cycles, 48_055);
}

#[test]
fn errors_name_the_path_of_the_field() {
    let inertia = format!(r#""inertia": {}"#, constant("inertia"));
    let resistance = format!(r#""resistance": {}, "#, constant("resistance"));
    for (from, to, path) in [
        (
            &*inertia,
            r#""inertia": "big""#,
            "motors.A.parameters.inertia",
        ),
        (&inertia, r#""inertia": 0.0"#, "motors.A.parameters.inertia"),
        (&resistance, "", "motors.A.parameters"),
        (
            r#""hand_rate": 4.0"#,
            r#""hand_rat": 4.0"#,
            "motors.A.hand_rat",
        ),
        (r#", "hand_rate": 4.0"#, "", "motors.A.hand_rate"),
        (r#""track": 0.115"#, r#""track": -1.0"#, "body.track"),
        (r#""track": 0.115,"#, "", "body"),
        (r#""left": "B""#, r#""left": "C""#, "body.right"),
        (r#""left": "B""#, r#""left": "A""#, "body.left"),
        (r#""kind": "touch""#, r#""kind": "sonar""#, "sensors.1.kind"),
        (r#""voltage": 8.0"#, r#""voltage": -3.0"#, "battery.voltage"),
    ] {
        let json = VEHICLE.replacen(from, to, 1);
        assert_ne!(json, *VEHICLE, "{from}");
        assert_eq!(problem(&json).0, path, "{to}");
    }
}

#[test]
fn an_unknown_field_is_refused_with_the_known_ones() {
    let (path, text) = problem(r#"{"battery": {"kind": "aa", "voltage": 9.0}, "wheels": 2}"#);
    assert_eq!(path, "wheels");
    assert!(text.contains("unknown field `wheels`"), "{text}");
}

#[test]
fn a_bench_has_no_vehicle_fields() {
    let json = r#"{"battery": {"kind": "aa", "voltage": 9.0},
        "body": {"kind": "bench", "mass": 1.0}}"#;
    let (path, text) = problem(json);
    assert_eq!(path, "body");
    assert!(text.contains("`mass`"), "{text}");
}

#[test]
fn text_after_the_configuration_is_refused() {
    let (path, text) = problem(r#"{"battery": {"kind": "aa", "voltage": 9.0}} more"#);
    assert_eq!(path, ".");
    assert!(text.contains("trailing"), "{text}");
}

#[test]
fn text_that_is_not_json_is_refused_with_line_and_column() {
    assert!(problem("{").1.contains("line 1"));
}

#[test]
fn each_fault_of_the_silicon_has_a_switch() {
    let silicon = |json| Configuration::from_json(json).unwrap().errata;
    assert!(silicon("{}").twi_nack_lost);
    assert!(!silicon("{}").spi_reset_needs_two);
    let switched = silicon(r#"{"errata": {"twi_nack_lost": false, "spi_reset_needs_two": true}}"#);
    assert!(!switched.twi_nack_lost);
    assert!(switched.spi_reset_needs_two);
    let (path, message) = problem(r#"{"errata": {"twi_nack": true}}"#);
    assert_eq!(path, "errata.twi_nack");
    assert!(message.contains("twi_nack_lost"), "{message}");
}

#[test]
fn timing_is_a_profile_with_single_values_in_its_place() {
    let configuration = Configuration::from_json("{}").unwrap();
    assert_eq!(configuration.timing, virtual_brick::Timing::default());
    let json =
        r#"{"timing": {"profile": "pessimistic", "core_sync_cycles": 0}, "engine": "reference"}"#;
    let configuration = Configuration::from_json(json).unwrap();
    assert_eq!(configuration.timing.chip.apb_cycles, 3);
    assert_eq!(configuration.timing.chip.core_sync_cycles, 0);
    assert_eq!(configuration.engine, virtual_brick::Engine::Reference);
    // Whatever empties the code buffer besides branches is counted by the reference engine only.
    let json = r#"{"timing": {"code_buffer_loss": "gap"}, "engine": "fast"}"#;
    let configuration = Configuration::from_json(json).unwrap();
    assert_eq!(configuration.engine, virtual_brick::Engine::Reference);
    let (path, problem) = problem(r#"{"timing": {"apb_cycles": 0}}"#);
    assert_eq!(path, "timing.apb_cycles");
    assert_eq!(problem, "must be 1 to 16 cycles");
}
