// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Levels of chosen pins over time.

use crate::clock::Cycles;

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

    pub(crate) fn chosen(&self) -> u32 {
        self.chosen
    }

    /// Log the pins whose bits are set, from these levels on.
    pub(crate) fn new(chosen: u32, now: LoggedPins) -> Self {
        Self {
            chosen,
            levels: vec![now],
        }
    }

    /// Levels at each change, from those when the log began.
    pub(crate) fn levels(&self) -> &[LoggedPins] {
        &self.levels
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
