// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Why a run ended.

use std::fmt;

/// Reason of a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The wanted instant is reached; the run can go on.
    Reached,
    /// The program switched the brick off.
    PowerOff,
    /// The program did what the brick cannot do, or what has no handler.
    Fault,
    /// The processor loops on one instruction with interrupts masked: nothing can happen any more.
    Halted,
    /// The trace holds as much as its limits allow.
    TraceFull,
}

impl StopReason {
    /// The name used outside.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::PowerOff => "power_off",
            Self::Fault => "fault",
            Self::Halted => "halted",
            Self::TraceFull => "trace_full",
        }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A stop: why, when, and a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stop {
    /// Why.
    pub reason: StopReason,
    /// When.
    pub at_cycles: u64,
    /// What happened, in a sentence; empty when the instant was reached.
    pub message: String,
}
