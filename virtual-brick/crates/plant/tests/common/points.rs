// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Published measurements of real NXT motors, and how each is repeated on the plant.
//!
//! Philo: P. Hurbain, pages on LEGO motors and on the NXT motor (2006), and the data file of the
//! Pybricks firmware (2026), which quotes his table. Students: a project at Ryerson University,
//! one motor on 8.16 V under three loads. Muntoo: sweep of the power in air under NXC (2011).

use plant::{MotorDrive, MotorPort, Robot};

use super::catalogue::{motor_members, FITTED_MOTOR};
use super::{bench, current, fast, slow, velocity, DT, SET_A};

const B: MotorPort = MotorPort::B;
const RPM: f64 = std::f64::consts::PI / 30.0;
const DEGREES: f64 = std::f64::consts::PI / 180.0;

/// Of NXTway-GS (Watanabe's fit of Philo's curves), with an inertia for a motor alone.
const SET_B: &str = r#"{"resistance": 6.69, "torque_constant": 0.317,
    "electric_constant": 0.468, "viscous_friction": 0.0022, "inertia": 0.00132}"#;
/// Of the Pybricks firmware (motor_data.py, 2026): fitted to Philo's points.
const SET_C: &str = r#"{"resistance": 5.516, "torque_constant": 0.3408,
    "electric_constant": 0.4870, "viscous_friction": 0, "coulomb_friction": 0.0204,
    "inertia": 0.00307, "inductance": 0.015}"#;

/// Friction and bridge of the catalogue's `nxt_fitted`.
const FRICTION: [&str; 5] = [
    "viscous_friction",
    "coulomb_friction",
    "static_friction",
    "stribeck_velocity",
    "gear_friction",
];
const BRIDGE: [&str; 2] = ["driver_drop", "driver_resistance"];

/// A constant drop and a static friction chosen so that a loaded motor stalls at as much duty
/// cycle as Philo saw.
const CONSTANT_DROP: &str = r#", "static_friction": 0.04, "driver_drop": 0.6"#;

/// Parameters of a motor, at its terminals and behind a brick's bridge.
pub struct Set {
    pub name: &'static str,
    /// Has the fitted friction and the bridge.
    pub rich: bool,
    terminals: String,
    brick: String,
}

impl Set {
    fn published(name: &'static str, parameters: String) -> Self {
        Self {
            name,
            rich: false,
            brick: parameters.clone(),
            terminals: parameters,
        }
    }

    /// Winding and inertia as in the set, friction and bridge of the richer model.
    fn rich(name: &'static str, parameters: &str) -> Self {
        let motor = super::motor(parameters);
        let winding = format!(
            r#"{{"resistance": {}, "torque_constant": {}, "electric_constant": {}, "inertia": {}"#,
            motor.resistance, motor.torque_constant, motor.electric_constant, motor.inertia
        );
        let friction = motor_members("nxt_fitted", &FRICTION);
        let bridge = motor_members("nxt_fitted", &BRIDGE);
        let terminals = format!(
            r#"{winding}, "inductance": {}, {friction}"#,
            motor.inductance
        );
        Self {
            name,
            rich: true,
            brick: format!("{terminals}, {bridge}}}"),
            terminals: format!("{terminals}}}"),
        }
    }

    /// The value of a point, measured where its publication did.
    pub fn value(&self, point: &Point) -> f64 {
        (point.measure)(if point.behind_bridge {
            &self.brick
        } else {
            &self.terminals
        })
    }
}

/// All sets: with the richer friction and bridge, then as they are published.
pub fn sets() -> [Set; 8] {
    let dropping = format!("{}{CONSTANT_DROP}}}", SET_A.trim_end_matches('}'));
    [
        Set::rich("A", SET_A),
        Set::rich("B", SET_B),
        Set::rich("C", SET_C),
        Set::rich("fitted", &FITTED_MOTOR),
        Set::published("A, published", SET_A.to_owned()),
        Set::published("B, published", SET_B.to_owned()),
        Set::published("C, published", SET_C.to_owned()),
        Set::published("A, constant drop", dropping),
    ]
}

