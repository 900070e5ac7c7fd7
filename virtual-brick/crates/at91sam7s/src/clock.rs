// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Units of time: the master clock, in whose cycles everything is counted, and the slow clock.

/// Master clock cycles since power-on.
pub type Cycles = u64;

/// Numerator of the master clock in Hz: 18.432 MHz crystal, times 73, over 14 and 2.
pub const MASTER_CLOCK_HZ_NUMERATOR: u64 = 336_384_000;
/// Denominator of the master clock in Hz.
pub const MASTER_CLOCK_HZ_DENOMINATOR: u64 = 7;
/// Nominal frequency of the slow clock (internal RC oscillator).
pub const SLOW_CLOCK_HZ: u64 = 32_768;

/// Master clock cycles in `count` periods of the nominal slow clock, below 2^53, rounded down.
pub(crate) const fn slow_clock_cycles(count: u64) -> Cycles {
    const SCALE: u64 = MASTER_CLOCK_HZ_DENOMINATOR * SLOW_CLOCK_HZ;
    let (whole, rest) = (count / SCALE, count % SCALE);
    whole * MASTER_CLOCK_HZ_NUMERATOR + rest * MASTER_CLOCK_HZ_NUMERATOR / SCALE
}

/// Master clock cycles in `count` microseconds, rounded down.
pub(crate) const fn microseconds_cycles(count: u64) -> Cycles {
    count * MASTER_CLOCK_HZ_NUMERATOR / (MASTER_CLOCK_HZ_DENOMINATOR * 1_000_000)
}

/// A time that never comes.
pub(crate) const NEVER: Cycles = Cycles::MAX;
