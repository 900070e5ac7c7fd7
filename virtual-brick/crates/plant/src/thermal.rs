// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The resettable fuse in a motor: it warms up with the square of the current and opens.

use serde::Deserialize;

use crate::error::{within, ParameterError};

/// A fuse with one thermal time constant, in terms of the steady currents that it bears.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutOut {
    /// Steady current in A that just opens it.
    pub trip_current: f64,
    /// Steady current in A whose heat it must cool down to before it closes again.
    pub reset_current: f64,
    /// Thermal time constant in s.
    pub time_constant: f64,
}

impl CutOut {
    pub(crate) fn check(&self, path: &str) -> Result<(), ParameterError> {
        let field = |name| format!("{path}.{name}");
        within(&field("trip_current"), self.trip_current, 0.01, 100.0, "A")?;
        let (reset, highest) = (self.reset_current, self.trip_current);
        let unit = "A, not more than trip_current";
        within(&field("reset_current"), reset, 0.001, highest, unit)?;
        within(&field("time_constant"), self.time_constant, 0.01, 1e4, "s")
    }
}

/// Heat in the fuse as the square of the steady current that would keep it, in A^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Heat {
    square: f64,
    open: bool,
}

impl Heat {
    pub const fn is_open(self) -> bool {
        self.open
    }

    /// Square of the steady current in A^2.
    pub const fn square(self) -> f64 {
        self.square
    }

    /// `current` flowed for `dt` s.
    pub fn advance(&mut self, fuse: &CutOut, current: f64, dt: f64) {
        self.square += (current * current - self.square) * dt / fuse.time_constant;
        if self.square >= fuse.trip_current * fuse.trip_current {
            self.open = true;
        } else if self.square <= fuse.reset_current * fuse.reset_current {
            self.open = false;
        }
    }
}
