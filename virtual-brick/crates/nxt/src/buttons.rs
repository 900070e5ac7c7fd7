// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The four buttons: three on a resistor ladder, the orange one on a line of its own.

/// A button of the brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The left arrow.
    Left,
    /// The right arrow.
    Right,
    /// Enter and power.
    Orange,
    /// Exit.
    Grey,
}

impl Button {
    /// Every button, in the order of the index.
    pub const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Orange, Self::Grey];

    /// Name as in the inputs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Orange => "orange",
            Self::Grey => "grey",
        }
    }
}

/// Added to the ladder's count while the orange button is down.
const ORANGE: u16 = 0x7FF;

/// Which buttons are down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Buttons {
    down: [bool; 4],
}

impl Buttons {
    pub fn set(&mut self, button: Button, down: bool) {
        self.down[button as usize] = down;
    }

    pub const fn is_down(self, button: Button) -> bool {
        self.down[button as usize]
    }

    /// The button word of the co-processor's frame. The counts are chosen so that every known
    /// decoder of the ladder agrees; of several buttons on the ladder the highest count wins.
    pub fn word(self) -> u16 {
        let ladder = if self.is_down(Button::Grey) {
            1023
        } else if self.is_down(Button::Right) {
            352
        } else if self.is_down(Button::Left) {
            128
        } else {
            0
        };
        if self.is_down(Button::Orange) {
            ladder + ORANGE
        } else {
            ladder
        }
    }
}
