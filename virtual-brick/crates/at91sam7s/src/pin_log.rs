// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Levels of chosen pins over time, for those who ask for them.

use crate::board::{Board, Cycles};
use crate::chip::Chip;

/// Changes that are kept; later ones are lost.
const CHANGES_MAX: usize = 1 << 22;

/// Levels of all pins from an instant on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedPins {
    /// Since when.
    pub at_cycles: Cycles,
    /// Bit n: level of pin n.
    pub pins: u32,
}

/// The chosen pins and what they did.
#[derive(Clone, Debug, Default)]
pub(crate) struct PinLog {
    chosen: u32,
    levels: Vec<LoggedPins>,
}

impl PinLog {
    /// Pins changed; those of one instant count as one change.
    #[inline]
    pub(crate) fn changed(&mut self, changed: u32, at_cycles: Cycles, pins: u32) {
        if changed & self.chosen != 0 {
            self.add(LoggedPins { at_cycles, pins });
        }
    }

    fn add(&mut self, levels: LoggedPins) {
        let count = self.levels.len();
        match self.levels.last_mut() {
            Some(last) if last.at_cycles == levels.at_cycles => *last = levels,
            _ if count < CHANGES_MAX => self.levels.push(levels),
            _ => {}
        }
    }
}

impl<B: Board> Chip<B> {
    /// Log the pins whose bits are set, from now on; what was logged before is forgotten.
    pub fn log_pins(&mut self, chosen: u32) {
        self.pin_log = PinLog {
            chosen,
            levels: Vec::new(),
        };
        let (at_cycles, pins) = (self.now(), self.pins());
        self.pin_log.add(LoggedPins { at_cycles, pins });
    }

    /// Levels at each change of a logged pin, from those when the log began.
    pub fn logged_pins(&self) -> &[LoggedPins] {
        &self.pin_log.levels
    }
}
