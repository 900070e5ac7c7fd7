// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! How long the co-processor's program takes.
//!
//! LEGO's source of that program (one version for firmware 1.05 to 1.29) fixes which bytes need
//! extra work; how long each takes depends on a compiler that is not published. The extras are
//! those of a build with avr-gcc -Os, whose size comes nearest to the 4 KB of the chip.

use at91sam7s::board::Cycles;
use at91sam7s::{MASTER_CLOCK_HZ_DENOMINATOR, MASTER_CLOCK_HZ_NUMERATOR};

use crate::time::microseconds;

/// Frequency of the co-processor's crystal.
const CLOCK_HZ: u64 = 8_000_000;

/// Master clock cycles in `count` cycles of the co-processor, rounded down.
const fn own_cycles(count: u64) -> Cycles {
    count * MASTER_CLOCK_HZ_NUMERATOR / (MASTER_CLOCK_HZ_DENOMINATOR * CLOCK_HZ)
}

/// Times of the co-processor's program in cycles of the master clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoprocessorTiming {
    /// How long the handler of the two-wire interface holds SCL after each byte.
    pub stretch_cycles: Cycles,
    /// Added after its address for a read: it copies and sums the twelve bytes.
    pub status_copy_cycles: Cycles,
    /// Added after the ninth byte of a frame with the right sum: it sums nine bytes, copies eight.
    pub good_frame_cycles: Cycles,
    /// Added after the ninth byte of a frame with a wrong sum.
    pub bad_frame_cycles: Cycles,
    /// One pass of the main loop outside sampling.
    pub pass_cycles: Cycles,
}

impl CoprocessorTiming {
    /// With 20 us, 16 published programs that drove real bricks keep their link, 13 of them without
    /// a bad frame; 18 and 25 us cost more frames (docs/reference/timing-inference.md).
    pub const fn nominal() -> Self {
        Self {
            stretch_cycles: microseconds(20),
            status_copy_cycles: microseconds(21),
            good_frame_cycles: microseconds(27),
            bad_frame_cycles: microseconds(14),
            pass_cycles: own_cycles(314),
        }
    }

    /// The shortest hold with which all published programs keep their link while the other values
    /// are optimistic (docs/reference/timing-inference.md); avr-gcc -Os would make it 9 us.
    pub const fn optimistic() -> Self {
        Self {
            stretch_cycles: microseconds(18),
            pass_cycles: own_cycles(272),
            ..Self::nominal()
        }
    }

    /// From about 50 us on, a read does not fit in the millisecond that LEGO and leJOS give it. The
    /// published programs allow 40; two of them lose 2 of 28 frames at 48, which is no refutation.
    pub const fn pessimistic() -> Self {
        Self {
            stretch_cycles: microseconds(48),
            pass_cycles: own_cycles(360),
            ..Self::nominal()
        }
    }
}
