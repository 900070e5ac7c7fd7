// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Motors and mechanics of the robot. Knows volts and radians, no registers.
//!
//! A [`Robot`] is three motor ports and a body; [`Surroundings`] is what its sensors see. A robot
//! is advanced by a fixed step of about 100 us with the trapezoidal rule; friction, backlash stops
//! and the castor are impulses found in the same step, so that a shaft at rest is at rest exactly.
//! The result is a function of the parameters and the inputs: only + - * / and functions of `libm`
//! are used.

mod balancer;
mod body;
mod drive;
mod error;
mod mechanism;
mod motor;
mod motor_parameters;
mod parameters;
mod pose;
mod robot;
mod solver;
mod surroundings;
mod thermal;

pub use balancer::Balancer;
pub use drive::{Decay, MotorDrive};
pub use error::{within, ParameterError};
pub use motor::Motor;
pub use motor_parameters::{MotorParameters, MotorPort, MotorPorts, PluggedMotor};
pub use parameters::{BodyParameters, DifferentialDrive, RobotParameters};
pub use pose::Pose;
pub use robot::Robot;
pub use surroundings::{Floor, Mount, Surroundings, Wall};
pub use thermal::CutOut;
