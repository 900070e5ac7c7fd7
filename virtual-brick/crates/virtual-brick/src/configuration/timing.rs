// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timing that no document fixes: a profile and single values in its place.

use at91sam7s::{CodeBufferLoss, TimingProfile};
use nxt::STRETCH_CYCLES;
use serde::Deserialize;

use super::error::ConfigurationError;
use crate::engine::Engine;

/// No doubtful value of core and chip is as large.
const MOST_CYCLES: u64 = 16;
/// 100 us: more than a co-processor can need that answers within a millisecond.
const MOST_STRETCH_CYCLES: u64 = 4_806;

/// The doubtful costs of core, chip and co-processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Of the core.
    pub core: arm7tdmi::TimingProfile,
    /// Of memory, interrupt path and data controller.
    pub chip: TimingProfile,
    /// How long the co-processor holds SCL after a byte.
    pub coprocessor_stretch_cycles: u64,
}

impl Default for Timing {
    fn default() -> Self {
        Profile::Nominal.timing()
    }
}

impl Timing {
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

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Profile {
    #[default]
    Nominal,
    Optimistic,
    Pessimistic,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TimingFields {
    #[serde(default)]
    profile: Profile,
    flash_first_wait_cycles: Option<u64>,
    flash_sequential_arm_wait_cycles: Option<u64>,
    flash_sequential_thumb_wait_cycles: Option<u64>,
    flash_data_wait_cycles: Option<u64>,
    thumb_odd_target_cycles: Option<u64>,
    apb_cycles: Option<u64>,
    aic_level_cycles: Option<u64>,
    aic_edge_cycles: Option<u64>,
    core_sync_cycles: Option<u64>,
    pdc_steal_cycles: Option<u64>,
    pio_input_cycles: Option<u64>,
    pio_filter_cycles: Option<u64>,
    undefined_internal_cycles: Option<u64>,
    mask_change_delayed: Option<bool>,
    code_buffer_loss: Option<Loss>,
    coprocessor_stretch_cycles: Option<u64>,
}

/// What empties the flash's code buffer.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Loss {
    Branch,
    FlashData,
    Gap,
}

impl From<Loss> for CodeBufferLoss {
    fn from(loss: Loss) -> Self {
        match loss {
            Loss::Branch => Self::Branch,
            Loss::FlashData => Self::FlashData,
            Loss::Gap => Self::Gap,
        }
    }
}

impl Profile {
    const fn timing(self) -> Timing {
        use arm7tdmi::TimingProfile as CoreProfile;
        let (core, chip) = match self {
            Self::Nominal => (CoreProfile::nominal(), TimingProfile::nominal()),
            Self::Optimistic => (CoreProfile::optimistic(), TimingProfile::optimistic()),
            Self::Pessimistic => (CoreProfile::nominal(), TimingProfile::pessimistic()),
        };
        Timing {
            core,
            chip,
            coprocessor_stretch_cycles: STRETCH_CYCLES,
        }
    }
}

impl TimingFields {
    /// The profile with the values that replace its own.
    pub(super) fn check(&self) -> Result<Timing, ConfigurationError> {
        let Timing {
            mut core,
            mut chip,
            mut coprocessor_stretch_cycles,
        } = self.profile.timing();
        let mut undefined = u64::from(core.undefined_internal_cycles);
        let values = [
            ("flash_first_wait_cycles", self.flash_first_wait_cycles),
            (
                "flash_sequential_arm_wait_cycles",
                self.flash_sequential_arm_wait_cycles,
            ),
            (
                "flash_sequential_thumb_wait_cycles",
                self.flash_sequential_thumb_wait_cycles,
            ),
            ("flash_data_wait_cycles", self.flash_data_wait_cycles),
            ("thumb_odd_target_cycles", self.thumb_odd_target_cycles),
            ("apb_cycles", self.apb_cycles),
            ("aic_level_cycles", self.aic_level_cycles),
            ("aic_edge_cycles", self.aic_edge_cycles),
            ("core_sync_cycles", self.core_sync_cycles),
            ("pdc_steal_cycles", self.pdc_steal_cycles),
            ("pio_input_cycles", self.pio_input_cycles),
            ("pio_filter_cycles", self.pio_filter_cycles),
            ("undefined_internal_cycles", self.undefined_internal_cycles),
            (
                "coprocessor_stretch_cycles",
                self.coprocessor_stretch_cycles,
            ),
        ];
        let places = [
            &mut chip.flash_first.per_wait_state_cycles,
            &mut chip.flash_sequential_arm.per_wait_state_cycles,
            &mut chip.flash_sequential_thumb.per_wait_state_cycles,
            &mut chip.flash_data.per_wait_state_cycles,
            &mut chip.thumb_odd_target_cycles,
            &mut chip.apb_cycles,
            &mut chip.aic_level_cycles,
            &mut chip.aic_edge_cycles,
            &mut chip.core_sync_cycles,
            &mut chip.pdc_steal_cycles,
            &mut chip.pio_input_cycles,
            &mut chip.pio_filter_cycles,
            &mut undefined,
            &mut coprocessor_stretch_cycles,
        ];
        for ((name, value), place) in values.into_iter().zip(places) {
            let Some(value) = value else { continue };
            check_range(name, value)?;
            *place = value;
        }
        core.undefined_internal_cycles = undefined as u32;
        if let Some(delayed) = self.mask_change_delayed {
            core.mask_change_delayed = delayed;
        }
        if let Some(loss) = self.code_buffer_loss {
            chip.code_buffer_loss = loss.into();
        }
        Ok(Timing {
            core,
            chip,
            coprocessor_stretch_cycles,
        })
    }
}

fn check_range(name: &str, value: u64) -> Result<(), ConfigurationError> {
    let allowed = match name {
        "apb_cycles" => 1..=MOST_CYCLES,
        "coprocessor_stretch_cycles" => 0..=MOST_STRETCH_CYCLES,
        _ => 0..=MOST_CYCLES,
    };
    if allowed.contains(&value) {
        return Ok(());
    }
    let problem = format!("must be {} to {} cycles", allowed.start(), allowed.end());
    Err(ConfigurationError::field(
        &format!("timing.{name}"),
        problem,
    ))
}