/// What a value must be, where the publications agree well enough to say so.
#[derive(Clone, Copy, Debug)]
pub enum Band {
    /// This share of the published value about it.
    Share(f64),
    /// From the first to the second.
    Range(f64, f64),
    /// Stated for comparison only.
    Open,
}

/// A measurement.
pub struct Point {
    /// Supply and load.
    pub condition: &'static str,
    /// What was measured, with its unit.
    pub quantity: &'static str,
    /// As published, or the middle of what was.
    pub published: f64,
    /// What passes.
    pub band: Band,
    /// Who measured it.
    pub source: &'static str,
    /// Measured on a motor at a brick, not at one whose terminals have the voltage.
    pub behind_bridge: bool,
    /// The same on a bench with a motor of these parameters.
    pub measure: fn(&str) -> f64,
}

impl Point {
    /// Lowest and highest value that pass.
    pub fn limits(&self) -> Option<(f64, f64)> {
        match self.band {
            Band::Share(share) => Some((
                self.published * (1.0 - share),
                self.published * (1.0 + share),
            )),
            Band::Range(low, high) => Some((low, high)),
            Band::Open => None,
        }
    }

    /// Whether a value passes; none without a band.
    pub fn passes(&self, value: f64) -> Option<bool> {
        self.limits()
            .map(|(low, high)| (low..=high).contains(&value))
    }
}

const PHILO: &str = "Philo";
const QUOTED: &str = "Philo, quoted by Pybricks";
const STUDENTS: &str = "students";

/// Every point that is a matter of the motor and its bridge.
pub const POINTS: &[Point] = &[
    Point {
        condition: "9 V, no load",
        quantity: "speed, rpm",
        published: 170.0,
        band: Band::Share(0.03),
        source: PHILO,
        behind_bridge: false,
        measure: |set| steady(set, 9.0, 0.0).0 / RPM,
    },
    Point {
        condition: "9 V, no load",
        quantity: "current, A",
        published: 0.06,
        band: Band::Open,
        source: PHILO,
        behind_bridge: false,
        measure: |set| steady(set, 9.0, 0.0).1,
    },
    Point {
        condition: "9 V, 0.167 N m",
        quantity: "speed, rpm",
        published: 117.0,
        band: Band::Share(0.05),
        source: QUOTED,
        behind_bridge: false,
        measure: |set| steady(set, 9.0, 0.167).0 / RPM,
    },
    Point {
        condition: "9 V, 0.167 N m",
        quantity: "current, A",
        published: 0.55,
        band: Band::Share(0.05),
        source: QUOTED,
        behind_bridge: false,
        measure: |set| steady(set, 9.0, 0.167).1,
    },
    Point {
        condition: "9 V, stalled",
        quantity: "torque, N m",
        published: 0.5,
        band: Band::Open,
        source: PHILO,
        behind_bridge: false,
        measure: |set| stall_torque(set, 9.0),
    },
    Point {
        condition: "9 V, stalled",
        quantity: "current, A",
        published: 2.0,
        band: Band::Open,
        source: PHILO,
        behind_bridge: false,
        measure: |set| steady(set, 9.0, stall_torque(set, 9.0)).1,
    },
    Point {
        condition: "9 V, 0.115 N m, brake mode",
        quantity: "turns from duty cycle, %",
        published: 40.0,
        band: Band::Range(30.0, 45.0),
        source: PHILO,
        behind_bridge: true,
        measure: |set| first_turning_percent(set, 9.0, 0.115, false),
    },
    Point {
        condition: "9 V, 0.115 N m, float mode",
        quantity: "turns from duty cycle, %",
        published: 40.0,
        band: Band::Open,
        source: PHILO,
        behind_bridge: true,
        measure: |set| first_turning_percent(&with_inductance(set), 9.0, 0.115, true),
    },
    Point {
        condition: "8.16 V, no load",
        quantity: "speed, degree/s",
        published: 900.0,
        band: Band::Share(0.10),
        source: STUDENTS,
        behind_bridge: false,
        measure: |set| steady(set, 8.16, 0.0).0 / DEGREES,
    },
    Point {
        condition: "8.16 V, 0.080 N m",
        quantity: "speed, degree/s",
        published: 850.0,
        band: Band::Share(0.10),
        source: STUDENTS,
        behind_bridge: false,
        measure: |set| steady(set, 8.16, 0.080).0 / DEGREES,
    },
    Point {
        condition: "8.16 V, 0.201 N m",
        quantity: "speed, degree/s",
        published: 525.0,
        band: Band::Share(0.10),
        source: STUDENTS,
        behind_bridge: false,
        measure: |set| steady(set, 8.16, 0.201).0 / DEGREES,
    },
    Point {
        condition: "8.16 V, 0.402 N m",
        quantity: "speed, degree/s",
        published: 50.0,
        band: Band::Open,
        source: STUDENTS,
        behind_bridge: false,
        measure: |set| steady(set, 8.16, 0.402).0 / DEGREES,
    },
    Point {
        condition: "8.16 V, stalled",
        quantity: "torque, N m",
        published: 0.43,
        band: Band::Open,
        source: STUDENTS,
        behind_bridge: false,
        measure: |set| stall_torque(set, 8.16),
    },
    Point {
        condition: "9 V, step, no load",
        quantity: "time constant, ms",
        published: 64.0,
        band: Band::Range(42.5, 105.0),
        source: "students; range: published inertias",
        behind_bridge: false,
        measure: |set| 1e3 * time_constant(set),
    },
    Point {
        condition: "8 V, no load, 20 % to 80 %",
        quantity: "speed for a duty cycle, degree/s/%",
        published: 7.0,
        band: Band::Open,
        source: "Muntoo",
        behind_bridge: true,
        measure: sweep_slope,
    },
    Point {
        condition: "8 V, no load, brake mode",
        quantity: "turns from duty cycle, %",
        published: 5.0,
        band: Band::Open,
        source: "Muntoo",
        behind_bridge: true,
        measure: |set| first_turning_percent(set, 8.0, 0.0, false),
    },
];

