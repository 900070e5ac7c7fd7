// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What can go wrong while recording.

use std::fmt;

/// A record that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TraceError {
    /// The limit on events is reached.
    TooManyEvents {
        /// The limit.
        limit: usize,
    },
    /// The limit on sampled values (samples times signals) is reached.
    TooManySignalValues {
        /// The limit.
        limit: usize,
    },
    /// An event or sample lies before the previous one.
    OutOfOrder {
        /// Instant of the previous one.
        previous_cycles: u64,
        /// Instant of the refused one.
        at_cycles: u64,
    },
    /// A sample has not one value per declared signal.
    WrongSampleLength {
        /// Declared signals.
        expected: usize,
        /// Values given.
        given: usize,
    },
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyEvents { limit } => write!(
                f,
                "the trace holds its limit of {limit} events; raise trace_limits.events or run for \
                 a shorter time"
            ),
            Self::TooManySignalValues { limit } => write!(
                f,
                "the trace holds its limit of {limit} signal values; raise \
                 trace_limits.signal_values or signal_period_cycles, or run for a shorter time"
            ),
            Self::OutOfOrder {
                previous_cycles,
                at_cycles,
            } => write!(
                f,
                "a record at cycle {at_cycles} came after one at cycle {previous_cycles}; records \
                 must be in the order of time"
            ),
            Self::WrongSampleLength { expected, given } => {
                write!(
                    f,
                    "a sample has {given} values; {expected} signals are declared"
                )
            }
        }
    }
}

impl std::error::Error for TraceError {}
