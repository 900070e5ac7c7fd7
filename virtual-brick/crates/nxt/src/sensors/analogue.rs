// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Any passive analogue sensor, given by the count that the converter reads.

use plant::ParameterError;
use serde::Deserialize;

use super::{Device, Lines, OPEN};

/// The sensor and its count, 0 to 1023; an open input at the start when none is given.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AnalogueSensor {
    raw: u16,
}

impl Default for AnalogueSensor {
    fn default() -> Self {
        Self { raw: OPEN }
    }
}

impl Device for AnalogueSensor {
    fn check(&self, field: &str) -> Result<(), ParameterError> {
        if self.raw <= OPEN {
            return Ok(());
        }
        Err(ParameterError {
            field: format!("{field}.raw"),
            value: self.raw.to_string(),
            expected: "an integer from 0 to 1023".to_owned(),
        })
    }

    fn set(&mut self, key: &str, value: f64) -> bool {
        self.raw = value as u16;
        key == "raw"
    }

    fn raw(&self, _lines: Lines) -> u16 {
        self.raw
    }
}
