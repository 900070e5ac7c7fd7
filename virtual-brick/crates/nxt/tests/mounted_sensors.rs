// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Sensors that sit on the robot measure the plant: gyro, light on the floor, distance of walls.

use crate::common::catalogue::NXTWAY_BODY;
use crate::common::{milliseconds, motor, Rig};

const VEHICLE: &str = r#""kind": "differential_drive", "left": "B", "right": "C",
    "wheel_radius": 0.028, "track": 0.115, "mass": 0.6, "yaw_inertia": 0.003,
    "castor_friction": 0, "rolling_resistance": 0"#;
/// Black from 10 cm on; a wall at 1 m.
const AROUND: &str = r#"{"floor": {"pixel": 0.1, "corner": [0.1, -0.5], "width": 10,
    "reflectance": [0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0,
    0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0,
    0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0]},
    "walls": [{"from": [1, -1], "to": [1, 1]}]}"#;

fn robot(body: &str, around: &str) -> String {
    let motor = motor();
    let motors = format!(r#"{{"B": {motor}, "C": {motor}}}"#);
    format!(r#"{{"motors": {motors}, "body": {{{body}}}, "surroundings": {around}}}"#)
}

fn raw(rig: &mut Rig, port: usize) -> u16 {
    rig.run(milliseconds(4));
    rig.words()[port - 1]
}

#[test]
fn a_gyro_counts_degrees_per_second_about_its_rest_value() {
    let sensors = r#"{"sensors": {"4": {"kind": "gyro", "rest": 605}}}"#;
    let mut rig = Rig::running(sensors, "{}");
    assert_eq!(raw(&mut rig, 4), 605);
    rig.set("gyro.4", 1.0);
    assert_eq!(raw(&mut rig, 4), 605 + 57);
    rig.set("gyro.4", -20.0);
    assert_eq!(raw(&mut rig, 4), 0);
}

#[test]
fn a_gyro_on_a_falling_body_measures_its_pitch_rate() {
    let sensors = r#"{"sensors": {"4": {"kind": "gyro", "axis": "pitch"}}}"#;
    let body = format!(r#"{}, "start_pitch": 0.1"#, *NXTWAY_BODY);
    let mut rig = Rig::running(sensors, &robot(&body, "{}"));
    assert_eq!(raw(&mut rig, 4), 600);
    rig.set("body.held", 0.0);
    rig.run(milliseconds(150));
    let seen = f64::from(raw(&mut rig, 4)) - 600.0;
    let rate = rig.signal("body.pitch_rate").to_degrees();
    assert!(rate > 30.0 && (seen - rate).abs() < 6.0, "{seen} {rate}");
}

#[test]
fn a_push_tips_a_body_that_stands() {
    let mut rig = Rig::running("{}", &robot(&NXTWAY_BODY, "{}"));
    rig.set("body.held", 0.0);
    rig.set("body.push", -1.0);
    rig.run(milliseconds(50));
    assert!(rig.signal("body.pitch") < -0.001);
}

#[test]
fn light_and_ultrasonic_sensors_on_a_vehicle_see_floor_and_wall_come() {
    let sensors = r#"{"sensors": {"3": {"kind": "light", "mount": {"x": 0.05, "y": 0}},
        "2": {"kind": "gyro", "axis": "yaw"}}}"#;
    let mut rig = Rig::running(sensors, &robot(VEHICLE, AROUND));
    rig.outputs(1 << 29 | 1 << 20, 1 << 29);
    assert_eq!(raw(&mut rig, 3), 458, "white");
    rig.drive([0, 60, 60], 0);
    rig.run(milliseconds(1_000));
    assert!(rig.signal("body.x") > 0.1);
    assert_eq!(raw(&mut rig, 3), 900, "black");
    rig.drive([0, -60, 60], 0);
    rig.run(milliseconds(300));
    assert!(raw(&mut rig, 2) > 700, "turns left");
}
