// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Mechanics as configured.

use serde::Deserialize;

use super::error::{check, ConfigurationError, Range};
use super::motors::Motor;

/// What the motors move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// Free shafts: wheels off the floor.
    Bench,
    /// Two driven wheels and a castor on a level floor.
    DifferentialDrive(DifferentialDrive),
}

/// A vehicle with two driven wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferentialDrive {
    /// Index of the motor that drives the left wheel (A is 0).
    pub left: usize,
    /// Index of the motor that drives the right wheel.
    pub right: usize,
    /// Wheel radius, m.
    pub wheel_radius: f64,
    /// Distance between the wheels, m.
    pub track: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Inertia about the vertical axis, kg m².
    pub yaw_inertia: f64,
    /// Friction of the castor, N.
    pub castor_friction: f64,
    /// Rolling resistance, N.
    pub rolling_resistance: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum BodyKind {
    Bench,
    DifferentialDrive,
}

#[derive(Clone, Copy, Deserialize)]
enum Port {
    A,
    B,
    C,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyFields {
    kind: BodyKind,
    left: Option<Port>,
    right: Option<Port>,
    wheel_radius: Option<f64>,
    track: Option<f64>,
    mass: Option<f64>,
    yaw_inertia: Option<f64>,
    castor_friction: Option<f64>,
    rolling_resistance: Option<f64>,
}

impl BodyFields {
    pub(super) fn check(self, motors: &[Option<Motor>; 3]) -> Result<Body, ConfigurationError> {
        match self.kind {
            BodyKind::Bench => self.check_bench(),
            BodyKind::DifferentialDrive => self.check_drive(motors).map(Body::DifferentialDrive),
        }
    }

    fn check_bench(self) -> Result<Body, ConfigurationError> {
        let given = [
            ("left", self.left.is_some()),
            ("right", self.right.is_some()),
            ("wheel_radius", self.wheel_radius.is_some()),
            ("track", self.track.is_some()),
            ("mass", self.mass.is_some()),
            ("yaw_inertia", self.yaw_inertia.is_some()),
            ("castor_friction", self.castor_friction.is_some()),
            ("rolling_resistance", self.rolling_resistance.is_some()),
        ];
        match given.iter().find(|(_, present)| *present) {
            Some((name, _)) => {
                let problem = "a body of kind `bench` has no such field";
                Err(ConfigurationError::field(&format!("body.{name}"), problem))
            }
            None => Ok(Body::Bench),
        }
    }

    fn check_drive(
        self,
        motors: &[Option<Motor>; 3],
    ) -> Result<DifferentialDrive, ConfigurationError> {
        let left = wheel("body.left", self.left, motors)?;
        let right = wheel("body.right", self.right, motors)?;
        if left == right {
            let problem = "the left and the right wheel need two different motors";
            return Err(ConfigurationError::field("body.right", problem));
        }
        Ok(DifferentialDrive {
            left,
            right,
            wheel_radius: number("body.wheel_radius", self.wheel_radius, Range::Positive)?,
            track: number("body.track", self.track, Range::Positive)?,
            mass: number("body.mass", self.mass, Range::Positive)?,
            yaw_inertia: number("body.yaw_inertia", self.yaw_inertia, Range::Positive)?,
            castor_friction: number(
                "body.castor_friction",
                Some(self.castor_friction.unwrap_or(0.0)),
                Range::NotNegative,
            )?,
            rolling_resistance: number(
                "body.rolling_resistance",
                Some(self.rolling_resistance.unwrap_or(0.0)),
                Range::NotNegative,
            )?,
        })
    }
}

fn missing(path: &str) -> ConfigurationError {
    ConfigurationError::field(
        path,
        "missing; a body of kind `differential_drive` needs it",
    )
}

fn number(path: &str, number: Option<f64>, range: Range) -> Result<f64, ConfigurationError> {
    let number = number.ok_or_else(|| missing(path))?;
    check(path, number, range)?;
    Ok(number)
}

fn wheel(
    path: &str,
    port: Option<Port>,
    motors: &[Option<Motor>; 3],
) -> Result<usize, ConfigurationError> {
    let index = port.ok_or_else(|| missing(path))? as usize;
    match motors[index] {
        None => Err(ConfigurationError::field(
            path,
            "no motor is configured at this port",
        )),
        Some(Motor { hand: Some(_), .. }) => Err(ConfigurationError::field(
            path,
            "the motor at this port is held by hand",
        )),
        Some(_) => Ok(index),
    }
}
