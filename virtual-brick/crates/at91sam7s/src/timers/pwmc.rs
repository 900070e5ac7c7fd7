// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Pulse width modulation controller (AT91SAM7S datasheet, 6175M, chapter 34): counters, period
//! interrupts and updates at the end of a period. The PWM outputs reach no pin.
//!
//! A channel counts from 0 from the cycle in which it is enabled. Its period is CPRD clocks, or
//! twice that when centre-aligned. A new duty cycle or period given in CUPD counts from the end
//! of the running period on.

use crate::clock::{Cycles, NEVER};
use crate::fault::{clock_disabled, no_register, not_modelled, Access};
use crate::registers::registers;

registers! {
    PWM_MR = 0x00, PWM_ENA = 0x04, PWM_DIS = 0x08, PWM_SR = 0x0C, PWM_IER = 0x10,
    PWM_IDR = 0x14, PWM_IMR = 0x18, PWM_ISR = 0x1C, PWM_CMR = 0x00, PWM_CDTY = 0x04,
    PWM_CPRD = 0x08, PWM_CCNT = 0x0C, PWM_CUPD = 0x10,
}

pub(crate) const NAME: &str = "PWMC";
pub(crate) const IDENTIFIER: u8 = 10;

const CALG: u32 = 1 << 8;
const CPD: u32 = 1 << 10;
const CHANNELS: u32 = 0xF;
/// Width of duty cycle, period and counter.
const COUNT: u32 = 0xF_FFFF;

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    mode: u32,
    duty: u32,
    period: u32,
    update: Option<u32>,
    /// Begin of the running period, while enabled.
    period_began: Cycles,
    enabled: bool,
}

/// Registers and counters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pwmc {
    mode: u32,
    mask: u32,
    ended: u32,
    channels: [Channel; 4],
}

impl Pwmc {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Master clock cycles in one count of a channel; nothing when its clock is off.
    fn clock(&self, channel: &Channel) -> Option<Cycles> {
        let linear = |divider: u32, prescaler: u32| {
            (divider != 0).then(|| Cycles::from(divider) << prescaler.min(10))
        };
        match channel.mode & 0xF {
            prescaler @ 0..=10 => Some(1 << prescaler),
            11 => linear(self.mode & 0xFF, self.mode >> 8 & 0xF),
            12 => linear(self.mode >> 16 & 0xFF, self.mode >> 24 & 0xF),
            _ => None,
        }
    }

    /// Length of a period; nothing when the channel does not count.
    fn period(&self, channel: &Channel) -> Option<Cycles> {
        let counts = Cycles::from(channel.period) << u32::from(channel.mode & CALG != 0);
        let length = counts * self.clock(channel)?;
        (channel.enabled && length != 0).then_some(length)
    }

    /// Bring the counters to `now`: note the periods that have ended.
    pub(crate) fn advance(&mut self, now: Cycles) {
        for number in 0..4 {
            let mut channel = self.channels[number];
            while let Some(length) = self.period(&channel) {
                if now < channel.period_began + length {
                    break;
                }
                let periods = if channel.update.is_some() {
                    1
                } else {
                    (now - channel.period_began) / length
                };
                channel.period_began += periods * length;
                self.ended |= 1 << number;
                if let Some(value) = channel.update.take() {
                    let register = if channel.mode & CPD != 0 {
                        &mut channel.period
                    } else {
                        &mut channel.duty
                    };
                    *register = value;
                }
            }
            self.channels[number] = channel;
        }
    }

    /// End of the first period that would raise the interrupt.
    pub(crate) fn next_event(&self) -> Cycles {
        let waiting = self.mask & !self.ended;
        (0..4)
            .filter(|number| waiting >> number & 1 != 0)
            .filter_map(|number| {
                let channel = &self.channels[number];
                Some(channel.period_began + self.period(channel)?)
            })
            .min()
            .unwrap_or(NEVER)
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.ended & self.mask != 0
    }