/// Highest duty cycle in % at which a motor of these parameters can stall with 0.115 N m on 9 V
/// when it turns without load at 5 % of 8 V: friction at rest and bridge take 0.4 V at most.
pub fn stall_percent_at_most(set: &str) -> f64 {
    let motor = super::motor(set);
    let volts = 0.05 * 8.0 + motor.resistance / motor.torque_constant * 0.115;
    100.0 * volts / 9.0
}

/// A point that a set does not meet, and why.
pub struct Miss {
    pub set: &'static str,
    pub condition: &'static str,
    pub quantity: &'static str,
    pub reason: &'static str,
}

const STALL: &str = "9 V, 0.115 N m, brake mode";
const LIGHT: &str = "8.16 V, 0.080 N m";
const LINEAR: &str = "linear but for Coulomb friction: nothing holds the motor back at so much \
    voltage";
const UNEVEN: &str = "the students' motor lost 50 degree/s to the first 0.080 N m and 325 to the \
    next 0.121, a motor with constant friction loses evenly";
const FIT: &str = "fitted without Coulomb friction and with four times the viscous one";
const TERMINALS: &str = "measured at the motor's terminals, not behind the brick's bridge";
const WITHOUT_LOSS: &str =
    "without any friction, the set's motor would give 793 degree/s and with \
    the friction of the no-load current 763";
const WINDING: &str =
    "the winding of this set, fitted to other points on 8.5 V, takes more voltage";

const fn miss(
    set: &'static str,
    condition: &'static str,
    quantity: &'static str,
    reason: &'static str,
) -> Miss {
    Miss {
        set,
        condition,
        quantity,
        reason,
    }
}

