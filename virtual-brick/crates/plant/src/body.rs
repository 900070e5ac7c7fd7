// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the motors move: the vehicle's mass seen from its wheels, and its path.

use crate::parameters::DifferentialDrive;
use crate::pose::Pose;
use crate::solver::{Direction, Vector};

/// Speed in m/s below which the castor's direction is that of the coming motion.
const SLOW: f64 = 1e-6;

/// A vehicle: parameters, coordinates of its wheels, pose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Vehicle {
    parameters: DifferentialDrive,
    pub left: usize,
    pub right: usize,
    pub pose: Pose,
}

impl Vehicle {
    /// `left` and `right` are the coordinates of the wheels.
    pub fn new(parameters: DifferentialDrive, left: usize, right: usize) -> Self {
        Self {
            parameters,
            left,
            right,
            pose: Pose::default(),
        }
    }

    pub const fn parameters(&self) -> &DifferentialDrive {
        &self.parameters
    }

    /// Inertia at one wheel with the other free of it, and the coupling of both, in kg m^2.
    pub fn wheel_inertia(&self) -> (f64, f64) {
        let DifferentialDrive {
            wheel_radius,
            track,
            mass,
            yaw_inertia,
            ..
        } = self.parameters;
        let square = wheel_radius * wheel_radius;
        let along = mass * square / 4.0;
        let about = yaw_inertia * square / (track * track);
        (along + about, along - about)
    }

    /// Direction of rolling: m of travel per rad of each wheel.
    pub fn rolling_direction(&self) -> Direction {
        let half = self.parameters.wheel_radius / 2.0;
        [(self.left, half), (self.right, half)]
    }

    /// Direction of the castor's motion now, or of the motion that would come.
    #[inline(always)]
    pub fn castor_direction<const N: usize>(
        &self,
        now: &Vector<N>,
        coming: &Vector<N>,
    ) -> Direction {
        let (mut along, mut across) = self.castor_velocity(now);
        let mut speed = libm::hypot(along, across);
        if speed < SLOW {
            (along, across) = self.castor_velocity(coming);
            speed = libm::hypot(along, across);
        }
        if speed < SLOW {
            return self.rolling_direction();
        }
        let half = self.parameters.wheel_radius / 2.0 * along / speed;
        let turn = self.castor_arm_ratio() * across / speed;
        [(self.left, half - turn), (self.right, half + turn)]
    }

    fn castor_arm_ratio(&self) -> f64 {
        let DifferentialDrive {
            wheel_radius,
            track,
            ..
        } = self.parameters;
        self.parameters.castor_arm() * wheel_radius / track
    }

    fn castor_velocity<const N: usize>(&self, velocity: &Vector<N>) -> (f64, f64) {
        let (left, right) = (velocity[self.left], velocity[self.right]);
        let along = self.parameters.wheel_radius * (left + right) / 2.0;
        (along, self.castor_arm_ratio() * (right - left))
    }

    /// Moves the pose along the arc that belongs to these turns of the wheels in rad.
    pub fn roll(&mut self, left: f64, right: f64) {
        let DifferentialDrive {
            wheel_radius,
            track,
            ..
        } = self.parameters;
        self.pose.roll(wheel_radius, track, left, right);
    }
}
