// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The parameters of [`Timing`] by name: meaning, allowed values, and what fixes the nominal one.

use std::fmt;

use at91sam7s::{CodeBufferLoss, TwiStopDecision};
use serde_json::Value;

use super::timing::Timing;

/// A parameter.
#[derive(Clone, Copy, Debug)]
pub struct TimingParameter {
    /// Its name in the configuration.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Document or program that fixes the nominal value and its limits.
    pub source: &'static str,
    /// What it may be.
    pub values: Values,
}

/// What a parameter may be, and where it stands.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// A number of master clock cycles.
    Cycles {
        /// Limits.
        limits: (u64, u64),
        /// The value.
        get: fn(&Timing) -> u64,
        /// Change it.
        set: fn(&mut Timing, u64),
    },
    /// One of these words.
    Choice {
        /// The words.
        words: &'static [&'static str],
        /// Index of the word.
        get: fn(&Timing) -> usize,
        /// Change it.
        set: fn(&mut Timing, usize),
    },
    /// Yes or no.
    Switch {
        /// The value.
        get: fn(&Timing) -> bool,
        /// Change it.
        set: fn(&mut Timing, bool),
    },
}

impl Values {
    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, timing: &Timing) -> Value {
        match self {
            Self::Cycles { get, .. } => get(timing).into(),
            Self::Choice { words, get, .. } => words[get(timing)].into(),
            Self::Switch { get, .. } => get(timing).into(),
        }
    }

    /// Whether the parameter takes this value; then it has it.
    pub(super) fn set(&self, timing: &mut Timing, value: &Value) -> bool {
        match self {
            Self::Cycles {
                limits: (lowest, highest),
                set,
                ..
            } => {
                let cycles = value.as_u64().filter(|v| (*lowest..=*highest).contains(v));
                cycles.map(|cycles| set(timing, cycles)).is_some()
            }
            Self::Choice { words, set, .. } => {
                let index = words.iter().position(|word| value == word);
                index.map(|index| set(timing, index)).is_some()
            }
            Self::Switch { set, .. } => value.as_bool().map(|on| set(timing, on)).is_some(),
        }
    }
}

impl fmt::Display for Values {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cycles {
                limits: (lowest, highest),
                ..
            } => write!(formatter, "{lowest} to {highest} cycles"),
            Self::Choice { words, .. } => write!(formatter, "one of {}", words.join(", ")),
            Self::Switch { .. } => formatter.write_str("true or false"),
        }
    }
}

/// No doubtful value of core and chip is as large.
const FEW: (u64, u64) = (0, 16);
/// 100 us: more than a co-processor can need that answers within a millisecond.
const LONG: (u64, u64) = (0, 4_806);

macro_rules! cycles {
    ($name:literal, $limits:expr, $($field:ident).+, $meaning:literal, $source:literal) => {
        TimingParameter {
            name: $name,
            meaning: $meaning,
            source: $source,
            values: Values::Cycles {
                limits: $limits,
                get: |timing| timing.$($field).+ as u64,
                set: |timing, cycles| timing.$($field).+ = cycles as _,
            },
        }
    };
}

