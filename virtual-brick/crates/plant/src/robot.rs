// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Motors and body together, advanced step by step.

use crate::balancer::Pendulum;
use crate::body::{Pose, Vehicle};
use crate::drive::{MotorDrive, StepCurrent, Winding};
use crate::error::ParameterError;
use crate::motor::Motor;
use crate::parameters::{BodyParameters, MotorPort, RobotParameters};
use crate::solver::{solve, Constraint, Coupling, MassMatrix, Vector, COORDINATES, PITCH};

const MOTORS: usize = 3;
/// Angular velocity in rad/s below which a shaft held by friction is at rest.
const AT_REST: f64 = 1e-6;
/// Frictions of three motors, two stops each, and two of the body: rolling and castor, or the
/// floor on both sides.
const CONSTRAINTS: usize = 11;

/// Three motor ports and a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    motors: [Option<Motor>; MOTORS],
    body: Body,
}

/// What the motors turn, with its state.
#[derive(Clone, Debug, PartialEq)]
enum Body {
    Bench,
    Vehicle(Vehicle),
    Pendulum(Pendulum),
}

/// What one step has found out before the impulses.
struct Step {
    dt: f64,
    laws: [StepCurrent; MOTORS],
    inverse: MassMatrix,
    before: Vector,
    free: Vector,
}

impl Robot {
    /// A robot at rest at the origin.
    ///
    /// # Errors
    /// The first parameter that is not accepted.
    pub fn new(parameters: &RobotParameters) -> Result<Self, ParameterError> {
        parameters.check()?;
        let motors = MotorPort::ALL.map(|port| parameters.motors.get(port).map(Motor::new));
        let load = |port: MotorPort| load_coordinate(&motors, port.index());
        let body = match &parameters.body {
            BodyParameters::Bench {} => Body::Bench,
            BodyParameters::DifferentialDrive(drive) => {
                let (left, right) = (load(drive.left), load(drive.right));
                Body::Vehicle(Vehicle::new(drive.clone(), left, right))
            }
            BodyParameters::Balancer(balancer) => {
                let (left, right) = (load(balancer.left), load(balancer.right));
                Body::Pendulum(Pendulum::new(balancer.clone(), left, right))
            }
        };
        Ok(Self { motors, body })
    }

    /// The motor in `port`.
    #[must_use]
    pub const fn motor(&self, port: MotorPort) -> Option<&Motor> {
        self.motors[port.index()].as_ref()
    }

    /// The motor in `port`, to set its load or the hand that holds it.
    pub fn motor_mut(&mut self, port: MotorPort) -> Option<&mut Motor> {
        self.motors[port.index()].as_mut()
    }

    /// Where the vehicle is; nothing on a bench.
    #[must_use]
    pub const fn pose(&self) -> Option<Pose> {
        match &self.body {
            Body::Bench => None,
            Body::Vehicle(vehicle) => Some(vehicle.pose),
            Body::Pendulum(pendulum) => Some(pendulum.pose),
        }
    }

    /// Pitch in rad, forwards, and its rate in rad/s of a body that balances.
    #[must_use]
    pub const fn pitch(&self) -> Option<(f64, f64)> {
        match &self.body {
            Body::Pendulum(pendulum) => Some((pendulum.pitch, pendulum.pitch_rate)),
            _ => None,
        }
    }

    /// Angular velocity about the vertical in rad/s; 0 on a bench.
    #[must_use]
    pub fn yaw_rate(&self) -> f64 {
        let Some((left, right, radius, track)) = self.wheels() else {
            return 0.0;
        };
        let speed = |port| self.motor(port).map_or(0.0, Motor::load_velocity);
        radius * (speed(right) - speed(left)) / track
    }

    /// A hand takes hold of a body that balances, where it is, or lets it go.
    pub fn set_held(&mut self, held: bool) {
        if let Body::Pendulum(pendulum) = &mut self.body {
            pendulum.held = held;
        }
    }

