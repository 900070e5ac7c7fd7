// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Published parameter sets of the NXT motor against measurements of real motors, and the bridge
//! and the fuse that a set can have besides. `docs/reference/plant-points.md` shows the values.

use crate::common::points::{sets, steady, MISSED, POINTS};
use crate::common::{bench, current, fast, motor, near, run, slow, velocity, DT, SET_A};
use plant::{MotorDrive, MotorPort};

const B: MotorPort = MotorPort::B;

#[test]
fn each_set_meets_the_published_points_but_for_those_that_are_named() {
    let mut missed = Vec::new();
    for set in sets() {
        for point in POINTS {
            if point.passes(set.value(point)) == Some(false) {
                missed.push((set.name, point.condition, point.quantity));
            }
        }
    }
    let named: Vec<_> = MISSED
        .iter()
        .map(|miss| (miss.set, miss.condition, miss.quantity))
        .collect();
    assert_eq!(missed, named);
}

#[test]
fn a_bridge_takes_its_drop_from_the_voltage_and_a_small_voltage_does_nothing() {
    let mut robot = bench(SET_A, r#", "driver_drop": 0.6"#);
    run(&mut robot, 0.5, slow(0.05), MotorDrive::Coast, 9.0);
    assert_eq!(current(&robot, B), 0.0);
    run(&mut robot, 2.0, slow(1.0), MotorDrive::Coast, 9.0);
    near(velocity(&robot, B), steady(SET_A, 8.4, 0.0).0, 1e-3);
    let mut fast_decay = bench(SET_A, r#", "driver_drop": 0.6, "inductance": 0.0047"#);
    run(&mut fast_decay, 2.0, fast(1.0), MotorDrive::Coast, 9.0);
    near(velocity(&fast_decay, B), steady(SET_A, 8.4, 0.0).0, 1e-2);
}

#[test]
fn a_bridge_with_a_resistance_takes_its_voltage_from_the_terminals() {
    let mut robot = bench(SET_A, r#", "driver_resistance": 1.0"#);
    run(&mut robot, 2.0, slow(1.0), MotorDrive::Coast, 9.0);
    let motor = robot.motor(B).unwrap();
    near(motor.voltage(), 9.0 - motor.current(), 1e-9);
    near(
        velocity(&robot, B),
        steady(SET_A, 9.0 - motor.current(), 0.0).0,
        1e-6,
    );
}

#[test]
fn friction_at_rest_grows_with_the_torque_and_falls_along_stribecks_curve() {
    let curve = r#", "static_friction": 0.02, "stribeck_velocity": 4, "gear_friction": 0.14"#;
    let motor = motor(&format!("{}{curve}}}", SET_A.trim_end_matches('}')));
    let volts = |torque: f64| motor.resistance / motor.torque_constant * torque;
    // At rest the winding must bear load, static friction and its own share.
    let breaks_away = volts((0.115 + 0.02) / (1.0 - 0.14)) / 9.0;
    for (duty, turns) in [(breaks_away - 0.002, false), (breaks_away + 0.002, true)] {
        let mut robot = bench(SET_A, curve);
        robot.motor_mut(B).unwrap().set_load_torque(0.115);
        run(&mut robot, 0.3, slow(duty), MotorDrive::Coast, 9.0);
        assert_eq!(velocity(&robot, B) != 0.0, turns, "duty {duty}");
    }
    // While it turns, load and friction at this speed take the winding's torque.
    let (speed, current) = steady(
        &format!("{}{curve}}}", SET_A.trim_end_matches('}')),
        5.0,
        0.1,
    );
    let driving = motor.torque_constant * current;
    let excess = (0.02 - motor.coulomb_friction + 0.14 * driving) * (-speed / 4.0).exp();
    let lost = motor.coulomb_friction + excess + motor.viscous_friction * speed;
    near(driving, 0.1 + lost, 1e-6);
}

#[test]
fn stalled_on_9_volt_the_fuse_opens_after_some_seconds_and_closes_when_it_has_cooled() {
    let fuse = r#", "cut_out": {"trip_current": 0.9, "reset_current": 0.5, "time_constant": 66}"#;
    let mut robot = bench(SET_A, fuse);
    robot.motor_mut(B).unwrap().set_load_torque(0.55);
    let mut opened = None;
    let mut closed = None;
    for step in 0..1_200_000 {
        let time = f64::from(step) * DT;
        robot.step(DT, &[MotorDrive::Coast, slow(1.0), MotorDrive::Coast], 9.0);
        let open = robot.motor(B).unwrap().cut_out();
        if open && opened.is_none() {
            opened = Some(time);
            robot.motor_mut(B).unwrap().set_load_torque(0.0);
        }
        if opened.is_some() && !open {
            closed = Some(time);
            break;
        }
    }
    // 1.7 A: 66 s times -ln(1 - (0.9 / 1.71)^2); then a cooling by (0.5 / 0.9)^2.
    near(
        opened.unwrap(),
        66.0 * -(1.0 - (0.9_f64 / 1.71).powi(2)).ln(),
        0.03,
    );
    near(
        closed.unwrap() - opened.unwrap(),
        66.0 * 2.0 * (1.8_f64).ln(),
        0.01,
    );
}