/// All parameters.
pub const TIMING_PARAMETERS: &[TimingParameter] = &[
    cycles!(
        "flash_first_wait_cycles",
        FEW,
        chip.flash_first.per_wait_state_cycles,
        "first fetch after a branch, per wait state",
        "SAM7S 6175M, embedded flash controller: a read takes FWS + 1 cycles"
    ),
    cycles!(
        "flash_sequential_arm_wait_cycles",
        FEW,
        chip.flash_sequential_arm.per_wait_state_cycles,
        "following ARM fetch, per wait state",
        "published scores of ChibiOS/RT 2.4 on SAM7X from flash: with 0 it is 38 to 159 % too \
            fast, with 1 within 12 %"
    ),
    cycles!(
        "flash_sequential_thumb_wait_cycles",
        FEW,
        chip.flash_sequential_thumb.per_wait_state_cycles,
        "following Thumb fetch, per wait state",
        "SAM7S 6175M: one 32-bit read feeds two halfwords, a second buffer reads ahead"
    ),
    cycles!(
        "flash_data_wait_cycles",
        FEW,
        chip.flash_data.per_wait_state_cycles,
        "data read from flash, per wait state",
        "SAM7S 6175M: a read takes FWS + 1 cycles"
    ),
    cycles!(
        "thumb_odd_target_cycles",
        FEW,
        chip.thumb_odd_target_cycles,
        "fetch after a Thumb branch to an upper halfword in flash",
        "no document; a read ahead may not be ready"
    ),
    cycles!(
        "apb_cycles",
        (1, 16),
        chip.apb_cycles,
        "access to a peripheral register",
        "SAM7S 6175M, timing of PIO outputs: an access of two cycles; 3 if the bridge waits once"
    ),
    cycles!(
        "aic_level_cycles",
        FEW,
        chip.aic_level_cycles,
        "delay from the level of an internal source to nIRQ",
        "SAM7S 6175M, 23.7.2: at most 3.5 cycles, of which the half is the phase of a source \
            that does not run on the master clock"
    ),
    cycles!(
        "aic_edge_cycles",
        FEW,
        chip.aic_edge_cycles,
        "delay from the edge of an internal source to nIRQ",
        "SAM7S 6175M, 23.7.2: at most 4.5 cycles; NBC's firmware 1.28 and 1.32, which works on \
            real bricks, repeats its first byte if this and `core_sync_cycles` exceed 7 together"
    ),
    cycles!(
        "core_sync_cycles",
        FEW,
        chip.core_sync_cycles,
        "delay from nIRQ to the instruction boundary at which the core recognises it",
        "ARM DDI 0210C: at least 3; DDI 0029E: at least 2, as measured on another ARM7TDMI; only \
            its sum with the AIC's delay is seen, see `aic_edge_cycles`"
    ),
    cycles!(
        "pdc_steal_cycles",
        FEW,
        chip.pdc_steal_cycles,
        "taken by one transfer of the peripheral data controller",
        "no document: at least the access to memory"
    ),
    cycles!(
        "pio_input_cycles",
        FEW,
        chip.pio_input_cycles,
        "delay from a pin change to the interrupt line of the PIO controller",
        "SAM7S 6175M, PIO: resynchronised with the master clock"
    ),
    cycles!(
        "pio_filter_cycles",
        FEW,
        chip.pio_filter_cycles,
        "additional delay of the glitch filter",
        "SAM7S 6175M, PIO: a pulse of half a cycle is refused, of one cycle accepted"
    ),
    cycles!(
        "undefined_internal_cycles",
        FEW,
        core.undefined_internal_cycles,
        "internal cycles of an undefined instruction",
        "ARM DDI 0029E, 10.17: 2S + I + N"
    ),
    TimingParameter {
        name: "mask_change_delayed",
        meaning: "new interrupt masks of an MSR take effect one instruction boundary later",
        source: "measured on another ARM7TDMI: the masks are latched when the next instruction \
            is decoded",
        values: Values::Switch {
            get: |timing| timing.core.mask_change_delayed,
            set: |timing, on| timing.core.mask_change_delayed = on,
        },
    },
    TimingParameter {
        name: "code_buffer_loss",
        meaning: "events that empty the flash's code buffer, so that the next fetch costs as \
            much as a first fetch: `branch` only a branch, `flash_data` also a data read from \
            flash, `gap` also any data access or internal cycle between two fetches",
        source: "no document",
        values: Values::Choice {
            words: &["branch", "flash_data", "gap"],
            get: |timing| timing.chip.code_buffer_loss as usize,
            set: |timing, index| {
                use CodeBufferLoss::{Branch, FlashData, Gap};
                timing.chip.code_buffer_loss = [Branch, FlashData, Gap][index];
            },
        },
    },
    TimingParameter {
        name: "twi_stop_decision",
        meaning: "when the two-wire interface ends a write because nothing is in THR: at the \
            `acknowledge` of a byte, or at the `release` of SCL by the slave after it",
        source: "no document; of the programs under `coprocessor_stretch_cycles`, held for 30 us, \
            all send only good frames with `release`, and 14 with `acknowledge`",
        values: Values::Choice {
            words: &["acknowledge", "release"],
            get: |timing| timing.chip.twi_stop_decision as usize,
            set: |timing, index| {
                use TwiStopDecision::{Acknowledge, Release};
                timing.chip.twi_stop_decision = [Acknowledge, Release][index];
            },
        },
    },
    cycles!(
        "coprocessor_stretch_cycles",
        LONG,
        coprocessor.stretch_cycles,
        "how long the co-processor holds SCL after each byte",
        "16 programs built with GNAT GPL 2011 that drove real bricks: from 18 us on 9 of 10 of \
         their frames arrive whole, below that fewer; leJOS and LEGO 1.29 read within a \
         millisecond: 48 us at most; LEGO's source built with avr-gcc -Os holds 9 us, with which \
         7 of the programs lose frames"
    ),
    cycles!(
        "coprocessor_status_copy_cycles",
        LONG,
        coprocessor.status_copy_cycles,
        "added after its address for a read, while it copies the status",
        "LEGO's source of the co-processor, built with avr-gcc -Os (-O1 16 us)"
    ),
    cycles!(
        "coprocessor_good_frame_cycles",
        LONG,
        coprocessor.good_frame_cycles,
        "added after the last byte of a frame with the right sum",
        "the same (-O1 20 us)"
    ),
    cycles!(
        "coprocessor_bad_frame_cycles",
        LONG,
        coprocessor.bad_frame_cycles,
        "added after the last byte of a frame with a wrong sum",
        "the same (-O1 10 us)"
    ),
    cycles!(
        "coprocessor_pass_cycles",
        (480, 4_806),
        coprocessor.pass_cycles,
        "one pass of the co-processor's main loop, at whose end a command is in force",
        "the same source in a simulator of the ATmega48: 34 to 45 us"
    ),
];
