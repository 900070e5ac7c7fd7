// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Parameters of the robot, as they stand in a configuration, and their limits.

use serde::Deserialize;

use crate::balancer::Balancer;
use crate::error::{within, ParameterError};
use crate::motor_parameters::{check_wheels, MotorPort, MotorPorts};
use crate::surroundings::Surroundings;

/// Two driven wheels on one axle and a castor, on a flat floor, the tyres never slipping.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DifferentialDrive {
    /// Motor port of the left wheel.
    pub left: MotorPort,
    /// Motor port of the right wheel.
    pub right: MotorPort,
    /// Rolling radius of the driven wheels in m.
    pub wheel_radius: f64,
    /// Distance between the driven wheels in m.
    pub track: f64,
    /// Mass of the whole vehicle in kg, thought at the middle of the axle.
    pub mass: f64,
    /// Moment of inertia about the vertical axis in kg m^2.
    pub yaw_inertia: f64,
    /// Friction force at the castor, against its motion over the floor, in N.
    pub castor_friction: f64,
    /// Force against rolling, at the axle, in N.
    pub rolling_resistance: f64,
    /// Distance of the castor from the axle in m; the track when absent.
    #[serde(default)]
    pub castor_distance: Option<f64>,
}

impl DifferentialDrive {
    /// Distance of the castor from the axle in m.
    #[must_use]
    pub fn castor_arm(&self) -> f64 {
        self.castor_distance.unwrap_or(self.track)
    }

    fn check(&self, motors: &MotorPorts) -> Result<(), ParameterError> {
        let rows = [
            ("wheel_radius", self.wheel_radius, 1e-3, 1.0, "m"),
            ("track", self.track, 0.01, 2.0, "m"),
            ("mass", self.mass, 0.01, 100.0, "kg"),
            ("yaw_inertia", self.yaw_inertia, 1e-6, 100.0, "kg m^2"),
            ("castor_friction", self.castor_friction, 0.0, 100.0, "N"),
            (
                "rolling_resistance",
                self.rolling_resistance,
                0.0,
                100.0,
                "N",
            ),
            ("castor_distance", self.castor_arm(), 1e-3, 2.0, "m"),
        ];
        for (name, value, lowest, highest, unit) in rows {
            within(&format!("body.{name}"), value, lowest, highest, unit)?;
        }
        check_wheels(self.left, self.right, motors)
    }
}

/// What the motors turn.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyParameters {
    /// Shafts turn freely; wheels off the floor.
    Bench {},
    /// A vehicle.
    DifferentialDrive(DifferentialDrive),
    /// A body that balances on two wheels.
    Balancer(Balancer),
}

impl Default for BodyParameters {
    fn default() -> Self {
        Self::Bench {}
    }
}

/// Everything the plant is made of.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotParameters {
    /// The motor ports.
    #[serde(default)]
    pub motors: MotorPorts,
    /// The body; a bench when absent.
    #[serde(default)]
    pub body: BodyParameters,
    /// What is around the robot; nothing when absent.
    #[serde(default)]
    pub surroundings: Surroundings,
}

impl RobotParameters {
    /// Checks every number against its range and every reference.
    ///
    /// # Errors
    /// The first field that is not accepted, in the order of declaration.
    pub fn check(&self) -> Result<(), ParameterError> {
        for port in MotorPort::ALL {
            if let Some(motor) = self.motors.get(port) {
                motor.check(&format!("motors.{}", port.letter()))?;
            }
        }
        match &self.body {
            BodyParameters::Bench {} => Ok(()),
            BodyParameters::DifferentialDrive(drive) => drive.check(&self.motors),
            BodyParameters::Balancer(balancer) => balancer.check(&self.motors),
        }?;
        self.surroundings.check()
    }
}
