// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The chip's timing profiles as memory maps. The numbers are the chip crate's.

use at91sam7s::{CodeBufferLoss, TimingProfile};
use wcet::{Error, FetchCost, MemoryMap, Region};

const LOW_LAST: u32 = 0x000F_FFFF;
const FLASH: u32 = 0x0010_0000;
const FLASH_LAST: u32 = 0x0013_FFFF;
const SRAM: u32 = 0x0020_0000;
const SRAM_LAST: u32 = 0x0020_FFFF;
const PERIPHERALS: u32 = 0xF000_0000;

/// The map of a named profile with this many flash wait states; `plain` has none anywhere.
pub fn memory_map(name: &str, wait_states: u64) -> Result<MemoryMap, Error> {
    let profile = match name {
        "plain" => return Ok(MemoryMap::without_wait_states()),
        "optimistic" => TimingProfile::optimistic(),
        "nominal" => TimingProfile::nominal(),
        "pessimistic" => TimingProfile::pessimistic(),
        _ => {
            return Err(Error::Input(format!(
                "timing profile '{name}' is not known"
            )))
        }
    };
    Ok(of_profile(name, &profile, wait_states))
}

fn plain_fetch(cycles: u64) -> FetchCost {
    FetchCost {
        first_cycles: cycles,
        sequential_cycles: cycles,
        word_boundary_cycles: cycles,
        odd_target_cycles: 0,
        after_gap_cycles: cycles,
    }
}

fn of_profile(name: &str, profile: &TimingProfile, wait_states: u64) -> MemoryMap {
    let cycles =
        |cost: at91sam7s::FlashCost| cost.base_cycles + cost.per_wait_state_cycles * wait_states;
    let first_cycles = cycles(profile.flash_first);
    let arm = cycles(profile.flash_sequential_arm);
    let thumb = cycles(profile.flash_sequential_thumb);
    let keeps_code = profile.code_buffer_loss == CodeBufferLoss::Branch;
    let after_gap_cycles = if keeps_code { 0 } else { first_cycles };
    let flash_word = FetchCost {
        first_cycles,
        after_gap_cycles,
        ..plain_fetch(arm)
    };
    let flash_halfword = FetchCost {
        first_cycles,
        sequential_cycles: thumb,
        word_boundary_cycles: if wait_states > 1 { first_cycles } else { thumb },
        odd_target_cycles: if wait_states > 0 {
            profile.thumb_odd_target_cycles
        } else {
            0
        },
        after_gap_cycles,
    };
    let region = |name: &str, (start, last), fetch: Option<(FetchCost, FetchCost)>, data| Region {
        name: name.to_owned(),
        start,
        last,
        holds_pointers: start != 0,
        fetch_word: fetch.map(|(word, _)| word),
        fetch_halfword: fetch.map(|(_, halfword)| halfword),
        read_cycles: data,
        write_cycles: data,
    };
    let sram = Some((
        plain_fetch(profile.sram_cycles),
        plain_fetch(profile.sram_cycles),
    ));
    let flash = Some((flash_word, flash_halfword));
    MemoryMap {
        name: format!("{name}, {wait_states} flash wait states"),
        regions: vec![
            region("remapped sram", (0, LOW_LAST), sram, profile.sram_cycles),
            region(
                "flash",
                (FLASH, FLASH_LAST),
                flash,
                cycles(profile.flash_data),
            ),
            region("sram", (SRAM, SRAM_LAST), sram, profile.sram_cycles),
            region(
                "peripherals",
                (PERIPHERALS, u32::MAX),
                None,
                profile.apb_cycles,
            ),
        ],
        stack: "sram".into(),
    }
}
