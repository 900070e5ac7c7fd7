// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Times of the board in cycles of the master clock.

use at91sam7s::board::Cycles;
use at91sam7s::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR};

/// A time that never comes.
pub const NEVER: Cycles = Cycles::MAX;

/// One step of the plant, just under 100 us.
pub const PLANT_STEP_CYCLES: Cycles = 4_800;

/// Cycles in `count` microseconds, rounded down.
pub const fn microseconds(count: u64) -> Cycles {
    count * MASTER_CLOCK_HZ_NUMERATOR / (MASTER_CLOCK_HZ_DENOMINATOR * 1_000_000)
}

/// Cycles in `count` milliseconds, rounded down.
pub const fn milliseconds(count: u64) -> Cycles {
    microseconds(count * 1000)
}

/// Seconds in `cycles`.
pub fn seconds(cycles: Cycles) -> f64 {
    let hertz = MASTER_CLOCK_HZ_NUMERATOR as f64;
    cycles as f64 * MASTER_CLOCK_HZ_DENOMINATOR as f64 / hertz
}
