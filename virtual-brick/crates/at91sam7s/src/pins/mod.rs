// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Port A: its controller, what the chip drives on it, and a log of its levels.

pub(crate) mod pin_log;
pub(crate) mod pio;

use crate::board::PinOutputs;
use crate::clock::Cycles;
use crate::timing::TimingProfile;
use pin_log::PinLog;
use pio::{PeripheralLines, Pio};

/// Peripheral identifier and interrupt source of the PIO controller.
pub(crate) const PIOA: u8 = 2;
/// Pins of the external interrupts: (pin, source).
pub(crate) const INTERRUPT_PINS: [(u32, u8); 3] = [(19, 0), (20, 30), (30, 31)];

/// These pins, one bit each.
pub(crate) const EXTERNAL_INTERRUPTS: u32 = {
    let [a, b, c] = INTERRUPT_PINS;
    1 << a.0 | 1 << b.0 | 1 << c.0
};

/// The port and what its pins were last seen to carry.
#[derive(Clone, Debug)]
pub(crate) struct Pins {
    pub(crate) pio: Pio,
    pub(crate) outputs: PinOutputs,
    /// Lines of the timers and of the serial ports at the last look.
    pub(crate) timer_lines: PeripheralLines,
    pub(crate) serial_lines: PeripheralLines,
    pub(crate) log: PinLog,
}

impl Pins {
    pub(crate) fn new() -> Self {
        Self {
            pio: Pio::new(),
            outputs: PinOutputs::default(),
            timer_lines: PeripheralLines::default(),
            serial_lines: PeripheralLines::default(),
            log: PinLog::default(),
        }
    }

    /// Cycles until the interrupt controller sees a change of the pins in `seen`.
    pub(crate) fn interrupt_delay(&self, seen: u32, timing: &TimingProfile) -> Cycles {
        if seen == 0 {
            0
        } else if self.pio.filtered(seen & self.pio.mask()) {
            timing.pio_input_cycles + timing.pio_filter_cycles
        } else {
            timing.pio_input_cycles
        }
    }
}
