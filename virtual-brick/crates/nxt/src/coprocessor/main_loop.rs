// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Passes of the co-processor's main loop.
//!
//! Each pass ends with the bridges' update. A pass that finds 93 counts of a 31,250 Hz timer
//! gone also runs the state machine: that is a tick, and in operation it samples all inputs.

use at91sam7s::board::Cycles;
use at91sam7s::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR};

use crate::time::microseconds;

const TIMER_HZ: u128 = 31_250;
/// Counts of the timer after which a tick begins.
const TICK_COUNTS: u128 = 93;
/// A pass that samples, with its update of the bridges.
const SAMPLING_PASS: Cycles = microseconds(672);

/// Counts of the timer's prescaler in `at` cycles.
fn timer_counts(at: Cycles) -> u128 {
    u128::from(at) * TIMER_HZ * u128::from(MASTER_CLOCK_HZ_DENOMINATOR)
        / u128::from(MASTER_CLOCK_HZ_NUMERATOR)
}

/// The first cycle at which the prescaler has counted that far.
fn cycle_of_count(count: u128) -> Cycles {
    let cycles = (count * u128::from(MASTER_CLOCK_HZ_NUMERATOR))
        .div_ceil(TIMER_HZ * u128::from(MASTER_CLOCK_HZ_DENOMINATOR));
    cycles as Cycles
}

/// Where the main loop is.
#[derive(Clone, Copy, Debug)]
pub(super) struct MainLoop {
    /// When the pass of the tick began or, before the first one, begins.
    pub(super) tick_at: Cycles,
    /// When that pass ends; others follow one after another.
    pass_end: Cycles,
    pub(super) next_tick_at: Cycles,
    pass_cycles: Cycles,
}

impl MainLoop {
    pub(super) fn new(tick_at: Cycles, sampling: bool, pass_cycles: Cycles) -> Self {
        let own = if sampling { SAMPLING_PASS } else { pass_cycles };
        let pass_end = tick_at + own;
        let due = cycle_of_count(timer_counts(tick_at) + TICK_COUNTS);
        let passes = due.saturating_sub(pass_end).div_ceil(pass_cycles);
        Self {
            tick_at,
            pass_end,
            next_tick_at: pass_end + passes * pass_cycles,
            pass_cycles,
        }
    }

    /// A loop whose passes are already running at `now`.
    pub(super) const fn running(now: Cycles, next_tick_at: Cycles, pass_cycles: Cycles) -> Self {
        Self {
            tick_at: now,
            pass_end: now + pass_cycles,
            next_tick_at,
            pass_cycles,
        }
    }

    /// The next tick's pass begins.
    pub(super) fn begin_tick(&mut self, sampling: bool) {
        *self = Self::new(self.next_tick_at, sampling, self.pass_cycles);
    }

    /// When the pass of `now` updates the bridges.
    pub(super) fn update_after(&self, now: Cycles) -> Cycles {
        let beyond = now.checked_sub(self.pass_end);
        let passes = beyond.map_or(0, |cycles| cycles / self.pass_cycles + 1);
        (self.pass_end + passes * self.pass_cycles).min(self.next_tick_at.max(now))
    }
}

#[cfg(test)]
mod tests {
    use super::MainLoop;
    use crate::coprocessor::CoprocessorTiming;
    use crate::time::microseconds;

    const PASS: u64 = CoprocessorTiming::nominal().pass_cycles;

    #[test]
    fn ticks_are_a_pass_more_or_less_around_2_985_ms() {
        let mut main_loop = MainLoop::new(12_345, true, PASS);
        for _ in 0..1_000 {
            main_loop.begin_tick(true);
            let length = main_loop.next_tick_at - main_loop.tick_at;
            assert!((microseconds(2_944)..=microseconds(3_016)).contains(&length));
        }
        let mean = (main_loop.tick_at - 12_345) / 1_000;
        assert!(
            mean.abs_diff(microseconds(2_985)) < microseconds(10),
            "{mean}"
        );
    }

    #[test]
    fn bridges_are_updated_at_the_end_of_each_pass() {
        let main_loop = MainLoop::new(0, true, PASS);
        let sampled = microseconds(672);
        assert_eq!(main_loop.update_after(0), sampled);
        assert_eq!(main_loop.update_after(sampled - 1), sampled);
        assert_eq!(main_loop.update_after(sampled), sampled + PASS);
        assert_eq!(main_loop.update_after(sampled + PASS), sampled + 2 * PASS);
    }
}
