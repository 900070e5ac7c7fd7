// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Quadrature edges at exact cycles, order of events, determinism.

use crate::common::catalogue::nxt;
use crate::common::{milliseconds, motor, three_motors, Rig};
use at91sam7s::board::Board;
use nxt::BoardEventKind;

/// (tacho, direction) of the motors A to C.
const PINS: [(u32, u32); 3] = [(15, 1), (26, 9), (0, 8)];
const BOARD: &str = r#"{"battery": {"kind": "aa", "voltage": 9.0}}"#;

/// What a program counts: tacho edges with the sign of tacho xor direction.
#[derive(Default)]
struct Counter {
    last: Option<u32>,
    counts: [i64; 3],
    edges_at: [Vec<u64>; 3],
}

impl Counter {
    fn look(&mut self, at: u64, level: u32) {
        let changed = self.last.map_or(0, |last| last ^ level);
        self.last = Some(level);
        for (motor, (tacho, direction)) in PINS.into_iter().enumerate() {
            if changed >> tacho & 1 != 0 {
                let forwards = (level >> tacho ^ level >> direction) & 1 != 0;
                self.counts[motor] += if forwards { 1 } else { -1 };
                self.edges_at[motor].push(at);
            }
        }
    }

    fn follow(&mut self, rig: &mut Rig, until: u64) {
        while rig.board.next_event() <= until {
            let at = rig.board.next_event();
            rig.board.advance(at);
            self.look(at, rig.board.pin_levels().level);
        }
        rig.now = until;
    }
}

fn degrees(rig: &Rig, letter: &str) -> f64 {
    rig.signal(&format!("motor.{letter}.angle")).to_degrees()
}

