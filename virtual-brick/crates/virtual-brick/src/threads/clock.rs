// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The run-time's clock: units of 16/7 cycles since the interval timer was enabled.

/// Cycle of the instant `units` of the run-time's clock that began at `epoch_cycles`: the first
/// cycle not before it. Ends of time that no run reaches saturate.
pub(super) fn cycle_of(epoch_cycles: u64, units: u64) -> u64 {
    let cycles = (u128::from(units) * 16).div_ceil(7) + u128::from(epoch_cycles);
    u64::try_from(cycles).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instant_between_two_cycles_belongs_to_the_later_one() {
        assert_eq!(cycle_of(100, 0), 100);
        assert_eq!(cycle_of(100, 1), 103);
        assert_eq!(cycle_of(100, 7), 116);
        assert_eq!(cycle_of(0, 21_024), 48_055);
    }

    #[test]
    fn the_end_of_time_saturates() {
        assert_eq!(cycle_of(5, u64::MAX), u64::MAX);
    }
}
