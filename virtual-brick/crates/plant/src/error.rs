// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is wrong with a parameter.

use std::error::Error;
use std::fmt;

/// A parameter that the model does not accept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterError {
    /// Where it stands, joined by dots: `motors.B.parameters.resistance`.
    pub field: String,
    /// What was given.
    pub value: String,
    /// What is accepted.
    pub expected: String,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            expected,
        } = self;
        write!(formatter, "{field} = {value}: expected {expected}")
    }
}

impl Error for ParameterError {}

/// Checks that `value` lies in the closed range; `unit` is named in the error.
///
/// # Errors
/// The field, the value and the range when it does not, or is not a number.
pub fn within(
    field: &str,
    value: f64,
    lowest: f64,
    highest: f64,
    unit: &str,
) -> Result<(), ParameterError> {
    if value >= lowest && value <= highest {
        return Ok(());
    }
    Err(ParameterError {
        field: field.to_owned(),
        value: value.to_string(),
        expected: format!("a number from {lowest} to {highest} ({unit})"),
    })
}
