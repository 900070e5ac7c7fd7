// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Waveform mode: outputs TIOA and TIOB, external event on TIOB.

use super::{Channel, Line, ETRGS};
use crate::clock::Cycles;

/// Apply a two-bit effect: none, set, clear, toggle.
fn apply(output: &mut bool, effect: u32) {
    match effect & 3 {
        1 => *output = true,
        2 => *output = false,
        3 => *output = !*output,
        _ => {}
    }
}

impl Channel {
    /// RA acts on TIOA, RB on TIOB, RC on both and before them.
    pub(super) fn apply_compare_effects(&mut self, at_ra: bool, at_rb: bool, at_rc: bool) {
        let field = |shift: u32| self.mode >> shift & 3;
        let effect_a = if at_rc && field(18) != 0 {
            field(18)
        } else if at_ra {
            field(16)
        } else {
            0
        };
        let effect_b = if at_rc && field(26) != 0 {
            field(26)
        } else if at_rb {
            field(24)
        } else {
            0
        };
        apply(&mut self.output_a, effect_a);
        apply(&mut self.output_b, effect_b);
    }

    /// Effects of a software trigger or of an external event.
    pub(super) fn apply_trigger_effects(&mut self, external: bool) {
        let (shift_a, shift_b) = if external { (20, 28) } else { (22, 30) };
        let mode = self.mode;
        apply(&mut self.output_a, mode >> shift_a);
        apply(&mut self.output_b, mode >> shift_b);
    }

    /// An edge on TIOB may be the external event.
    pub(super) fn waveform_edge(&mut self, line: Line, rising: bool, now: Cycles) {
        let event_is_line_b = self.mode >> 10 & 3 == 0;
        if line != Line::B || !event_is_line_b || !edge_selected(self.mode >> 8, rising) {
            return;
        }
        self.status |= ETRGS;
        if self.mode & 1 << 12 != 0 {
            self.trigger(now, true);
        } else {
            self.apply_trigger_effects(true);
        }
    }
}

/// Two-bit edge selection: none, rising, falling, both.
pub(super) fn edge_selected(selection: u32, rising: bool) -> bool {
    match selection & 3 {
        0 => false,
        1 => rising,
        2 => !rising,
        _ => true,
    }
}
