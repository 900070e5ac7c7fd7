// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What happens while the counter counts: compares, overflows, triggers, and when the next shows.

use super::{Channel, COVFS, CPAS, CPBS, CPCS, DISABLE, STOP, TOP};
use crate::clock::{Cycles, NEVER};

/// Values that count in a period: RA, RB, RC and the top upwards, then RC, RB, RA and 0.
const PERIOD_STEPS_MAX: u32 = 8;

impl Channel {
    /// Steps until the counter next does something worth an event.
    fn steps_to_event(&self) -> u32 {
        if !self.up {
            let below = |target: u32| {
                if target < self.value {
                    self.value - target
                } else {
                    TOP
                }
            };
            let compares = below(self.ra).min(below(self.rb)).min(below(self.rc));
            return compares.min(self.value).max(1);
        }
        let above = |target: u32| {
            if target > self.value {
                target - self.value
            } else {
                TOP + 1 - self.value
            }
        };
        let compares = above(self.ra).min(above(self.rb)).min(above(self.rc));
        if self.counts_up_and_down() {
            compares.min(above(self.peak()))
        } else {
            compares
        }
    }

    /// What can be seen of it without advancing it.
    fn shown(&self) -> (u32, [bool; 2], [bool; 2]) {
        let outputs = [self.output_a, self.output_b];
        (self.status, [self.enabled, self.started], outputs)
    }

    /// When this channel wants to be served: at a trigger, or when something shows. What does not
    /// show in a whole period never will.
    pub(crate) fn next_event(&self) -> Cycles {
        if !self.running() {
            return self.next_step().0;
        }
        let mut ahead = self.clone();
        for _ in 0..PERIOD_STEPS_MAX {
            let (at, steps) = ahead.next_step();
            if at == ahead.trigger_at || at == NEVER {
                return at;
            }
            ahead.step_onto_event(at, steps);
            if ahead.shown() != self.shown() {
                return at;
            }
        }
        NEVER
    }

    /// When the counter next reaches a value that counts, or is triggered, and steps until then.
    pub(super) fn next_step(&self) -> (Cycles, u32) {
        let trigger = if self.clocked { self.trigger_at } else { NEVER };
        if !self.running() {
            return (trigger, 0);
        }
        let steps = self.steps_to_event();
        let at = self.edge + Cycles::from(steps) * self.divider();
        (trigger.min(at), steps)
    }

    /// Bring the channel to `now`: triggers and compares in the order of time.
    pub(crate) fn advance(&mut self, now: Cycles) {
        loop {
            let (at, steps) = self.next_step();
            if at > now {
                return;
            }
            if self.trigger_at == at {
                self.take_trigger(at);
            } else {
                self.step_onto_event(at, steps);
                if self.value == 0 {
                    self.leave_out_periods(now);
                }
            }
        }
    }

    /// At the beginning of a period: whole periods up to `now`, if nothing shows in them.
    fn leave_out_periods(&mut self, now: Cycles) {
        let steps = if self.counts_up_and_down() {
            2 * self.rc
        } else {
            self.rc
        };
        let period = Cycles::from(steps) << self.divider_bits();
        let whole = (now - self.edge).checked_div(period).unwrap_or(0);
        if whole > 1 && self.rc_is_limit() && self.next_event() == NEVER {
            self.edge += whole * period;
        }
    }

    fn step_onto_event(&mut self, at: Cycles, steps: u32) {
        let next = if self.up {
            self.value + steps
        } else {
            self.value.wrapping_sub(steps)
        };
        if next > TOP {
            self.status |= COVFS;
        }
        self.value = next & TOP;
        self.edge = at;
        self.compare(self.value);
        if self.counts_up_and_down() {
            if self.up && self.value == self.peak() {
                self.up = false;
            } else if self.value == 0 {
                self.up = true;
            }
        }
    }

    /// The counter stepped onto `value`.
    fn compare(&mut self, value: u32) {
        let at_rc = value == self.rc;
        if self.is_waveform() {
            if value == self.ra {
                self.status |= CPAS;
            }
            if value == self.rb {
                self.status |= CPBS;
            }
            self.apply_compare_effects(value == self.ra, value == self.rb, at_rc);
        }
        if !at_rc {
            return;
        }
        self.status |= CPCS;
        if self.rc_is_limit() && !self.counts_up_and_down() {
            self.value = 0;
            self.ra_loaded = false;
        }
        if self.is_waveform() {
            self.stop_or_disable();
        }
    }

    pub(super) fn stop_or_disable(&mut self) {
        if self.mode & STOP != 0 {
            self.started = false;
        }
        if self.mode & DISABLE != 0 {
            self.enabled = false;
        }
    }

    fn take_trigger(&mut self, at: Cycles) {
        let was_running = self.running();
        self.trigger_at = NEVER;
        if self.counts_up_and_down() && was_running {
            self.value = self.value_at(at);
            self.up = !self.up;
        } else {
            self.value = 0;
            self.up = true;
        }
        self.edge = at;
        self.started = true;
        self.ra_loaded = false;
        if self.is_waveform() {
            self.apply_trigger_effects(self.trigger_is_external);
        }
    }
}