    fn enabled(&self) -> u32 {
        let bit = |number: usize| u32::from(self.channels[number].enabled) << number;
        (0..4).map(bit).sum()
    }

    fn counter(&self, channel: &Channel, now: Cycles) -> u32 {
        match (self.clock(channel), channel.enabled) {
            (Some(clock), true) => {
                let count = ((now - channel.period_began) / clock) as u32;
                if channel.mode & CALG != 0 && count > channel.period {
                    2 * channel.period - count
                } else {
                    count
                }
            }
            _ => 0,
        }
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        self.advance(now);
        if let Some((number, register)) = channel_register(offset) {
            let channel = &self.channels[number];
            return Ok(match register {
                PWM_CMR => channel.mode,
                PWM_CDTY => channel.duty,
                PWM_CPRD => channel.period,
                PWM_CCNT => self.counter(channel, now),
                _ => 0,
            });
        }
        Ok(match offset {
            PWM_MR => self.mode,
            PWM_ENA | PWM_DIS | PWM_IER | PWM_IDR => 0,
            PWM_SR => self.enabled(),
            PWM_IMR => self.mask,
            PWM_ISR => std::mem::take(&mut self.ended),
            _ => return no_register(NAME, offset),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles, clocked: bool) -> Access {
        self.advance(now);
        if let Some((number, register)) = channel_register(offset) {
            return self.write_channel(number, register, value);
        }
        match offset {
            PWM_MR => {
                if self.enabled() != 0 && value & 0x0FFF_0FFF != self.mode {
                    return not_modelled(NAME, "another clock divider while a channel is enabled");
                }
                self.mode = value & 0x0FFF_0FFF;
            }
            PWM_ENA => return self.enable(value, now, clocked),
            PWM_DIS => self.disable(value),
            PWM_IER => self.mask |= value & CHANNELS,
            PWM_IDR => self.mask &= !value,
            PWM_SR | PWM_IMR | PWM_ISR => {}
            _ => return no_register(NAME, offset),
        }
        Ok(())
    }

    fn write_channel(&mut self, number: usize, register: u32, value: u32) -> Access {
        let channel = &mut self.channels[number];
        if channel.enabled && register == 0x08 && value & COUNT != channel.period {
            return not_modelled(NAME, "writing CPRD of an enabled channel (use CUPD)");
        }
        match register {
            PWM_CMR => {
                // Clock, alignment and polarity hold while the channel is enabled.
                let held = if channel.enabled { 0x30F } else { 0 };
                channel.mode = (channel.mode & held) | (value & 0x70F & !held);
            }
            PWM_CDTY => channel.duty = value & COUNT,
            PWM_CPRD => channel.period = value & COUNT,
            PWM_CUPD if channel.enabled => channel.update = Some(value & COUNT),
            _ => {}
        }
        Ok(())
    }

    fn enable(&mut self, value: u32, now: Cycles, clocked: bool) -> Access {
        if value & CHANNELS != 0 && !clocked {
            return clock_disabled(NAME, IDENTIFIER);
        }
        for (number, channel) in self.channels.iter_mut().enumerate() {
            if value >> number & 1 != 0 && !channel.enabled {
                channel.enabled = true;
                channel.period_began = now;
            }
        }
        Ok(())
    }

    fn disable(&mut self, value: u32) {
        for (number, channel) in self.channels.iter_mut().enumerate() {
            if value >> number & 1 != 0 {
                channel.enabled = false;
                channel.update = None;
            }
        }
    }
}

/// Channel number and register offset in the channel.
fn channel_register(offset: u32) -> Option<(usize, u32)> {
    let from_first = offset.checked_sub(0x200)?;
    let (number, register) = (from_first / 0x20, from_first % 0x20);
    (number < 4 && register <= 0x10 && register % 4 == 0).then_some((number as usize, register))
}
