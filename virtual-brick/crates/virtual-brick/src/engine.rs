// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The two ways to execute instructions, which differ in speed only.

use serde::Deserialize;

/// Which engine executes instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// Decoded blocks where nothing can fall into them, else the reference.
    #[default]
    Fast,
    /// One instruction after the other, each access through the bus.
    Reference,
}
