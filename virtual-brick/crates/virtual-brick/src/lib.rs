// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Facade of the virtual brick: assembles the chip, the board and the plant, loads an image,
//! runs it, and records what happens.

mod configuration;
mod image;

pub use configuration::{
    Battery, BatteryKind, Body, Configuration, ConfigurationError, DifferentialDrive, Hand, Motor,
    MotorParameters, Sensor,
};
pub use image::{Image, ImageError, Placement, ScalarKind, Segment, Symbol, Symbols, Variable};
