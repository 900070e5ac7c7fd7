// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timing that no document fixes, by profile.

use at91sam7s::{CodeBufferLoss, TimingProfile};
use nxt::CoprocessorTiming;

use crate::engine::Engine;

/// The doubtful costs of core, chip and co-processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Of the core.
    pub core: arm7tdmi::TimingProfile,
    /// Of memory, interrupt path, data controller and two-wire interface.
    pub chip: TimingProfile,
    /// Of the co-processor's program.
    pub coprocessor: CoprocessorTiming,
}

impl Default for Timing {
    fn default() -> Self {
        Self::nominal()
    }
}

impl Timing {
    /// Expected values.
    #[must_use]
    pub const fn nominal() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::nominal(),
            chip: TimingProfile::nominal(),
            coprocessor: CoprocessorTiming::nominal(),
        }
    }

    /// Every doubtful value at its lowest.
    #[must_use]
    pub const fn optimistic() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::optimistic(),
            chip: TimingProfile::optimistic(),
            coprocessor: CoprocessorTiming::optimistic(),
        }
    }

    /// Every doubtful value at its highest.
    #[must_use]
    pub const fn pessimistic() -> Self {
        Self {
            core: arm7tdmi::TimingProfile::nominal(),
            chip: TimingProfile::pessimistic(),
            coprocessor: CoprocessorTiming::pessimistic(),
        }
    }

    /// What can execute instructions under this timing: blocks know no cost that depends on what
    /// the bus did before a fetch.
    pub(super) fn engine(&self, wanted: Engine) -> Engine {
        if self.chip.code_buffer_loss == CodeBufferLoss::Branch {
            wanted
        } else {
            Engine::Reference
        }
    }
}
