// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The three channels together, and the registers of the block.

use super::{Channel, CHANNELS_LAST, CHANNEL_BYTES, PINS};
use crate::clock::Cycles;
use crate::fault::{no_register, Access};
use crate::pins::pio::PeripheralLines;
use crate::registers::registers;

registers! { TC_BCR = 0xC0, TC_BMR = 0xC4 }

/// The three channels and the block registers.
#[derive(Clone, Debug)]
pub(crate) struct TimerBlock {
    pub(crate) channels: [Channel; 3],
    block_mode: u32,
}

impl TimerBlock {
    pub(crate) fn new() -> Self {
        Self {
            channels: [Channel::new(0), Channel::new(1), Channel::new(2)],
            block_mode: 0,
        }
    }

    /// Levels that the channels drive.
    pub(crate) fn lines(&self) -> PeripheralLines {
        let mut lines = PeripheralLines::default();
        for (channel, (pin_a, pin_b)) in self.channels.iter().zip(PINS) {
            let (out_a, out_b) = channel.output_lines();
            for (pin, level) in [(pin_a, out_a), (pin_b, out_b)] {
                if let Some(level) = level {
                    lines.driven |= 1 << pin;
                    lines.level |= u32::from(level) << pin;
                }
            }
        }
        lines
    }

    /// What a read of the registers that programs poll gives, if it changes nothing, before a
    /// channel wants to be served; and whether it gives that until then.
    pub(crate) fn polled(&self, offset: u32, now: Cycles) -> Option<(u32, bool)> {
        let channel = self.channels.get((offset / CHANNEL_BYTES) as usize)?;
        channel.polled(offset % CHANNEL_BYTES, now)
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        match offset {
            0..=CHANNELS_LAST => {
                self.channels[(offset / CHANNEL_BYTES) as usize].read(offset % CHANNEL_BYTES, now)
            }
            TC_BCR => Ok(0),
            TC_BMR => Ok(self.block_mode),
            _ => no_register("TC", offset),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access {
        match offset {
            0..=CHANNELS_LAST => {
                return self.channels[(offset / CHANNEL_BYTES) as usize].write(
                    offset % CHANNEL_BYTES,
                    value,
                    now,
                )
            }
            TC_BCR => {
                if value & 1 != 0 {
                    for channel in &mut self.channels {
                        channel.advance(now);
                        channel.trigger(now, false);
                    }
                }
            }
            TC_BMR => self.block_mode = value & 0x3F,
            _ => return no_register("TC", offset),
        }
        Ok(())
    }
}
