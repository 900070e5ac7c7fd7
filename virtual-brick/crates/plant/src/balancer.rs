// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A body that stands on two driven wheels and falls over unless they keep it up.
//!
//! Lagrange's equations of two wheels that roll without slipping and a body that pitches about
//! their axle (Y. Yamamoto, NXTway-GS Model-Based Design, 2008, section 3), not linearised. The
//! coordinates are the angles of the wheels against the body, which the encoders measure and in
//! which the gear trains' friction acts, and the pitch of the body.

use serde::Deserialize;

use crate::error::{within, ParameterError};
use crate::motor_parameters::{check_wheels, MotorPort, MotorPorts};
use crate::pose::Pose;
use crate::solver::{Coupling, MassMatrix, Vector, PITCH};

const STANDARD_GRAVITY: f64 = 9.81;

/// Two driven wheels on one axle and a body above them, on a flat floor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Balancer {
    /// Motor port of the left wheel.
    pub left: MotorPort,
    /// Motor port of the right wheel.
    pub right: MotorPort,
    /// Rolling radius of the wheels in m.
    pub wheel_radius: f64,
    /// Mass of one wheel in kg.
    pub wheel_mass: f64,
    /// Moment of inertia of one wheel about the axle in kg m^2.
    pub wheel_inertia: f64,
    /// Distance between the wheels in m.
    pub track: f64,
    /// Mass of the body in kg.
    pub mass: f64,
    /// Distance of the body's centre of mass from the axle in m.
    pub centre_height: f64,
    /// Moment of inertia of the body about its centre of mass, in pitch, in kg m^2.
    pub pitch_inertia: f64,
    /// Moment of inertia of the body about the vertical in kg m^2.
    pub yaw_inertia: f64,
    /// Pitch in rad at which the body lies on the floor; 1.4 when absent.
    #[serde(default)]
    pub fallen_pitch: Option<f64>,
    /// Pitch in rad in which a hand holds the body at the start; 0 when absent.
    #[serde(default)]
    pub start_pitch: f64,
}

impl Balancer {
    fn fallen(&self) -> f64 {
        self.fallen_pitch.unwrap_or(1.4)
    }

    pub(crate) fn check(&self, motors: &MotorPorts) -> Result<(), ParameterError> {
        let rows = [
            ("wheel_radius", self.wheel_radius, 1e-3, 1.0, "m"),
            ("wheel_mass", self.wheel_mass, 1e-4, 100.0, "kg"),
            ("wheel_inertia", self.wheel_inertia, 1e-8, 100.0, "kg m^2"),
            ("track", self.track, 0.01, 2.0, "m"),
            ("mass", self.mass, 0.01, 100.0, "kg"),
            ("centre_height", self.centre_height, 1e-3, 2.0, "m"),
            ("pitch_inertia", self.pitch_inertia, 1e-6, 100.0, "kg m^2"),
            ("yaw_inertia", self.yaw_inertia, 1e-6, 100.0, "kg m^2"),
            ("fallen_pitch", self.fallen(), 0.1, 1.5, "rad"),
            (
                "start_pitch",
                self.start_pitch,
                -self.fallen(),
                self.fallen(),
                "rad",
            ),
        ];
        for (name, value, lowest, highest, unit) in rows {
            within(&format!("body.{name}"), value, lowest, highest, unit)?;
        }
        check_wheels(self.left, self.right, motors)
    }
}

/// State of the body; a hand holds it at the start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pendulum {
    parameters: Balancer,
    pub left: usize,
    pub right: usize,
    pub pose: Pose,
    pub pitch: f64,
    pub pitch_rate: f64,
    pub held: bool,
    /// Horizontal force at the centre of mass, forwards, in N.
    pub push: f64,
}

