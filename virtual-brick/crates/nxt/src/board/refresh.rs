// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The display and the reports of its picture, which wait for a pause in what is sent to it.

use at91sam7s::board::Cycles;

use crate::display::Display;
use crate::event::{BoardEventKind, BoardFault, EventLog};
use crate::time::{milliseconds, NEVER};

/// The picture is reported when nothing was sent for this long ...
const DISPLAY_PAUSE: Cycles = milliseconds(2);
/// ... or that long after the first byte.
const DISPLAY_PERIOD: Cycles = milliseconds(20);

/// The display and when its picture is reported next.
#[derive(Clone, Debug)]
pub(super) struct Refresh {
    display: Display,
    first_at: Option<Cycles>,
    pub(super) due_at: Cycles,
    digest: u64,
}

impl Refresh {
    pub(super) fn new(display: Display) -> Self {
        Self {
            digest: display.picture().digest(),
            display,
            first_at: None,
            due_at: NEVER,
        }
    }

    pub(super) const fn display(&self) -> &Display {
        &self.display
    }

    pub(super) fn data_written(&mut self, now: Cycles, byte: u8) {
        self.display.write_data(byte);
        self.postpone(now);
    }

    pub(super) fn command_written(&mut self, now: Cycles, byte: u8) -> Result<(), BoardFault> {
        self.postpone(now);
        self.display.write_command(byte)
    }

    fn postpone(&mut self, now: Cycles) {
        let first_at = *self.first_at.get_or_insert(now);
        self.due_at = (now + DISPLAY_PAUSE).min(first_at + DISPLAY_PERIOD);
    }

    /// Report the picture when it is due and has changed.
    pub(super) fn advance(&mut self, now: Cycles, log: &mut EventLog) {
        if self.due_at > now {
            return;
        }
        let digest = self.display.picture().digest();
        if digest != self.digest {
            log.add(now, BoardEventKind::DisplayChanged(digest));
        }
        self.digest = digest;
        self.first_at = None;
        self.due_at = NEVER;
    }
}
