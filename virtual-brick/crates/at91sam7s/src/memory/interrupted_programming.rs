// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A flash page whose programming was interrupted.
//!
//! The first half of the time erases, the second half programs (chosen; without erasing all of it
//! programs). When it is interrupted, some cells have been reached, the later the more; a generator
//! seeded with the cycle and the page chooses them, so that a run stays a function of its inputs.

use crate::clock::Cycles;

/// Words of a flash page.
pub(crate) const PAGE_WORDS: usize = 64;
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
    pub(crate) fn interrupt(&self, page: &mut [u32], now: Cycles, end: Cycles) {
        let elapsed = (now - self.since) * STEPS / (end - self.since);
        let (erased, programmed) = if self.erases {
            (2 * elapsed, (2 * elapsed).saturating_sub(STEPS))
        } else {
            (0, elapsed)
        };
        let mut random = RandomBits(now ^ u64::from(self.page) << 48);
        for (word, before) in page.iter_mut().zip(self.before) {
            let start = before | random.bits(erased);
            *word = start & (*word | !random.bits(programmed));
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct RandomBits(u64);

impl RandomBits {
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
