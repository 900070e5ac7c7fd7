// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The differential drive: path, friction, energy, determinism.

use crate::common::catalogue::{damping, nxt};
use crate::common::{angle, near, run, slow, vehicle, velocity, DT};
use plant::{MotorDrive, MotorPort};

const FRICTION: &str = r#", "coulomb_friction": 0.005, "static_friction": 0.01"#;

#[test]
fn equal_duty_cycles_drive_exactly_straight() {
    let mut robot = vehicle("");
    run(&mut robot, 3.0, slow(0.7), slow(0.7), 8.0);
    let pose = robot.pose().unwrap();
    assert_eq!((pose.y, pose.heading), (0.0, 0.0));
    assert!(pose.x > 0.5);
    near(pose.x, 0.028 * angle(&robot, MotorPort::B), 1e-9);
}

#[test]
fn steady_speed_balances_motor_torque_and_floor_friction() {
    let mut robot = vehicle("");
    run(&mut robot, 3.0, slow(0.7), slow(0.7), 8.0);
    let torque = (0.05 + 0.05) * 0.028 / 2.0;
    let stall = nxt("torque_constant") / nxt("resistance") * 5.6;
    let wanted = (stall - torque) / damping();
    near(velocity(&robot, MotorPort::B), wanted, 1e-6);
}

#[test]
fn constant_wheel_speeds_drive_a_circle_of_the_radius_that_they_give() {
    let mut robot = vehicle("");
    run(&mut robot, 3.0, slow(0.4), slow(0.8), 8.0);
    let start = robot.pose().unwrap();
    let (left, right) = (
        velocity(&robot, MotorPort::B),
        velocity(&robot, MotorPort::C),
    );
    let radius = 0.115 / 2.0 * (right + left) / (right - left);
    let centre_x = start.x - radius * start.heading.sin();
    let centre_y = start.y + radius * start.heading.cos();
    for _ in 0..60_000 {
        robot.step(DT, &[MotorDrive::Coast, slow(0.4), slow(0.8)], 8.0);
        let pose = robot.pose().unwrap();
        let distance = (pose.x - centre_x).hypot(pose.y - centre_y);
        near(distance, radius, 1e-6);
    }
    assert!(robot.pose().unwrap().heading - start.heading > std::f64::consts::TAU);
}

#[test]
fn opposite_duty_cycles_turn_on_the_spot() {
    let mut robot = vehicle("");
    run(&mut robot, 1.0, slow(-0.5), slow(0.5), 8.0);
    let pose = robot.pose().unwrap();
    assert!(pose.heading > 1.0);
    assert!(pose.x.hypot(pose.y) < 1e-12);
}

#[test]
fn the_mass_of_the_vehicle_slows_the_motors_down() {
    let mut free = crate::common::bench(&crate::common::TABLE_1, "");
    let mut loaded = vehicle("");
    run(&mut free, 0.037, slow(0.5), MotorDrive::Coast, 8.0);
    run(&mut loaded, 0.037, slow(0.5), slow(0.5), 8.0);
    let ratio = velocity(&loaded, MotorPort::B) / velocity(&free, MotorPort::B);
    assert!(ratio > 0.7 && ratio < 0.9, "{ratio}");
}

#[test]
fn the_vehicle_does_not_move_while_its_motors_cannot_break_away() {
    let mut robot = vehicle(FRICTION);
    run(&mut robot, 0.5, slow(0.02), slow(0.02), 8.0);
    assert_eq!(robot.pose().unwrap().x, 0.0);
    run(&mut robot, 0.5, slow(0.06), slow(0.06), 8.0);
    assert!(robot.pose().unwrap().x > 0.0);
}

#[test]
fn one_driven_wheel_turns_about_the_other_that_is_braked() {
    let mut robot = vehicle(FRICTION);
    run(&mut robot, 1.0, MotorDrive::Brake, slow(0.5), 8.0);
    assert!(robot.pose().unwrap().heading > 1.0);
    assert!(angle(&robot, MotorPort::B).abs() < 0.05 * angle(&robot, MotorPort::C));
}

#[test]
fn a_coasting_vehicle_never_gains_energy_and_stops() {
    for extra in ["", FRICTION, r#", "backlash": 0.05"#] {
        let mut robot = vehicle(extra);
        run(&mut robot, 1.0, slow(0.4), slow(0.9), 8.0);
        let mut energy = robot.kinetic_energy();
        for step in 0..60_000 {
            robot.step(DT, &[MotorDrive::Coast; 3], 8.0);
            let now = robot.kinetic_energy();
            assert!(
                now <= energy + 1e-15,
                "{extra}: step {step}: {now} after {energy}"
            );
            energy = now;
        }
        assert!(energy < 1e-9, "{extra}: {energy} J left");
    }
}

#[test]
fn wheels_with_backlash_start_to_roll_after_the_play() {
    let mut robot = vehicle(r#", "backlash": 0.05"#);
    let mut first = None;
    for _ in 0..2_000 {
        robot.step(DT, &[MotorDrive::Coast, slow(0.3), slow(0.3)], 8.0);
        if first.is_none() && robot.pose().unwrap().x > 0.0 {
            first = Some(angle(&robot, MotorPort::B));
        }
    }
    let first = first.unwrap();
    assert!((0.025..0.03).contains(&first), "{first}");
    let motor = robot.motor(MotorPort::B).unwrap();
    near(motor.angle() - motor.load_angle(), 0.025, 1e-6);
    near(robot.pose().unwrap().x, 0.028 * motor.load_angle(), 1e-9);
}

#[test]
fn two_runs_with_the_same_inputs_are_equal_to_the_bit() {
    let drive = |robot: &mut plant::Robot| {
        for step in 0..20_000_u32 {
            let left = slow(f64::from(step % 200) / 100.0 - 1.0);
            let right = slow(f64::from(step % 77) / 77.0);
            robot.step(DT, &[MotorDrive::Coast, left, right], 7.9);
        }
    };
    let extra = r#", "coulomb_friction": 0.005, "backlash": 0.03, "inductance": 0.004"#;
    let (mut one, mut two) = (vehicle(extra), vehicle(extra));
    drive(&mut one);
    drive(&mut two);
    assert_eq!(one, two);
    let (x, heading) = (one.pose().unwrap().x, one.pose().unwrap().heading);
    assert!(x.is_finite() && heading.is_finite() && x != 0.0);
}