/// A motor of twice the speed, so that 2,000 degrees per second are reached.
fn fast_motors() -> String {
    let constants = [nxt("electric_constant"), nxt("torque_constant")];
    let motor = constants.iter().fold(motor(), |text, constant| {
        text.replace(&constant.to_string(), "0.2")
    });
    format!(r#"{{"motors": {{"A": {motor}, "B": {motor}, "C": {motor}}}}}"#)
}

#[test]
fn counted_edges_equal_the_angle_within_one_at_2000_degrees_per_second() {
    for seed in 0..5 {
        let mut rig = Rig::new(BOARD, &fast_motors(), seed);
        rig.board.skip_coprocessor_start_up(0);
        let mut counter = Counter::default();
        counter.look(0, rig.board.pin_levels().level);
        for (duties, time) in [
            ([100, -100, 90], 800),
            ([-100, 40, -3], 900),
            ([0, 7, 0], 500),
        ] {
            rig.drive(duties, 0b111);
            let until = rig.now + milliseconds(time);
            counter.follow(&mut rig, until);
            if duties[0] == 100 {
                let speed = rig.signal("motor.A.angular_velocity").to_degrees();
                assert!(speed > 2_000.0, "{speed}");
            }
            for (motor, letter) in ["A", "B", "C"].into_iter().enumerate() {
                let count = counter.counts[motor];
                let error = count as f64 - degrees(&rig, letter);
                assert!(error.abs() <= 1.0, "motor {letter}: {error}");
                assert_eq!(count as f64, rig.signal(&format!("motor.{letter}.encoder")));
            }
        }
    }
}

#[test]
fn forwards_the_pair_goes_through_its_four_states() {
    let mut rig = Rig::running(BOARD, &three_motors());
    rig.drive([50, 50, 50], 0b111);
    for (tacho, direction) in PINS {
        let mut states = Vec::new();
        let mut rig = rig.clone();
        let until = rig.now + milliseconds(300);
        while rig.board.next_event() <= until {
            let at = rig.board.next_event();
            rig.board.advance(at);
            let level = rig.board.pin_levels().level;
            states.push((level >> tacho & 1, level >> direction & 1));
        }
        states.dedup();
        let cycle = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let first = cycle.iter().position(|state| *state == states[0]).unwrap();
        assert!(states.len() > 100);
        for (index, state) in states.iter().enumerate() {
            assert_eq!(*state, cycle[(first + index) % 4]);
        }
    }
}

#[test]
fn edges_at_steady_speed_are_evenly_spaced_to_the_cycle() {
    let mut rig = Rig::running(BOARD, &three_motors());
    rig.drive([70, 100, -85], 0b111);
    rig.run(milliseconds(1_500));
    let mut counter = Counter::default();
    counter.look(rig.now, rig.board.pin_levels().level);
    let until = rig.now + milliseconds(200);
    counter.follow(&mut rig, until);
    for (edges, letter) in counter.edges_at.iter().zip(["A", "B", "C"]) {
        let speed = rig.signal(&format!("motor.{letter}.angular_velocity"));
        let period = 1.0_f64.to_radians() / speed.abs() * (336_384_000.0 / 7.0);
        assert!(edges.len() > 100);
        for pair in edges.windows(2) {
            let length = (pair[1] - pair[0]) as f64;
            assert!((length - period).abs() < 2.0, "{letter} {pair:?} {period}");
        }
    }
}

#[test]
fn an_unplugged_motor_leaves_its_pins_undriven() {
    let rig = Rig::running(BOARD, &format!(r#"{{"motors": {{"B": {}}}}}"#, motor()));
    let driven = rig.board.pin_levels().driven;
    assert_eq!(driven >> 26 & 1, 1);
    assert_eq!(driven >> 9 & 1, 1);
    for pin in [15, 1, 0, 8] {
        assert_eq!(driven >> pin & 1, 0, "PA{pin}");
    }
}

#[test]
fn bus_and_port_lines_are_pulled_up_and_pins_without_device_are_left_alone() {
    let rig = Rig::running(BOARD, "{}");
    let pins = rig.board.pin_levels();
    for pin in [3, 4, 2, 18, 19, 20, 23, 28, 29, 30] {
        assert_eq!(
            (pins.driven >> pin & 1, pins.level >> pin & 1),
            (1, 1),
            "PA{pin}"
        );
    }
    for pin in [5, 6, 7, 10, 11, 12, 16, 17, 22, 24, 27, 31] {
        assert_eq!(pins.driven >> pin & 1, 0, "PA{pin}");
    }
}

#[test]
fn next_event_never_goes_back_and_events_come_in_the_order_of_time() {
    let mut rig = Rig::running(BOARD, &three_motors());
    rig.drive([40, -60, 80], 0b111);
    let mut last = 0;
    for _ in 0..20_000 {
        let next = rig.board.next_event();
        assert!(next > last, "{next} after {last}");
        rig.board.advance(next);
        last = next;
    }
    let events = rig.reports();
    assert!(events
        .windows(2)
        .all(|pair| pair[0].at_cycles <= pair[1].at_cycles));
    let commands = events.iter().filter_map(|event| match event.kind {
        BoardEventKind::MotorCommand { motor, .. } => Some(motor.letter()),
        _ => None,
    });
    assert_eq!(commands.collect::<Vec<_>>(), ["A", "B", "C"]);
}

#[test]
fn one_late_call_brings_the_same_state_as_many_timely_ones() {
    let mut timely = Rig::running(BOARD, &three_motors());
    timely.drive([40, -60, 80], 0b111);
    let mut late = timely.clone();
    timely.run(milliseconds(100));
    late.board.advance(timely.now);
    late.now = timely.now;
    assert_eq!(
        timely.board.signals(timely.now),
        late.board.signals(late.now)
    );
    assert_eq!(timely.board.pin_levels(), late.board.pin_levels());
    assert_eq!(timely.reports(), late.reports());
}

#[test]
fn equal_seeds_give_equal_runs_and_other_seeds_other_phases() {
    let run = |seed| {
        let mut rig = Rig::new(BOARD, &three_motors(), seed);
        rig.board.skip_coprocessor_start_up(0);
        rig.drive([50, 60, 70], 0b111);
        let mut counter = Counter::default();
        counter.look(rig.now, rig.board.pin_levels().level);
        let until = rig.now + milliseconds(200);
        counter.follow(&mut rig, until);
        (counter.edges_at, rig.board.signals(rig.now))
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7).0, run(8).0);
}

#[test]
fn a_clone_goes_on_exactly_as_the_original() {
    let mut one = Rig::running(BOARD, &three_motors());
    one.drive([50, 60, 70], 0b111);
    one.run(milliseconds(37));
    let mut two = one.clone();
    one.run(milliseconds(50));
    two.run(milliseconds(50));
    assert_eq!(one.board.signals(one.now), two.board.signals(two.now));
    assert_eq!(one.board.pin_levels(), two.board.pin_levels());
}

#[test]
fn signals_have_the_names_of_what_is_plugged_in() {
    let plain = motor();
    let motor = plain.replace(r#""inertia""#, r#""backlash": 0.05, "inertia""#);
    let body = r#"{"kind": "differential_drive", "left": "B", "right": "C",
        "wheel_radius": 0.028, "track": 0.115, "mass": 0.6, "yaw_inertia": 0.003,
        "castor_friction": 0.05, "rolling_resistance": 0.05}"#;
    let robot = format!(r#"{{"motors": {{"B": {plain}, "C": {motor}}}, "body": {body}}}"#);
    let mut rig = Rig::running(BOARD, &robot);
    let per_motor = [
        "angle",
        "angular_velocity",
        "voltage",
        "current",
        "encoder",
        "duty",
    ];
    let mut wanted: Vec<_> = per_motor.map(|name| format!("motor.B.{name}")).to_vec();
    wanted.extend(per_motor.map(|name| format!("motor.C.{name}")));
    wanted.push("motor.C.load_angle".to_owned());
    wanted.extend(["body.x", "body.y", "body.heading", "battery.voltage"].map(str::to_owned));
    assert_eq!(rig.board.signal_names(), wanted);
    rig.drive([0, 50, 50], 0b110);
    rig.run(milliseconds(500));
    assert_eq!(rig.board.signals(rig.now).len(), wanted.len());
    assert!(rig.signal("body.x") > 0.05);
}
