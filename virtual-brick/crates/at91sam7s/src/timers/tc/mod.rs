// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Timer counter channel and block (AT91SAM7S datasheet, 6175M, chapter 33).
//!
//! Phase rule: the five clocks MCK/2 to MCK/1024 are free-running dividers of the master clock
//! that started together at cycle 0, so a channel with divider d counts at multiples of d (plus
//! d/2 when CLKI inverts the clock). A trigger takes effect at the first such edge after it.
//! A compare happens when the counter steps onto the register's value. With automatic trigger
//! the counter goes to 0 in place of RC, so the period is RC clocks.

use std::ops::Range;

use crate::clock::{Cycles, NEVER};
use crate::fault::{clock_disabled, no_register, not_modelled, Access};
use crate::registers::{check_written, registers, unmodelled, Unmodelled};

pub(crate) mod block;
mod capture;
mod counting;
mod waveform;

registers! {
    TC_CCR = 0x00, TC_CMR = 0x04, TC_CV = 0x10, TC_RA = 0x14, TC_RB = 0x18, TC_RC = 0x1C,
    TC_SR = 0x20, TC_IER = 0x24, TC_IDR = 0x28, TC_IMR = 0x2C,
}

/// Bytes of a channel's registers, and the last one of all channels.
pub(crate) const CHANNEL_BYTES: u32 = 0x40;
const CHANNELS_LAST: u32 = 3 * CHANNEL_BYTES - 1;
const NAMES: [&str; 3] = ["TC0", "TC1", "TC2"];

const COVFS: u32 = 1 << 0;
const LOVRS: u32 = 1 << 1;
const CPAS: u32 = 1 << 2;
const CPBS: u32 = 1 << 3;
const CPCS: u32 = 1 << 4;
const LDRAS: u32 = 1 << 5;
const LDRBS: u32 = 1 << 6;
const ETRGS: u32 = 1 << 7;

const CLKI: u32 = 1 << 3;
/// Stop on RC compare (waveform) or RB load (capture).
const STOP: u32 = 1 << 6;
/// Disable on RC compare (waveform) or RB load (capture).
const DISABLE: u32 = 1 << 7;
const CPCTRG: u32 = 1 << 14;
const WAVE: u32 = 1 << 15;
const TOP: u32 = 0xFFFF;
/// Binary logarithms of the dividers; there is none behind the fifth.
const DIVIDER_BITS: [u32; 8] = [1, 3, 5, 7, 10, 10, 10, 10];
/// The block mode has no effect: it chooses between external clocks.
const UNMODELLED: &[Unmodelled] = &[
    unmodelled(TC_CMR, 7, "counting an external clock (TCCLKS XC0 to XC2)").above(4),
    unmodelled(TC_CMR, 3 << 4, "gating the clock by a burst signal"),
];
/// Fields of the mode register in capture mode.
const CAPTURE_FIELDS: u32 = 0x000F_C7FF;

/// Input line of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    A,
    B,
}

/// One of the three 16-bit counters.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    number: u8,
    clocked: bool,
    mode: u32,
    ra: u32,
    rb: u32,
    rc: u32,
    status: u32,
    mask: u32,
    enabled: bool,
    started: bool,
    /// Counter value, reached at the clock edge `edge`.
    value: u32,
    edge: Cycles,
    up: bool,
    trigger_at: Cycles,
    trigger_is_external: bool,
    line_a: bool,
    line_b: bool,
    output_a: bool,
    output_b: bool,
    ra_loaded: bool,
    unread_a: bool,
    unread_b: bool,
}

impl Channel {
    fn new(number: u8) -> Self {
        Self {
            number,
            clocked: false,
            mode: 0,
            ra: 0,
            rb: 0,
            rc: 0,
            status: 0,
            mask: 0,
            enabled: false,
            started: false,
            value: 0,
            edge: 0,
            up: true,
            trigger_at: NEVER,
            trigger_is_external: false,
            line_a: false,
            line_b: false,
            output_a: false,
            output_b: false,
            ra_loaded: false,
            unread_a: false,
            unread_b: false,
        }
    }