    /// Pushes a body that balances forwards at its centre of mass with this force in N.
    pub fn set_push(&mut self, push: f64) {
        if let Body::Pendulum(pendulum) = &mut self.body {
            pendulum.push = push;
        }
    }

    /// Becomes as another robot with the same parameters is.
    pub fn take_state(&mut self, other: &Self) {
        for (motor, other) in self.motors.iter_mut().zip(&other.motors) {
            if let (Some(motor), Some(other)) = (motor, other) {
                motor.take_state(other);
            }
        }
        match (&mut self.body, &other.body) {
            (Body::Vehicle(vehicle), Body::Vehicle(other)) => vehicle.pose = other.pose,
            (body, other) => body.clone_from(other),
        }
    }

    /// Motion, currents and heat are the same, bit for bit; asked of two states of one robot.
    #[must_use]
    pub fn same_state(&self, other: &Self) -> bool {
        let motors = self
            .motors
            .iter()
            .flatten()
            .zip(other.motors.iter().flatten());
        let same = |(one, other): (&Motor, &Motor)| same_bits(&one.state(), &other.state());
        let body = |robot: &Self| {
            let (pose, pitch) = (robot.pose().unwrap_or_default(), robot.pitch());
            let (angle, rate) = pitch.unwrap_or_default();
            [pose.x, pose.y, pose.heading, angle, rate]
        };
        motors.into_iter().all(same) && same_bits(&body(self), &body(other))
    }

    /// Current that all motors take from the supply in A, mean of the last step.
    #[must_use]
    pub fn supply_current(&self) -> f64 {
        self.motors
            .iter()
            .flatten()
            .map(Motor::supply_current)
            .sum()
    }

