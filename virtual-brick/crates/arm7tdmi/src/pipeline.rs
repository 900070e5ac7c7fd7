// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The three-stage pipeline as software sees it: two opcodes fetched ahead of the one executed.

use crate::bus::Cycle;

/// The pipeline must be filled from r15 before the next instruction.
pub(crate) const REFILL: u8 = 1 << 0;
/// The opcode to be executed next was aborted when it was fetched.
pub(crate) const EXECUTE_ABORTED: u8 = 1 << 1;
/// The opcode after it was aborted when it was fetched.
pub(crate) const DECODE_ABORTED: u8 = 1 << 2;
/// The next boundary uses the interrupt masks from before an MSR.
pub(crate) const MASKS_DELAYED: u8 = 1 << 3;

/// Opcodes in the decode and fetch stages, and what the next boundary has to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pipeline {
    /// The opcode executed next and the one after it.
    pub(crate) opcodes: [u32; 2],
    /// Kind of the fetch that starts the next instruction.
    pub(crate) next_fetch: Cycle,
    /// Set of the constants above; zero on the usual path.
    pub(crate) attention: u8,
    /// Status register whose masks count while `MASKS_DELAYED` is set; otherwise zero.
    pub(crate) delayed_masks: u32,
}

impl Pipeline {
    pub(crate) const fn empty() -> Self {
        Self {
            opcodes: [0; 2],
            next_fetch: Cycle::Sequential,
            attention: REFILL,
            delayed_masks: 0,
        }
    }
}
