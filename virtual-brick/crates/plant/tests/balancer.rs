// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The body that balances: falls as published, keeps its energy, stands under published gains.

use crate::common::catalogue::{nxtway_body, nxtway_motor, NXTWAY_BODY, NXTWAY_MOTOR};
use crate::common::{near, robot, run, slow, velocity, DT};
use plant::{MotorDrive, MotorPort, Robot};

fn balancer(motor: &str, extra: &str) -> Robot {
    let motors = format!(r#"{{"B": {{"parameters": {motor}}}, "C": {{"parameters": {motor}}}}}"#);
    robot(&format!(
        r#"{{"motors": {motors}, "body": {{{}{extra}}}}}"#,
        *NXTWAY_BODY
    ))
}

fn pitch(robot: &Robot) -> f64 {
    robot.pitch().unwrap().0
}

#[test]
fn released_with_shorted_windings_it_falls_with_the_published_unstable_pole() {
    let mut robot = balancer(&NXTWAY_MOTOR, r#", "start_pitch": 1e-6"#);
    robot.set_held(false);
    run(&mut robot, 0.6, MotorDrive::Brake, MotorDrive::Brake, 8.0);
    let early = pitch(&robot);
    run(&mut robot, 0.4, MotorDrive::Brake, MotorDrive::Brake, 8.0);
    near((pitch(&robot) / early).ln() / 0.4, 7.437, 0.002);
}

#[test]
fn a_hand_holds_it_where_it_is_until_released() {
    let mut robot = balancer(&NXTWAY_MOTOR, r#", "start_pitch": 0.1"#);
    run(&mut robot, 1.0, MotorDrive::Coast, MotorDrive::Coast, 8.0);
    assert_eq!(robot.pitch().unwrap(), (0.1, 0.0));
    robot.set_held(false);
    run(&mut robot, 0.1, MotorDrive::Coast, MotorDrive::Coast, 8.0);
    assert!(pitch(&robot) > 0.101);
}

#[test]
fn fallen_it_lies_on_the_floor_at_its_last_pitch() {
    let mut robot = balancer(
        &NXTWAY_MOTOR,
        r#", "start_pitch": -0.05, "fallen_pitch": 1.2"#,
    );
    robot.set_held(false);
    run(&mut robot, 5.0, MotorDrive::Brake, MotorDrive::Brake, 8.0);
    near(pitch(&robot), -1.2, 1e-9);
    assert!(robot.pitch().unwrap().1.abs() < 1e-9);
}

/// Held upright, wheels and body have the energies of their motions: a mass that rolls, a body that
/// turns about the vertical with a wheel on each side, and shafts that spin.
#[test]
fn rolling_and_turning_have_the_energy_of_their_masses() {
    let spin = 2.0 * (nxtway_body("wheel_inertia") + nxtway_motor("inertia"));
    let wheels = 2.0 * nxtway_body("wheel_mass");
    let track = nxtway_body("track");
    for (left, mass, inertia) in [
        (0.5, nxtway_body("mass") + wheels, 0.0),
        (
            -0.5,
            0.0,
            nxtway_body("yaw_inertia") + wheels * track * track / 4.0,
        ),
    ] {
        let mut robot = balancer(&NXTWAY_MOTOR, "");
        run(&mut robot, 0.5, slow(left), slow(0.5), 8.0);
        let shaft = velocity(&robot, MotorPort::C);
        let speed = nxtway_body("wheel_radius") * shaft;
        let yaw_rate = 2.0 * speed / track;
        let doubled = mass * speed * speed + inertia * yaw_rate * yaw_rate + spin * shaft * shaft;
        near(robot.kinetic_energy(), doubled / 2.0, 1e-9);
    }
}

/// Without friction and with open windings the sum of kinetic and potential energy stays.
#[test]
fn falling_without_friction_keeps_the_energy() {
    let free = r#"{"resistance": 6.69, "torque_constant": 0.317, "electric_constant": 0.468,
        "viscous_friction": 0.0, "inertia": 0.001}"#;
    let mut robot = balancer(free, r#", "start_pitch": 0.05, "fallen_pitch": 1.5"#);
    robot.set_held(false);
    let weight = 0.6 * 9.81 * 0.072;
    let energy = |robot: &Robot| robot.kinetic_energy() + weight * pitch(robot).cos();
    let start = energy(&robot);
    let mut steps = 0;
    while pitch(&robot) < 1.3 {
        robot.step(DT, &[MotorDrive::Coast; 3], 8.0);
        steps += 1;
        assert!(steps < 100_000);
    }
    near(energy(&robot), start, 2e-3);
}

/// Falling moves mass away from the vertical axis: the body turns slower and falls faster, and
/// the sum of its energies stays.
#[test]
fn a_turning_body_that_falls_keeps_its_energy_and_turns_slower() {
    let free = r#"{"resistance": 6.69, "torque_constant": 0.317, "electric_constant": 0.468,
        "viscous_friction": 0.0, "inertia": 0.001}"#;
    let weight = 0.6 * 9.81 * 0.072;
    let energy = |robot: &Robot| robot.kinetic_energy() + weight * pitch(robot).cos();
    let mut fallen_in = Vec::new();
    for duty in [0.0, 1.0] {
        let mut robot = balancer(free, r#", "start_pitch": 0.05, "fallen_pitch": 1.5"#);
        run(&mut robot, 1.0, slow(-duty), slow(duty), 12.0);
        let (start, yaw_rate) = (energy(&robot), robot.yaw_rate());
        assert!(duty == 0.0 || yaw_rate > 5.0, "{yaw_rate}");
        robot.set_held(false);
        let mut steps = 0;
        while pitch(&robot) < 1.3 {
            robot.step(DT, &[MotorDrive::Coast; 3], 8.0);
            steps += 1;
            assert!(steps < 100_000);
        }
        near(energy(&robot), start, 2e-3);
        assert!(duty == 0.0 || robot.yaw_rate() < 0.9 * yaw_rate);
        fallen_in.push(steps);
    }
    assert!(fallen_in[1] < fallen_in[0], "{fallen_in:?}");
}

#[test]
fn equal_wheels_never_turn_it_and_opposite_ones_turn_it_on_the_spot() {
    let mut robot = balancer(&NXTWAY_MOTOR, "");
    run(&mut robot, 0.5, slow(0.3), slow(0.3), 8.0);
    assert_eq!(robot.pose().unwrap().heading, 0.0);
    let mut robot = balancer(&NXTWAY_MOTOR, "");
    run(&mut robot, 0.5, slow(-0.3), slow(0.3), 8.0);
    let pose = robot.pose().unwrap();
    assert!(pose.heading > 0.5 && pose.x.hypot(pose.y) < 1e-9);
    near(
        robot.yaw_rate(),
        0.04 / 0.14 * 2.0 * velocity(&robot, MotorPort::C),
        1e-9,
    );
}

/// The published state feedback, every 4 ms, from exact states.
#[test]
fn the_published_gains_keep_it_up_when_it_is_pushed() {
    let mut robot = balancer(&NXTWAY_MOTOR, r#", "start_pitch": 0.03"#);
    robot.set_held(false);
    let (mut duty, mut integral) = (0.0, 0.0);
    let mut farthest: f64 = 0.0;
    for step in 0..300_000 {
        if step % 40 == 0 {
            let (pitch, rate) = robot.pitch().unwrap();
            let shaft = |port| robot.motor(port).unwrap();
            let (left, right) = (shaft(MotorPort::B), shaft(MotorPort::C));
            let theta = (left.angle() + right.angle()) / 2.0 + pitch;
            let speed = (left.angular_velocity() + right.angular_velocity()) / 2.0 + rate;
            let volts = 0.83508 * theta
                + 34.18958 * pitch
                + 1.09951 * speed
                + 2.81409 * rate
                + 0.44721 * integral;
            integral += 0.004 * theta;
            duty = (volts / 8.0).clamp(-1.0, 1.0);
        }
        robot.set_push(if step % 50_000 < 1_000 { 2.0 } else { 0.0 });
        robot.step(DT, &[MotorDrive::Coast, slow(duty), slow(duty)], 8.0);
        farthest = farthest.max(pitch(&robot).abs());
    }
    assert!(farthest < 0.3, "{farthest} rad");
}