    /// Kinetic energy of motors and body in J.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let velocity = self.velocities();
        let momentum = self.masses().multiply(&velocity);
        (0..COORDINATES)
            .map(|index| momentum[index] * velocity[index])
            .sum::<f64>()
            / 2.0
    }

    /// Advances by `dt` s with the bridges in the given states at `supply` V.
    pub fn step(&mut self, dt: f64, drives: &[MotorDrive; MOTORS], supply: f64) {
        let windings: [Option<Winding>; MOTORS] = [0, 1, 2].map(|k| {
            self.motors[k]
                .as_ref()
                .map(|motor| motor.winding(supply, dt))
        });
        let drives = &[0, 1, 2].map(|k| {
            self.motors[k]
                .as_ref()
                .map_or(drives[k], |motor| motor.effective(drives[k]))
        });
        let step = self.prepare(dt, drives, supply);
        let velocity = self.constrained(&step);
        let wheels = self.wheel_angles();
        for (k, motor) in self.motors.iter_mut().enumerate() {
            let (Some(motor), Some(winding)) = (motor, windings[k]) else {
                continue;
            };
            if !motor.follow_hand(dt) {
                motor.finish_step(velocity[k], velocity[MOTORS + k], dt);
            }
            motor.finish_current(drives[k], step.laws[k], winding);
        }
        self.roll(wheels, velocity[PITCH], dt);
    }

    fn masses(&self) -> MassMatrix {
        let mut diagonal = [1.0; COORDINATES];
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(motor) = motor.as_ref().filter(|motor| !motor.held_by_hand()) {
                let (before, behind) = motor.inertias();
                diagonal[k] = before;
                diagonal[MOTORS + k] = if behind > 0.0 { behind } else { 1.0 };
            }
        }
        let mut masses = MassMatrix {
            diagonal,
            coupling: Coupling::None,
        };
        match &self.body {
            Body::Bench => {}
            Body::Vehicle(vehicle) => {
                let (own, coupling) = vehicle.wheel_inertia();
                masses.diagonal[vehicle.left] += own;
                masses.diagonal[vehicle.right] += own;
                masses.coupling = Coupling::Pair(vehicle.left, vehicle.right, coupling);
            }
            Body::Pendulum(pendulum) => pendulum.add_masses(&mut masses),
        }
        masses
    }

    /// Velocities of the coordinates; 0 where there is nothing or a hand decides.
    fn velocities(&self) -> Vector {
        let mut velocity = [0.0; COORDINATES];
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(motor) = motor.as_ref().filter(|motor| !motor.held_by_hand()) {
                velocity[k] = motor.angular_velocity();
                if motor.has_backlash() {
                    velocity[MOTORS + k] = motor.load_velocity();
                }
            }
        }
        if let Body::Pendulum(pendulum) = &self.body {
            velocity[PITCH] = pendulum.pitch_rate;
        }
        velocity
    }

    /// Linear part of the step: M (w1 - w0) = dt (Kt i - b (w0 + w1) / 2 - load).
    fn prepare(&self, dt: f64, drives: &[MotorDrive; MOTORS], supply: f64) -> Step {
        let mut mass = self.masses();
        let before = self.velocities();
        let mut right = mass.multiply(&before);
        let mut laws = [StepCurrent::default(); MOTORS];
        for (k, motor) in self.motors.iter().enumerate() {
            let Some(motor) = motor else {
                continue;
            };
            let parameters = motor.parameters();
            laws[k] = drives[k].step_current(parameters, motor.winding(supply, dt));
            if motor.held_by_hand() {
                continue;
            }
            let torque = parameters.torque_constant;
            let viscous = parameters.viscous_friction / 2.0;
            mass.diagonal[k] += dt * (viscous + torque * laws[k].slope);
            right[k] += dt * (torque * laws[k].offset - viscous * before[k]);
            right[load_coordinate(&self.motors, k)] -= dt * motor.load_torque();
        }
        if let Body::Pendulum(pendulum) = &self.body {
            pendulum.add_impulses(&before, dt, &mut right);
        }
        let inverse = mass.inverse();
        let free = inverse.multiply(&right);
        Step {
            dt,
            laws,
            inverse,
            before,
            free,
        }
    }

    fn constrained(&self, step: &Step) -> Vector {
        let mut velocity = step.free;
        let mut constraints = [const { None }; CONSTRAINTS];
        let mut frictions = [None; MOTORS];
        let mut count = 0;
        let mut add = |constraint| {
            constraints[count] = Some(constraint);
            count += 1;
            count - 1
        };
        for (k, friction) in frictions.iter_mut().enumerate() {
            *friction = self.motor_friction(k, step).map(&mut add);
            for stop in self.stops(k, step).into_iter().flatten() {
                add(stop);
            }
        }
        for friction in self.floor_frictions(step).into_iter().flatten() {
            add(friction);
        }
        for stop in self.pitch_stops(step).into_iter().flatten() {
            add(stop);
        }
        solve(&mut velocity, &mut constraints[..count]);
        for (k, friction) in frictions.into_iter().enumerate() {
            let constraint = friction.and_then(|index: usize| constraints[index].as_ref());
            let held = constraint.is_some_and(Constraint::holds);
            if held && libm::fabs(velocity[k]) < AT_REST {
                velocity[k] = 0.0;
            }
        }
        if matches!(&self.body, Body::Pendulum(pendulum) if pendulum.held) {
            velocity[PITCH] = 0.0;
        }
        velocity
    }

    fn motor_friction(&self, k: usize, step: &Step) -> Option<Constraint> {
        let motor = self.motors[k]
            .as_ref()
            .filter(|motor| !motor.held_by_hand())?;
        let parameters = motor.parameters();
        let bound = if libm::fabs(step.before[k]) < AT_REST {
            parameters.breakaway_friction()
        } else {
            parameters.coulomb_friction
        };
        let direction = [(k, 1.0), (k, 0.0)];
        (bound > 0.0).then(|| Constraint::friction(&step.inverse, direction, bound * step.dt))
    }

    fn stops(&self, k: usize, step: &Step) -> [Option<Constraint>; 2] {
        let Some(motor) = self.motors[k].as_ref().filter(|motor| motor.has_backlash()) else {
            return [None, None];
        };
        let (lowest, highest) = motor.play_velocities(step.dt);
        let direction = [(k, 1.0), (MOTORS + k, -1.0)];
        let stop = |target, bounds| Some(Constraint::new(&step.inverse, direction, target, bounds));
        [
            stop(lowest, (0.0, f64::INFINITY)),
            stop(highest, (f64::NEG_INFINITY, 0.0)),
        ]
    }

    fn floor_frictions(&self, step: &Step) -> [Option<Constraint>; 2] {
        let Body::Vehicle(vehicle) = &self.body else {
            return [None, None];
        };
        let friction = |direction, force: f64| {
            (force > 0.0).then(|| Constraint::friction(&step.inverse, direction, force * step.dt))
        };
        let parameters = vehicle.parameters();
        let castor = vehicle.castor_direction(&step.before, &step.free);
        [
            friction(vehicle.rolling_direction(), parameters.rolling_resistance),
            friction(castor, parameters.castor_friction),
        ]
    }

    /// The floor under a body that falls, or the hand that holds it.
    fn pitch_stops(&self, step: &Step) -> [Option<Constraint>; 2] {
        let Body::Pendulum(pendulum) = &self.body else {
            return [None, None];
        };
        let stop = |target, bounds| {
            let direction = [(PITCH, 1.0), (PITCH, 0.0)];
            Some(Constraint::new(&step.inverse, direction, target, bounds))
        };
        if pendulum.held {
            return [stop(0.0, (f64::NEG_INFINITY, f64::INFINITY)), None];
        }
        let (lowest, highest) = pendulum.pitch_rates(step.dt);
        [
            stop(lowest, (0.0, f64::INFINITY)),
            stop(highest, (f64::NEG_INFINITY, 0.0)),
        ]
    }

    /// Ports of the left and the right wheel, their radius and distance.
    fn wheels(&self) -> Option<(MotorPort, MotorPort, f64, f64)> {
        match &self.body {
            Body::Bench => None,
            Body::Vehicle(vehicle) => {
                let drive = vehicle.parameters();
                Some((drive.left, drive.right, drive.wheel_radius, drive.track))
            }
            Body::Pendulum(pendulum) => {
                let body = pendulum.parameters();
                Some((body.left, body.right, body.wheel_radius, body.track))
            }
        }
    }

    /// Angles of the left and the right wheel against the body.
    fn wheel_angles(&self) -> Option<(f64, f64)> {
        let (left, right, ..) = self.wheels()?;
        let angle = |port| Some(self.motor(port)?.load_angle());
        Some((angle(left)?, angle(right)?))
    }

    fn roll(&mut self, before: Option<(f64, f64)>, pitch_rate: f64, dt: f64) {
        let (Some(before), Some(after)) = (before, self.wheel_angles()) else {
            return;
        };
        let (left, right) = (after.0 - before.0, after.1 - before.1);
        match &mut self.body {
            Body::Bench => {}
            Body::Vehicle(vehicle) => vehicle.roll(left, right),
            Body::Pendulum(pendulum) => {
                let turn = pendulum.finish_step(pitch_rate, dt);
                let body = pendulum.parameters();
                let (radius, track) = (body.wheel_radius, body.track);
                pendulum.pose.roll(radius, track, left + turn, right + turn);
            }
        }
    }
}

fn same_bits(one: &[f64], other: &[f64]) -> bool {
    let bits = |value: &f64| value.to_bits();
    one.iter().map(bits).eq(other.iter().map(bits))
}

/// Coordinate of what lies behind the play of motor `k`: its gear train's when it has none.
fn load_coordinate(motors: &[Option<Motor>; MOTORS], k: usize) -> usize {
    let behind = motors[k].as_ref().is_some_and(Motor::has_backlash);
    if behind {
        MOTORS + k
    } else {
        k
    }
}
