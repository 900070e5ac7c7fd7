// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A single motor against its formulas and against measurements of real ones.

use crate::common::catalogue::{damping, nxt};
use crate::common::{
    angle, bench, current, fast, near, robot, run, slow, velocity, DT, SET_A, TABLE_1,
};
use plant::{MotorDrive, MotorPort};

const B: MotorPort = MotorPort::B;
const RPM: f64 = std::f64::consts::PI / 30.0;

fn held(set: &str) -> plant::Robot {
    robot(&format!(
        r#"{{"motors": {{"B": {{"parameters": {set}, "held_by_hand": true, "hand_rate": 4}}}}}}"#
    ))
}

/// Steady velocity and current at a supply, against a load.
fn steady(set: &str, supply: f64, load: f64) -> (f64, f64) {
    let mut robot = bench(set, "");
    robot.motor_mut(B).unwrap().set_load_torque(load);
    run(&mut robot, 1.0, slow(1.0), MotorDrive::Coast, supply);
    (velocity(&robot, B), current(&robot, B))
}

#[test]
fn step_response_of_table_1_has_the_gain_and_time_constant_of_the_paper() {
    let mut robot = bench(&TABLE_1, "");
    let mut rise = None;
    for step in 1..=10_000 {
        robot.step(DT, &[MotorDrive::Coast, slow(1.0), MotorDrive::Coast], 1.0);
        if rise.is_none() && velocity(&robot, B) >= 2.029 * (1.0 - (-1.0_f64).exp()) {
            rise = Some(f64::from(step) * DT);
        }
    }
    near(velocity(&robot, B), 2.029, 0.0005);
    near(rise.unwrap(), 0.037, 0.01);
}

#[test]
fn the_step_response_follows_the_exact_exponential() {
    let (k, r, ke) = (
        nxt("torque_constant"),
        nxt("resistance"),
        nxt("electric_constant"),
    );
    let (b, j) = (nxt("viscous_friction"), nxt("inertia"));
    let (gain, tau) = (k / (b * r + k * ke), r * j / (b * r + k * ke));
    let mut robot = bench(&TABLE_1, "");
    for step in 1..=3_000 {
        robot.step(DT, &[MotorDrive::Coast, slow(0.5), MotorDrive::Coast], 8.0);
        let time = f64::from(step) * DT;
        let wanted = 4.0 * gain * (1.0 - (-time / tau).exp());
        assert!((velocity(&robot, B) - wanted).abs() < 1e-5, "at {time} s");
        let path = 4.0 * gain * (time - tau * (1.0 - (-time / tau).exp()));
        assert!((angle(&robot, B) - path).abs() < 1e-6, "at {time} s");
    }
}

#[test]
fn a_locked_rotor_takes_stall_current_and_gives_stall_torque() {
    let mut robot = held(SET_A);
    run(&mut robot, 0.1, slow(1.0), MotorDrive::Coast, 9.0);
    near(current(&robot, B), 9.0 / 5.262773292, 1e-9);
    near(current(&robot, B), 2.0, 0.15);
    near(current(&robot, B) * 0.3233728703, 0.50, 0.12);
}

#[test]
fn a_load_just_above_the_stall_torque_turns_the_shaft_back() {
    let stall = 9.0 / 5.262773292 * 0.3233728703;
    assert!(steady(SET_A, 9.0, stall - 0.02).0 > 0.0);
    assert!(steady(SET_A, 9.0, stall + 0.02).0 < 0.0);
    assert_eq!(steady(SET_A, 9.0, stall).0, 0.0);
}

#[test]
fn unloaded_at_9_volt_the_motor_turns_as_measured() {
    let (speed, amperes) = steady(SET_A, 9.0, 0.0);
    near(speed / RPM, 170.0, 0.03);
    near(amperes, 0.060, 0.15);
}

#[test]
fn loaded_at_9_volt_the_motor_turns_as_measured() {
    let (speed, amperes) = steady(SET_A, 9.0, 0.167);
    near(speed / RPM, 117.0, 0.05);
    near(amperes, 0.55, 0.05);
}

#[test]
fn loaded_at_7_2_volt_the_motor_turns_as_measured() {
    let (speed, amperes) = steady(SET_A, 7.2, 0.167);
    near(speed / RPM, 82.0, 0.05);
    near(amperes, 0.55, 0.05);
}

