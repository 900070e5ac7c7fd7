// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A flash page whose programming was cut short.
//!
//! The first half of the time erases, the second half programs (chosen; without erasing all of it
//! programs). At the cut each cell has been reached or not, the later the more of them; which ones
//! is drawn from the cycle of the cut and the page, so that a run stays a function of its inputs.

use crate::board::Cycles;
use crate::flash::PAGE_WORDS;

/// Steps of the share of cells that were reached.
const STEPS: u64 = 1 << 16;

/// A page that is being programmed.
#[derive(Clone, Debug)]
pub(crate) struct Programming {
    pub(crate) page: u32,
    /// Its words before.
    pub(crate) before: [u32; PAGE_WORDS],
    pub(crate) since: Cycles,
    pub(crate) erases: bool,
}

impl Programming {
    /// Bring the finished `page` back to what it is at `now`, when it would be finished at `end`.
    pub(crate) fn tear(&self, page: &mut [u32], now: Cycles, end: Cycles) {
        let gone = (now - self.since) * STEPS / (end - self.since);
        let (erased, programmed) = if self.erases {
            (2 * gone, (2 * gone).saturating_sub(STEPS))
        } else {
            (0, gone)
        };
        let mut chance = Chance(now ^ u64::from(self.page) << 48);
        for (word, before) in page.iter_mut().zip(self.before) {
            let start = before | chance.bits(erased);
            *word = start & (*word | !chance.bits(programmed));
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    /// A word in which each bit is set with the probability `share` of [`STEPS`].
    fn bits(&mut self, share: u64) -> u32 {
        (0..32).fold(0, |word, bit| {
            word | u32::from(self.next() % STEPS < share) << bit
        })
    }
}
