// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Capture mode: edges of TIOA load RA and RB; an edge of TIOA or TIOB may trigger.

use super::waveform::edge_selected;
use super::{Channel, Line, ETRGS, LDRAS, LDRBS, LOVRS};
use crate::clock::Cycles;

impl Channel {
    pub(super) fn capture_edge(&mut self, line: Line, rising: bool, now: Cycles) {
        if !self.clocked || !self.enabled {
            return;
        }
        if line == Line::A {
            self.load(rising, now);
        }
        let trigger_line = if self.mode & 1 << 10 != 0 {
            Line::A
        } else {
            Line::B
        };
        if line == trigger_line && edge_selected(self.mode >> 8, rising) {
            self.status |= ETRGS;
            self.trigger(now, true);
        }
    }

    /// RA loads first after a trigger or a load of RB; RB only after RA.
    fn load(&mut self, rising: bool, now: Cycles) {
        if !self.ra_loaded && edge_selected(self.mode >> 16, rising) {
            self.ra = self.value_at(now);
            self.ra_loaded = true;
            self.status |= LDRAS | overrun(self.unread_a);
            self.unread_a = true;
        } else if self.ra_loaded && edge_selected(self.mode >> 18, rising) {
            self.rb = self.value_at(now);
            self.ra_loaded = false;
            self.status |= LDRBS | overrun(self.unread_b);
            self.unread_b = true;
            self.value = self.value_at(now);
            self.edge = self.edge_before(now);
            self.stop_or_disable();
        }
    }
}

/// Load overrun: the register was loaded again before it or the status was read.
fn overrun(unread: bool) -> u32 {
    if unread {
        LOVRS
    } else {
        0
    }
}