/// In the order of sets and points.
pub const MISSED: [Miss; 15] = [
    miss("A", LIGHT, "speed, degree/s", WITHOUT_LOSS),
    miss("B", "9 V, 0.167 N m", "speed, rpm", WINDING),
    miss("B", LIGHT, "speed, degree/s", WINDING),
    miss("B", "8.16 V, 0.201 N m", "speed, degree/s", WINDING),
    miss("A, published", STALL, "turns from duty cycle, %", LINEAR),
    miss("A, published", LIGHT, "speed, degree/s", UNEVEN),
    miss("B, published", "9 V, 0.167 N m", "speed, rpm", FIT),
    miss("B, published", "9 V, 0.167 N m", "current, A", FIT),
    miss("B, published", STALL, "turns from duty cycle, %", LINEAR),
    miss("B, published", LIGHT, "speed, degree/s", FIT),
    miss("B, published", "8.16 V, 0.201 N m", "speed, degree/s", FIT),
    miss("C, published", STALL, "turns from duty cycle, %", LINEAR),
    miss("A, constant drop", "9 V, no load", "speed, rpm", TERMINALS),
    miss(
        "A, constant drop",
        "9 V, 0.167 N m",
        "speed, rpm",
        TERMINALS,
    ),
    miss("A, constant drop", LIGHT, "speed, degree/s", UNEVEN),
];

fn turned(set: &str, seconds: f64, drive: MotorDrive, supply: f64, load: f64) -> Robot {
    let mut robot = bench(set, "");
    if let Some(motor) = robot.motor_mut(B) {
        motor.set_load_torque(load);
    }
    super::run(&mut robot, seconds, drive, MotorDrive::Coast, supply);
    robot
}

/// Speed in rad/s and current in A after two seconds at full duty cycle.
pub fn steady(set: &str, supply: f64, load: f64) -> (f64, f64) {
    let robot = turned(set, 2.0, slow(1.0), supply, load);
    (velocity(&robot, B), current(&robot, B))
}

/// Largest load in N m that the motor lifts from rest.
fn stall_torque(set: &str, supply: f64) -> f64 {
    let (mut lifts, mut stalls) = (0.0, 1.0);
    for _ in 0..12 {
        let load = (lifts + stalls) / 2.0;
        let robot = turned(set, 0.3, slow(1.0), supply, load);
        if velocity(&robot, B) > 0.0 {
            lifts = load;
        } else {
            stalls = load;
        }
    }
    lifts
}

/// Lowest duty cycle in % at which the motor turns forwards against the load.
fn first_turning_percent(set: &str, supply: f64, load: f64, floating: bool) -> f64 {
    let turns = |percent: u32| {
        let duty = f64::from(percent) / 100.0;
        let drive = if floating { fast(duty) } else { slow(duty) };
        velocity(&turned(set, 0.3, drive, supply, load), B) > 0.1
    };
    let (mut stands, mut moves) = (0, 100);
    while moves - stands > 1 {
        let middle = (stands + moves) / 2;
        if turns(middle) {
            moves = middle;
        } else {
            stands = middle;
        }
    }
    f64::from(moves)
}

/// Fast decay needs the winding's inductance; 4.7 mH (set A) where a set has none.
fn with_inductance(set: &str) -> String {
    if super::motor(set).inductance > 0.0 {
        return set.to_owned();
    }
    let set = set.replace("\"inductance\": 0,", "");
    format!("{}, \"inductance\": 0.0047}}", set.trim_end_matches('}'))
}

/// Time in s from a step to 9 V until 1 - 1/e of the final speed.
fn time_constant(set: &str) -> f64 {
    let full = steady(set, 9.0, 0.0).0;
    let mut robot = bench(set, "");
    let mut time = 0.0;
    while velocity(&robot, B) < full * (1.0 - (-1.0_f64).exp()) {
        robot.step(DT, &[MotorDrive::Coast, slow(1.0), MotorDrive::Coast], 9.0);
        time += DT;
    }
    time
}

fn sweep_slope(set: &str) -> f64 {
    let speed = |duty| velocity(&turned(set, 1.0, slow(duty), 8.0, 0.0), B) / DEGREES;
    (speed(0.8) - speed(0.2)) / 60.0
}
