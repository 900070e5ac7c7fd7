// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Named costs of the memory system and the interrupt path.
//!
//! Sources: ARM7TDMI data sheet (DDI 0029E) chapter 6; AT91SAM7S datasheet, 6175M, chapters 19
//! (embedded flash controller) and 23.7.2 (interrupt latencies). Values that neither document
//! fixes are the fields that differ between the optimistic and the pessimistic profile.

use crate::clock::Cycles;
use crate::errata::Errata;

/// Cost of one flash access as a function of the wait states in `MC_FMR`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashCost {
    /// Cycles with no wait state.
    pub base_cycles: Cycles,
    /// Cycles added for each wait state.
    pub per_wait_state_cycles: Cycles,
}

impl FlashCost {
    pub(crate) const fn cycles(self, wait_states: Cycles) -> Cycles {
        self.base_cycles + self.per_wait_state_cycles * wait_states
    }
}

/// After what the flash's code buffer is empty, so that the next fetch costs as one after a branch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CodeBufferLoss {
    /// A branch only.
    #[default]
    Branch,
    /// A data read from flash too.
    FlashData,
    /// Any cycle in which the bus does something else than the next fetch: data accesses, internal
    /// cycles.
    Gap,
}

/// When the two-wire interface looks whether a write goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TwiStopDecision {
    /// When a byte was acknowledged.
    #[default]
    Acknowledge,
    /// When the slave has let SCL go after that.
    Release,
}

/// Costs in master clock cycles of what the processor and the interrupt path do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimingProfile {
    /// One access to SRAM.
    pub sram_cycles: Cycles,
    /// First opcode fetch from flash after a branch.
    pub flash_first: FlashCost,
    /// ARM opcode fetch from flash at the address after the previous fetch.
    pub flash_sequential_arm: FlashCost,
    /// Thumb opcode fetch from flash at the address after the previous fetch, up to one wait
    /// state. With two or three wait states each fetch at a word boundary costs `flash_first`.
    pub flash_sequential_thumb: FlashCost,
    /// Data read from flash.
    pub flash_data: FlashCost,
    /// Added to the fetch after a Thumb branch to the upper half of a word in flash.
    pub thumb_odd_target_cycles: Cycles,
    /// What else than a branch empties the flash's code buffer.
    pub code_buffer_loss: CodeBufferLoss,
    /// One access to a peripheral register.
    pub apb_cycles: Cycles,
    /// From an active internal level source to nIRQ.
    pub aic_level_cycles: Cycles,
    /// From an edge of an internal source to nIRQ.
    pub aic_edge_cycles: Cycles,
    /// From nIRQ to the first instruction boundary at which the core sees it.
    pub core_sync_cycles: Cycles,
    /// Taken from the processor by one transfer of the peripheral data controller.
    pub pdc_steal_cycles: Cycles,
    /// From a pin change to the PIO controller's interrupt line.
    pub pio_input_cycles: Cycles,
    /// Added on pins whose glitch filter is on.
    pub pio_filter_cycles: Cycles,
    /// When the two-wire interface looks whether a write goes on.
    pub twi_stop_decision: TwiStopDecision,
}

impl TimingProfile {
    /// Expected values.
    pub const fn nominal() -> Self {
        Self {
            sram_cycles: 1,
            flash_first: FlashCost {
                base_cycles: 1,
                per_wait_state_cycles: 1,
            },
            flash_sequential_arm: FlashCost {
                base_cycles: 1,
                per_wait_state_cycles: 1,
            },
            flash_sequential_thumb: FlashCost {
                base_cycles: 1,
                per_wait_state_cycles: 0,
            },
            flash_data: FlashCost {
                base_cycles: 1,
                per_wait_state_cycles: 1,
            },
            thumb_odd_target_cycles: 0,
            code_buffer_loss: CodeBufferLoss::Branch,
            apb_cycles: 2,
            aic_level_cycles: 3,
            aic_edge_cycles: 4,
            core_sync_cycles: 3,
            pdc_steal_cycles: 1,
            pio_input_cycles: 1,
            pio_filter_cycles: 1,
            twi_stop_decision: TwiStopDecision::Acknowledge,
        }
    }

    /// Every doubtful value at its lowest.
    pub const fn optimistic() -> Self {
        Self {
            core_sync_cycles: 2,
            pio_input_cycles: 0,
            twi_stop_decision: TwiStopDecision::Release,
            ..Self::nominal()
        }
    }

    /// Every doubtful value at its highest that programs known to work allow: NBC's firmware needs
    /// `aic_edge_cycles` and `core_sync_cycles` of at most 7 together.
    pub const fn pessimistic() -> Self {
        Self {
            thumb_odd_target_cycles: 1,
            code_buffer_loss: CodeBufferLoss::Gap,
            apb_cycles: 3,
            aic_level_cycles: 4,
            pdc_steal_cycles: 4,
            pio_input_cycles: 2,
            ..Self::nominal()
        }
    }
}

impl Default for TimingProfile {
    fn default() -> Self {
        Self::nominal()
    }
}

/// What can be chosen about a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChipConfiguration {
    /// Costs of accesses and interrupts.
    pub timing: TimingProfile,
    /// Faults of the silicon.
    pub errata: Errata,
    /// `DBGU_CIDR`: the part number that software reads.
    pub chip_identifier: u32,
}

impl Default for ChipConfiguration {
    fn default() -> Self {
        Self {
            timing: TimingProfile::nominal(),
            errata: Errata::default(),
            chip_identifier: 0x270B_0941,
        }
    }
}
