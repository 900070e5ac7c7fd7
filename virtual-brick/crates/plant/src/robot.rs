// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Motors and body together, as the rest of the brick sees them.

use crate::balancer::Pendulum;
use crate::body::Vehicle;
use crate::drive::MotorDrive;
use crate::error::ParameterError;
use crate::mechanism::{
    load_coordinate, Body, ImpulseResponses, Mechanism, CONSTRAINTS, GEAR_CONSTRAINTS,
};
use crate::motor::Motor;
use crate::motor_parameters::MotorPort;
use crate::parameters::{BodyParameters, RobotParameters};
use crate::pose::Pose;
use crate::solver::{COORDINATES, MOTORS};

/// Three motor ports and a body.
#[derive(Clone, Debug)]
pub struct Robot {
    mechanism: Mechanism,
    solver: Solver,
}

/// The coordinates that a step has, with what is known of the last one.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // one for a robot, and the common case stays in place
enum Solver {
    /// Without play and pitch: half the work.
    Gears(ImpulseResponses<MOTORS>),
    All(Box<ImpulseResponses<COORDINATES>>),
}

impl PartialEq for Robot {
    fn eq(&self, other: &Self) -> bool {
        self.mechanism == other.mechanism
    }
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
        Ok(Self::of(Mechanism { motors, body }))
    }

    fn of(mechanism: Mechanism) -> Self {
        let solver = if mechanism.is_gears_only() {
            Solver::Gears(ImpulseResponses::new(&mechanism))
        } else {
            Solver::All(Box::new(ImpulseResponses::new(&mechanism)))
        };
        Self { mechanism, solver }
    }

    /// The motor in `port`.
    #[must_use]
    pub const fn motor(&self, port: MotorPort) -> Option<&Motor> {
        self.mechanism.motors[port.index()].as_ref()
    }

    /// The motor in `port`, to set its load or the hand that holds it.
    pub fn motor_mut(&mut self, port: MotorPort) -> Option<&mut Motor> {
        self.mechanism.motors[port.index()].as_mut()
    }

    /// Where the vehicle is; nothing on a bench.
    #[must_use]
    pub const fn pose(&self) -> Option<Pose> {
        match &self.mechanism.body {
            Body::Bench => None,
            Body::Vehicle(vehicle) => Some(vehicle.pose),
            Body::Pendulum(pendulum) => Some(pendulum.pose),
        }
    }

    /// Pitch in rad, forwards, and its rate in rad/s of a body that balances.
    #[must_use]
    pub const fn pitch(&self) -> Option<(f64, f64)> {
        match &self.mechanism.body {
            Body::Pendulum(pendulum) => Some((pendulum.pitch, pendulum.pitch_rate)),
            _ => None,
        }
    }

    /// Angular velocity about the vertical in rad/s; 0 on a bench.
    #[must_use]
    pub fn yaw_rate(&self) -> f64 {
        let Some((left, right, radius, track)) = self.mechanism.wheels() else {
            return 0.0;
        };
        let speed = |port| self.motor(port).map_or(0.0, Motor::load_velocity);
        radius * (speed(right) - speed(left)) / track
    }

    /// A hand takes hold of a body that balances, where it is, or lets it go.
    pub fn set_held(&mut self, held: bool) {
        if let Body::Pendulum(pendulum) = &mut self.mechanism.body {
            pendulum.held = held;
        }
    }

    /// Pushes a body that balances forwards at its centre of mass with this force in N.
    pub fn set_push(&mut self, push: f64) {
        if let Body::Pendulum(pendulum) = &mut self.mechanism.body {
            pendulum.push = push;
        }
    }

    /// Becomes as another robot with the same parameters is.
    pub fn take_state(&mut self, other: &Self) {
        let (mechanism, other) = (&mut self.mechanism, &other.mechanism);
        for (motor, other) in mechanism.motors.iter_mut().zip(&other.motors) {
            if let (Some(motor), Some(other)) = (motor, other) {
                motor.take_state(other);
            }
        }
        match (&mut mechanism.body, &other.body) {
            (Body::Vehicle(vehicle), Body::Vehicle(other)) => vehicle.pose = other.pose,
            (body, other) => body.clone_from(other),
        }
    }

    /// Motion, currents and heat are the same, bit for bit; asked of two states of one robot.
    #[must_use]
    pub fn same_state(&self, other: &Self) -> bool {
        for pair in self.mechanism.motors.iter().zip(&other.mechanism.motors) {
            if let (Some(motor), Some(other)) = pair {
                if !same_bits(&motor.state(), &other.state()) {
                    return false;
                }
            }
        }
        let body = |robot: &Self| {
            let (pose, pitch) = (robot.pose().unwrap_or_default(), robot.pitch());
            let (angle, rate) = pitch.unwrap_or_default();
            [pose.x, pose.y, pose.heading, angle, rate]
        };
        same_bits(&body(self), &body(other))
    }

    /// Current that all motors take from the supply in A, mean of the last step.
    #[must_use]
    pub fn supply_current(&self) -> f64 {
        let motors = self.mechanism.motors.iter().flatten();
        motors.map(Motor::supply_current).sum()
    }

    /// Kinetic energy of motors and body in J.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let velocity = self.mechanism.velocities::<COORDINATES>();
        let momentum = self.mechanism.masses().multiply(&velocity);
        (0..COORDINATES)
            .map(|index| momentum[index] * velocity[index])
            .sum::<f64>()
            / 2.0
    }

    /// Advances by `dt` s with the bridges in the given states at `supply` V.
    pub fn step(&mut self, dt: f64, drives: &[MotorDrive; MOTORS], supply: f64) {
        let mechanism = &mut self.mechanism;
        match &mut self.solver {
            Solver::Gears(responses) => {
                mechanism.step::<MOTORS, GEAR_CONSTRAINTS>(responses, dt, drives, supply);
            }
            Solver::All(responses) => {
                mechanism.step::<COORDINATES, CONSTRAINTS>(responses, dt, drives, supply);
            }
        }
    }
}

fn same_bits(one: &[f64], other: &[f64]) -> bool {
    let bits = |value: &f64| value.to_bits();
    one.iter().map(bits).eq(other.iter().map(bits))
}