#[test]
fn unloaded_at_8_16_volt_the_motor_turns_as_measured() {
    near(steady(SET_A, 8.16, 0.0).0 / RPM, 150.0, 0.10);
}

#[test]
fn below_breakaway_the_shaft_stays_at_rest_without_a_trace_of_motion() {
    let mut robot = bench(SET_A, r#", "static_friction": 0.02"#);
    run(&mut robot, 0.5, slow(0.3), MotorDrive::Coast, 1.0);
    assert_eq!(angle(&robot, B), 0.0);
    run(&mut robot, 0.5, slow(0.35), MotorDrive::Coast, 1.0);
    assert!(velocity(&robot, B) > 0.1);
}

/// Alone, and with others plugged in: friction acts on the shaft that it belongs to.
#[test]
fn a_motor_turns_alike_in_every_port() {
    let turned = |ports: &[char], driven: usize| {
        let plugged = |port: &char| format!(r#""{port}": {{"parameters": {SET_A}}}"#);
        let motors: Vec<String> = ports.iter().map(plugged).collect();
        let mut robot = robot(&format!(r#"{{"motors": {{{}}}}}"#, motors.join(", ")));
        let mut drives = [MotorDrive::Coast; 3];
        drives[driven] = slow(0.5);
        for _ in 0..1_000 {
            robot.step(DT, &drives, 8.0);
        }
        angle(&robot, [MotorPort::A, B, MotorPort::C][driven])
    };
    let expected = turned(&['A'], 0);
    assert!(expected > 0.1);
    for driven in 0..3 {
        assert_eq!(turned(&['A', 'B', 'C'], driven), expected);
    }
    assert_eq!((turned(&['B'], 1), turned(&['C'], 2)), (expected, expected));
}

#[test]
fn once_moving_the_shaft_needs_only_the_coulomb_friction() {
    let mut robot = bench(SET_A, r#", "static_friction": 0.02"#);
    run(&mut robot, 0.5, slow(0.35), MotorDrive::Coast, 1.0);
    run(&mut robot, 0.5, slow(0.25), MotorDrive::Coast, 1.0);
    assert!(velocity(&robot, B) > 0.1);
}

#[test]
fn a_braked_shaft_stops_and_never_turns_back() {
    let mut robot = bench(SET_A, "");
    run(&mut robot, 0.5, slow(1.0), MotorDrive::Coast, 9.0);
    let mut last = angle(&robot, B);
    for _ in 0..10_000 {
        robot.step(DT, &[MotorDrive::Brake; 3], 9.0);
        assert!(angle(&robot, B) >= last);
        last = angle(&robot, B);
    }
    assert_eq!(velocity(&robot, B), 0.0);
}

#[test]
fn a_brake_stops_sooner_than_coasting() {
    let mut turned = Vec::new();
    for drive in [MotorDrive::Brake, MotorDrive::Coast] {
        let mut robot = bench(SET_A, "");
        run(&mut robot, 0.5, slow(1.0), MotorDrive::Coast, 9.0);
        let start = angle(&robot, B);
        run(&mut robot, 5.0, drive, MotorDrive::Coast, 9.0);
        turned.push(angle(&robot, B) - start);
    }
    assert!(turned[0] * 3.0 < turned[1], "{turned:?}");
}

#[test]
fn slow_decay_scales_the_speed_and_fast_decay_the_torque() {
    let mut half_slow = bench(&TABLE_1, "");
    run(&mut half_slow, 1.0, slow(0.5), MotorDrive::Coast, 8.0);
    near(velocity(&half_slow, B), 0.5 * 8.0 * 2.029, 0.001);
    let mut half_fast = bench(&TABLE_1, "");
    run(&mut half_fast, 2.0, fast(0.5), MotorDrive::Coast, 8.0);
    assert!(velocity(&half_fast, B) > 0.9 * 8.0 * 2.029);
    let mut locked = held(&TABLE_1);
    run(&mut locked, 0.1, fast(0.5), MotorDrive::Coast, 8.0);
    near(current(&locked, B), 0.5 * 8.0 / nxt("resistance"), 1e-9);
}

#[test]
fn with_inductance_fast_decay_gives_far_less_torque_at_low_duty_than_slow_decay() {
    let set = format!(r#"{}, "inductance": 0.0047}}"#, SET_A.trim_end_matches('}'));
    let stalled = |drive| {
        let mut robot = held(&set);
        run(&mut robot, 0.1, drive, MotorDrive::Coast, 9.0);
        current(&robot, B)
    };
    assert!(stalled(fast(0.2)) < 0.1 * stalled(slow(0.2)));
    near(
        stalled(fast(0.9)),
        (2.0 * 0.9 - 1.0) * 9.0 / 5.262773292,
        1e-9,
    );
    let mut last = 0.0;
    for percent in 1..=100 {
        let amperes = stalled(fast(f64::from(percent) / 100.0));
        assert!(
            amperes >= 0.999 * last,
            "{percent} %: {amperes} after {last}"
        );
        last = amperes;
    }
}

/// Mean current of a bridge that is on for `duty` of each period and gives the current back to the
/// supply in the rest, by small steps of L di/dt = U - E - R i.
fn switched_current(inductance: f64, emf: f64, duty: f64) -> f64 {
    let (supply, resistance, steps) = (9.0, 5.262773292, 1_000);
    let dt = 125e-6 / f64::from(steps);
    let (mut current, mut sum) = (0.0_f64, 0.0);
    for period in 0..100 {
        sum = 0.0;
        for step in 0..steps {
            let on = f64::from(step) < duty * f64::from(steps);
            let voltage = if on { supply } else { -supply };
            let next = current + dt / inductance * (voltage - emf - resistance * current);
            current = if on { next } else { next.max(0.0) };
            sum += current;
        }
        assert!(period < 99 || sum > 0.0);
    }
    sum / f64::from(steps)
}

#[test]
fn fast_decay_takes_the_mean_current_of_the_switched_circuit_at_any_duty_cycle() {
    let inductance = 0.0047;
    let set = format!(
        r#"{}, "inductance": {inductance}}}"#,
        SET_A.trim_end_matches('}')
    );
    for speed in [0.0, 4.0] {
        let emf = 0.4952900056 * speed;
        for percent in [10, 20, 40, 80, 90] {
            let duty = f64::from(percent) / 100.0;
            let mut robot = held(&set);
            robot.motor_mut(B).unwrap().set_hand_angle(speed * 10.0);
            run(&mut robot, 0.1, fast(duty), MotorDrive::Coast, 9.0);
            near(velocity(&robot, B), speed, 1e-9);
            let wanted = switched_current(inductance, emf, duty);
            let error = (current(&robot, B) - wanted).abs();
            assert!(
                error < 0.12 * wanted + 0.002,
                "{percent} % at {speed} rad/s: {} A, {wanted} A",
                current(&robot, B)
            );
        }
    }
}

#[test]
fn inductance_delays_the_current_by_its_time_constant() {
    let mut robot = held(&format!(
        r#"{}, "inductance": 0.0047}}"#,
        SET_A.trim_end_matches('}')
    ));
    let tau = 0.0047 / 5.262773292;
    for step in 1..=50 {
        robot.step(DT, &[MotorDrive::Coast, slow(1.0), MotorDrive::Coast], 9.0);
        let wanted = 9.0 / 5.262773292 * (1.0 - (-f64::from(step) * DT / tau).exp());
        assert!((current(&robot, B) - wanted).abs() < 2e-3, "step {step}");
    }
}

#[test]
fn within_the_backlash_the_load_stays_while_the_gear_train_turns() {
    let mut robot = bench(&TABLE_1, r#", "backlash": 0.07"#);
    run(&mut robot, 0.015, slow(0.5), MotorDrive::Coast, 8.0);
    let motor = robot.motor(B).unwrap();
    assert!((0.015..0.035).contains(&motor.angle()), "{}", motor.angle());
    assert!(motor.load_angle().abs() < 1e-12);
    run(&mut robot, 0.5, slow(0.5), MotorDrive::Coast, 8.0);
    let motor = robot.motor(B).unwrap();
    near(motor.angle() - motor.load_angle(), 0.035, 1e-9);
    run(&mut robot, 0.5, slow(-0.5), MotorDrive::Coast, 8.0);
    let motor = robot.motor(B).unwrap();
    near(motor.load_angle() - motor.angle(), 0.035, 1e-9);
}

#[test]
fn a_load_against_the_backlash_stays_pressed_to_one_side() {
    let mut robot = bench(&TABLE_1, r#", "backlash": 0.07"#);
    robot.motor_mut(B).unwrap().set_load_torque(0.05);
    for _ in 0..5_000 {
        robot.step(DT, &[MotorDrive::Brake; 3], 8.0);
    }
    let motor = robot.motor(B).unwrap();
    near(motor.angle() - motor.load_angle(), 0.035, 1e-9);
    near(motor.angular_velocity(), -0.05 / damping(), 0.01);
}

#[test]
fn coasting_never_gains_energy() {
    for extra in ["", r#", "backlash": 0.05"#] {
        let mut robot = bench(SET_A, extra);
        run(&mut robot, 0.4, slow(1.0), MotorDrive::Coast, 9.0);
        let mut energy = robot.kinetic_energy();
        assert!(energy > 0.1);
        for _ in 0..50_000 {
            robot.step(DT, &[MotorDrive::Coast; 3], 9.0);
            assert!(robot.kinetic_energy() <= energy);
            energy = robot.kinetic_energy();
        }
        assert_eq!(velocity(&robot, B), 0.0);
    }
}

#[test]
fn a_hand_turns_the_shaft_at_its_rate_and_stops_exactly_at_the_angle() {
    let mut robot = held(&TABLE_1);
    robot.motor_mut(B).unwrap().set_hand_angle(-1.0);
    run(&mut robot, 0.1, MotorDrive::Coast, MotorDrive::Coast, 8.0);
    near(angle(&robot, B), -0.4, 0.001);
    near(velocity(&robot, B), -4.0, 1e-9);
    run(&mut robot, 0.2, MotorDrive::Coast, MotorDrive::Coast, 8.0);
    assert_eq!(angle(&robot, B), -1.0);
    assert_eq!(velocity(&robot, B), 0.0);
}

#[test]
fn the_supply_gives_the_power_that_the_motor_uses_in_both_directions() {
    for (drive, load) in [
        (slow(0.6), 0.1),
        (slow(-0.6), -0.1),
        (fast(0.6), 0.1),
        (fast(-0.6), -0.1),
    ] {
        let mut robot = bench(&TABLE_1, "");
        robot.motor_mut(B).unwrap().set_load_torque(load);
        run(&mut robot, 2.0, drive, MotorDrive::Coast, 8.0);
        let (amperes, speed) = (current(&robot, B), velocity(&robot, B));
        let useful = amperes * nxt("electric_constant") * speed;
        let taken = 8.0 * robot.supply_current();
        assert!(
            taken > useful && useful > 0.0,
            "{taken} W taken, {useful} W used"
        );
    }
}

#[test]
fn an_inductance_gives_back_in_the_off_phase_what_it_stores() {
    for (inductance, sign) in [(0.0, 1.0), (0.0, -1.0), (5e-3, 1.0), (5e-3, -1.0)] {
        let mut robot = bench(&TABLE_1, &format!(r#", "inductance": {inductance}"#));
        robot.motor_mut(B).unwrap().set_load_torque(sign * 0.1);
        run(&mut robot, 2.0, fast(sign * 0.6), MotorDrive::Coast, 8.0);
        let (amperes, speed) = (current(&robot, B), velocity(&robot, B));
        let volts = nxt("resistance") * amperes + nxt("electric_constant") * speed;
        let drawn = if inductance == 0.0 {
            amperes.abs()
        } else {
            amperes * volts / 8.0
        };
        near(robot.supply_current(), drawn, 1e-6);
    }
}

#[test]
fn a_shaft_turned_faster_than_the_bridge_drives_it_gives_current_back() {
    for sign in [1.0, -1.0] {
        for drive in [slow(sign * 0.2), fast(sign * 0.2)] {
            let mut robot = held(&TABLE_1);
            let shaft = robot.motor_mut(B).unwrap();
            shaft.set_hand_angle(sign * 100.0);
            run(&mut robot, 0.1, drive, MotorDrive::Coast, 4.0);
            let emf = nxt("electric_constant") * 4.0;
            assert!(emf > 0.2 * 4.0, "{emf} V");
            let gives = matches!(
                drive,
                MotorDrive::Pwm {
                    decay: plant::Decay::Slow,
                    ..
                }
            );
            assert_eq!(robot.supply_current() < 0.0, gives, "{drive:?}");
            near(velocity(&robot, B), sign * 4.0, 1e-9);
        }
    }
}
