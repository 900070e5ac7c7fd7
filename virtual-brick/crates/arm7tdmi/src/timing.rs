// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Behaviour at the clock level on which the manuals leave a choice.

/// Named choices of the core's timing; the default follows the ARM7TDMI data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimingProfile {
    /// Internal cycles of an undefined instruction between its fetch cycle and the vector
    /// fetches. 1 gives the 2S + I + N = 4 cycles of DDI 0029E, section 10.17.
    pub undefined_internal_cycles: u32,
    /// MSR changes I and F at the end of its only cycle, when the core has decided already
    /// whether an interrupt follows. True: the boundary right after an MSR uses the masks from
    /// before it, so an interrupt enabled by MSR waits one more instruction, and one that was
    /// pending while MSR disabled it is still taken.
    pub mask_change_delayed: bool,
}

impl TimingProfile {
    /// As the data sheet has it; no choice makes the core slower.
    pub const fn nominal() -> Self {
        Self {
            undefined_internal_cycles: 1,
            mask_change_delayed: true,
        }
    }

    /// Each choice at its quickest.
    pub const fn optimistic() -> Self {
        Self {
            undefined_internal_cycles: 0,
            mask_change_delayed: false,
        }
    }
}

impl Default for TimingProfile {
    fn default() -> Self {
        Self::nominal()
    }
}
