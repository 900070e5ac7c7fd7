// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What sensors see of floor and walls.

use crate::common::{near, parameters};
use plant::{Mount, Pose, Surroundings};

/// Left half black, right half white: four pixels of 10 cm around the origin.
const FLOOR: &str = r#"{"floor": {"pixel": 0.1, "corner": [-0.1, -0.1], "width": 2,
    "reflectance": [0, 255, 51, 255], "outside": 0.5}}"#;
const BOX: &str =
    r#"{"walls": [{"from": [1, -1], "to": [1, 1]}, {"from": [-1, 2], "to": [1, 2]}]}"#;
const FRONT: Mount = Mount {
    x: 0.05,
    y: 0.0,
    direction: 0.0,
};

fn surroundings(json: &str) -> Surroundings {
    serde_json::from_str(json).unwrap()
}

fn pose(x: f64, y: f64, heading: f64) -> Pose {
    Pose { x, y, heading }
}

#[test]
fn the_first_row_of_pixels_is_the_upper_one() {
    let floor = surroundings(FLOOR);
    let below = |x, y| {
        floor
            .reflectance(pose(x - 0.05, y, 0.0), &FRONT, 0.0)
            .unwrap()
    };
    assert_eq!([below(-0.05, 0.05), below(0.05, 0.05)], [0.0, 1.0]);
    near(below(-0.05, -0.05), 0.2, 1e-12);
    assert_eq!(below(0.15, 0.05), 0.5);
}

#[test]
fn a_spot_on_an_edge_sees_something_between() {
    let floor = surroundings(FLOOR);
    let share = floor
        .reflectance(pose(-0.049, 0.05, 0.0), &FRONT, 0.01)
        .unwrap();
    assert!(share > 0.3 && share < 0.7, "{share}");
}

#[test]
fn the_mount_turns_with_the_robot() {
    let walls = surroundings(BOX);
    let see = |heading| walls.distance(pose(0.0, 0.0, heading), &FRONT).unwrap();
    near(see(0.0), 0.95, 1e-9);
    near(see(std::f64::consts::FRAC_PI_2), 1.95, 1e-9);
    assert_eq!(see(-std::f64::consts::FRAC_PI_2), f64::INFINITY);
}

#[test]
fn without_a_floor_or_walls_nothing_is_measured() {
    let nothing = surroundings("{}");
    assert_eq!(nothing.reflectance(Pose::default(), &FRONT, 0.0), None);
    assert_eq!(nothing.distance(Pose::default(), &FRONT), None);
}

#[test]
fn a_picture_that_is_not_a_rectangle_is_refused() {
    let wrong = FLOOR.replace(r#""width": 2"#, r#""width": 3"#);
    let robot = parameters(&format!(r#"{{"surroundings": {wrong}}}"#));
    let error = robot.check().unwrap_err().to_string();
    assert!(error.contains("surroundings.floor.width = 3"), "{error}");
}