impl Pendulum {
    /// `left` and `right` are the coordinates of the wheels.
    pub fn new(parameters: Balancer, left: usize, right: usize) -> Self {
        Self {
            pitch: parameters.start_pitch,
            parameters,
            left,
            right,
            pose: Pose::default(),
            pitch_rate: 0.0,
            held: true,
            push: 0.0,
        }
    }

    pub const fn parameters(&self) -> &Balancer {
        &self.parameters
    }

    /// Mass times distance from the axle times wheel radius: couples rolling and pitching.
    fn lever(&self) -> f64 {
        self.parameters.mass * self.parameters.centre_height * self.parameters.wheel_radius
    }

    /// Inertia about the vertical axis without that of the wheels about the axle.
    fn yaw_inertia(&self) -> f64 {
        let body = &self.parameters;
        let arm = body.centre_height * libm::sin(self.pitch);
        body.yaw_inertia + body.wheel_mass * body.track * body.track / 2.0 + body.mass * arm * arm
    }

    /// Adds the kinetic energy of wheels and body.
    pub fn add_masses<const N: usize>(&self, masses: &mut MassMatrix<N>) {
        let body = &self.parameters;
        let radius = body.wheel_radius;
        let rolling = (body.mass + 2.0 * body.wheel_mass) * radius * radius;
        let turning = self.yaw_inertia() * radius * radius / (body.track * body.track);
        let tilt = self.lever() * libm::cos(self.pitch);
        let about_axle = body.pitch_inertia + body.mass * body.centre_height * body.centre_height;
        let own = rolling / 4.0 + body.wheel_inertia + turning;
        let with_pitch = rolling / 2.0 + body.wheel_inertia + tilt / 2.0;
        masses.diagonal[self.left] += own;
        masses.diagonal[self.right] += own;
        masses.diagonal[PITCH] = rolling + 2.0 * body.wheel_inertia + 2.0 * tilt + about_axle;
        masses.coupling = Coupling::Triple {
            indices: [self.left, self.right, PITCH],
            off_diagonal: [rolling / 4.0 - turning, with_pitch, with_pitch],
        };
    }

    /// Adds the impulses of weight, push and the terms with products of velocities in `dt` s.
    pub fn add_impulses<const N: usize>(
        &self,
        velocity: &Vector<N>,
        dt: f64,
        impulse: &mut Vector<N>,
    ) {
        let body = &self.parameters;
        let (sine, cosine) = (libm::sin(self.pitch), libm::cos(self.pitch));
        let rate = velocity[PITCH];
        let ratio = body.wheel_radius / body.track;
        let yaw_rate = ratio * (velocity[self.right] - velocity[self.left]);
        let arm = body.mass * body.centre_height * body.centre_height * sine * cosine;
        let along = self.lever() * sine * rate * rate + body.wheel_radius * self.push;
        let turning = 2.0 * arm * rate * yaw_rate * ratio;
        let weight = body.mass * STANDARD_GRAVITY * body.centre_height * sine;
        impulse[self.left] += dt * (along / 2.0 + turning);
        impulse[self.right] += dt * (along / 2.0 - turning);
        impulse[PITCH] += dt
            * (along
                + weight
                + arm * yaw_rate * yaw_rate
                + body.centre_height * cosine * self.push);
    }

    /// Lowest and highest pitch rate that does not lead through the floor.
    pub fn pitch_rates(&self, dt: f64) -> (f64, f64) {
        let fallen = self.parameters.fallen();
        ((-fallen - self.pitch) / dt, (fallen - self.pitch) / dt)
    }

    /// Ends a step: new pitch rate; angle by which the body turned.
    pub fn finish_step(&mut self, pitch_rate: f64, dt: f64) -> f64 {
        let turn = dt * (self.pitch_rate + pitch_rate) / 2.0;
        let fallen = self.parameters.fallen();
        let before = self.pitch;
        self.pitch = (before + turn).clamp(-fallen, fallen);
        self.pitch_rate = pitch_rate;
        self.pitch - before
    }
}
