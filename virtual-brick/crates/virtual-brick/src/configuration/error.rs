// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What is wrong with a configuration, and where.

use std::fmt;

/// A configuration that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigurationError {
    /// Path of the field, for example `motors.B.parameters.inertia`; `.` for the whole text.
    pub path: String,
    /// What was expected.
    pub problem: String,
}

impl ConfigurationError {
    pub(super) fn field(path: &str, problem: impl fmt::Display) -> Self {
        Self {
            path: path.to_owned(),
            problem: problem.to_string(),
        }
    }

    pub(super) fn text(error: impl fmt::Display) -> Self {
        Self::field(".", error)
    }
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.path.as_str() {
            "." => write!(f, "configuration: {}", self.problem),
            path => write!(f, "configuration field `{path}`: {}", self.problem),
        }
    }
}

impl std::error::Error for ConfigurationError {}

impl From<serde_path_to_error::Error<serde_json::Error>> for ConfigurationError {
    fn from(error: serde_path_to_error::Error<serde_json::Error>) -> Self {
        Self::field(&error.path().to_string(), error.inner())
    }
}

impl From<plant::ParameterError> for ConfigurationError {
    fn from(error: plant::ParameterError) -> Self {
        let problem = format!("{} must be {}", error.value, error.expected);
        Self {
            path: error.field,
            problem,
        }
    }
}