    fn name(&self) -> &'static str {
        NAMES[usize::from(self.number)]
    }

    /// Binary logarithm of the divider.
    fn divider_bits(&self) -> u32 {
        DIVIDER_BITS[(self.mode & 7) as usize]
    }

    fn divider(&self) -> Cycles {
        1 << self.divider_bits()
    }

    fn phase(&self) -> Cycles {
        if self.mode & CLKI != 0 {
            self.divider() / 2
        } else {
            0
        }
    }

    /// Last clock edge at or before `now` (before the first edge: the virtual edge at 0).
    fn edge_before(&self, now: Cycles) -> Cycles {
        let bits = self.divider_bits();
        (now.saturating_sub(self.phase()) >> bits << bits) + self.phase()
    }

    /// First clock edge after `now`.
    fn edge_after(&self, now: Cycles) -> Cycles {
        if now < self.phase() {
            self.phase()
        } else {
            self.edge_before(now) + self.divider()
        }
    }

    fn running(&self) -> bool {
        self.clocked && self.enabled && self.started
    }

    fn is_waveform(&self) -> bool {
        self.mode & WAVE != 0
    }

    fn counts_up_and_down(&self) -> bool {
        self.is_waveform() && self.mode & 1 << 13 != 0
    }

    /// RC compare ends the period.
    fn rc_is_limit(&self) -> bool {
        self.mode & CPCTRG != 0
    }

    /// It does not always count up to the top.
    fn turns(&self) -> bool {
        self.rc_is_limit() || self.counts_up_and_down()
    }

    /// Highest value in the up-and-down modes.
    fn peak(&self) -> u32 {
        if self.rc_is_limit() {
            self.rc
        } else {
            TOP
        }
    }

    fn value_at(&self, now: Cycles) -> u32 {
        if !self.running() || now < self.edge {
            return self.value;
        }
        let steps = ((now - self.edge) >> self.divider_bits()) as u32;
        if self.up {
            self.value.wrapping_add(steps) & TOP
        } else {
            self.value.wrapping_sub(steps) & TOP
        }
    }

    /// A trigger arrived; the counter follows at the next clock edge.
    fn trigger(&mut self, now: Cycles, external: bool) {
        if self.enabled {
            self.trigger_at = self.edge_after(now);
            self.trigger_is_external = external;
        }
    }

    /// Freeze the value, change something about the clock, count on from the same value.
    fn rebase(&mut self, now: Cycles, change: impl FnOnce(&mut Self)) {
        self.value = self.value_at(now);
        change(self);
        self.edge = self.edge_before(now);
        if self.trigger_at != NEVER {
            self.trigger_at = self.edge_after(now);
        }
    }

    /// The power management controller switched the channel's clock.
    pub(crate) fn set_clocked(&mut self, now: Cycles, on: bool) {
        if self.clocked != on {
            self.advance(now);
            self.rebase(now, |channel| channel.clocked = on);
        }
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.status & self.mask != 0
    }

    /// The pins of this channel changed.
    pub(crate) fn set_pins(&mut self, pins: u32, now: Cycles) {
        let (pin_a, pin_b) = PINS[usize::from(self.number)];
        self.set_line(Line::A, pins >> pin_a & 1 != 0, now);
        self.set_line(Line::B, pins >> pin_b & 1 != 0, now);
    }

    fn set_line(&mut self, line: Line, level: bool, now: Cycles) {
        self.advance(now);
        let slot = match line {
            Line::A => &mut self.line_a,
            Line::B => &mut self.line_b,
        };
        if *slot == level {
            return;
        }
        *slot = level;
        if self.is_waveform() {
            self.waveform_edge(line, level, now);
        } else {
            self.capture_edge(line, level, now);
        }
    }

    /// Lines driven as outputs: (TIOA, TIOB), each present when it is an output.
    fn output_lines(&self) -> (Option<bool>, Option<bool>) {
        if !self.is_waveform() {
            return (None, None);
        }
        let b_is_output = self.mode >> 10 & 3 != 0;
        (Some(self.output_a), b_is_output.then_some(self.output_b))
    }

    fn polled(&self, offset: u32, now: Cycles) -> Option<(u32, bool)> {
        let kept = self.status == 0 && !self.unread_a && !self.unread_b;
        match offset {
            TC_CV if !self.turns() || now < self.next_step().0 => Some((self.value_at(now), false)),
            TC_SR if kept => Some((self.status_word(), true)),
            _ => None,
        }
    }

    fn read(&mut self, offset: u32, now: Cycles) -> Access<u32> {
        self.advance(now);
        Ok(match offset {
            TC_CCR | TC_IER | TC_IDR => 0,
            TC_CMR => self.mode,
            TC_CV => self.value_at(now),
            TC_RA => {
                self.unread_a = false;
                self.ra
            }
            TC_RB => {
                self.unread_b = false;
                self.rb
            }
            TC_RC => self.rc,
            TC_SR => self.read_status(),
            TC_IMR => self.mask,
            _ => return no_register(self.name(), offset),
        })
    }

    fn status_word(&self) -> u32 {
        let (out_a, out_b) = self.output_lines();
        self.status
            | u32::from(self.enabled) << 16
            | u32::from(out_a.unwrap_or(self.line_a)) << 17
            | u32::from(out_b.unwrap_or(self.line_b)) << 18
    }

    fn read_status(&mut self) -> u32 {
        let value = self.status_word();
        self.status = 0;
        self.unread_a = false;
        self.unread_b = false;
        value
    }

    fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access {
        check_written(self.name(), UNMODELLED, offset, value)?;
        self.advance(now);
        match offset {
            TC_CCR => return self.control(value, now),
            TC_CMR => return self.set_mode(value, now),
            TC_RA if self.is_waveform() => self.set_compare(now, |c| c.ra = value & TOP),
            TC_RB if self.is_waveform() => self.set_compare(now, |c| c.rb = value & TOP),
            TC_RC => self.set_compare(now, |c| c.rc = value & TOP),
            TC_IER => self.mask |= value & 0xFF,
            TC_IDR => self.mask &= !value,
            TC_CV | TC_RA | TC_RB | TC_SR | TC_IMR => {}
            _ => return no_register(self.name(), offset),
        }
        Ok(())
    }

    /// A new compare value counts from the present counter value on.
    fn set_compare(&mut self, now: Cycles, change: impl FnOnce(&mut Self)) {
        self.rebase(now, change);
    }

    fn control(&mut self, value: u32, now: Cycles) -> Access {
        let enable = value & 1 << 0 != 0;
        let disable = value & 1 << 1 != 0;
        if enable && !disable && !self.clocked {
            return clock_disabled(self.name(), IDENTIFIERS[usize::from(self.number)]);
        }
        if (enable && !self.enabled) || disable {
            self.rebase(now, |channel| channel.enabled = !disable);
        }
        if disable {
            self.trigger_at = NEVER;
        }
        if value & 1 << 2 != 0 {
            self.trigger(now, false);
        }
        Ok(())
    }

    fn set_mode(&mut self, value: u32, now: Cycles) -> Access {
        let waveform = value & WAVE != 0;
        if waveform && value >> 10 & 3 != 0 && value >> 8 & 3 != 0 {
            return not_modelled(self.name(), "an external event on XC0 to XC2");
        }
        let fields = if waveform { u32::MAX } else { CAPTURE_FIELDS };
        self.rebase(now, |channel| channel.mode = value & fields);
        Ok(())
    }
}

/// Clock and interrupt source of each channel.
pub(crate) const IDENTIFIERS: [u8; 3] = [12, 13, 14];
/// Pins that carry TIOA and TIOB of the three channels (peripheral B).
pub(crate) const PINS: [(u32, u32); 3] = [(0, 1), (15, 16), (26, 27)];
/// All of them, one bit each.
pub(crate) const ALL_PINS: u32 = 1 << 0 | 1 << 1 | 1 << 15 | 1 << 16 | 1 << 26 | 1 << 27;

/// Numbers of the channels whose registers are at `offset`: one, or for a block register all.
pub(crate) fn channels_at(offset: u32) -> Range<usize> {
    if offset > CHANNELS_LAST {
        return 0..3;
    }
    let number = (offset / CHANNEL_BYTES) as usize;
    number..number + 1
}
