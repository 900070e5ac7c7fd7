// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The touch sensor: a push button.

use serde::Deserialize;

use super::{Device, Lines, OPEN};

/// Count while it is pressed: 2.2 kilo-ohm in it against the pull-up of 10.
const PRESSED: u16 = 183;

/// The sensor, pressed or not.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TouchSensor {
    #[serde(skip)]
    pressed: bool,
}

impl Device for TouchSensor {
    fn set(&mut self, key: &str, value: f64) -> bool {
        self.pressed = value != 0.0;
        key == "pressed"
    }

    fn raw(&self, _lines: Lines) -> u16 {
        if self.pressed {
            PRESSED
        } else {
            OPEN
        }
    }
}
