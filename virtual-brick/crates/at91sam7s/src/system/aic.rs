// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Advanced interrupt controller (AT91SAM7S datasheet, 6175M, chapter 23).
//!
//! A source that becomes active is seen by the controller after the resynchronisation delay of
//! its type (23.7.2); nIRQ goes active then, and the core sees it `core_sync` cycles later.
//! nIRQ goes inactive without delay.

use crate::clock::{Cycles, NEVER};
use crate::fault::{no_register, Access};
use crate::registers::{number_in_row, registers};
use crate::timing::TimingProfile;

registers! {
    AIC_SMR0 = 0x00, AIC_SMR31 = 0x7C, AIC_SVR0 = 0x80, AIC_SVR31 = 0xFC, AIC_IVR = 0x100,
    AIC_FVR = 0x104, AIC_ISR = 0x108, AIC_IPR = 0x10C, AIC_IMR = 0x110, AIC_CISR = 0x114,
    AIC_IECR = 0x120, AIC_IDCR = 0x124, AIC_ICCR = 0x128, AIC_ISCR = 0x12C, AIC_EOICR = 0x130,
    AIC_SPU = 0x134, AIC_DCR = 0x138, AIC_FFER = 0x140, AIC_FFDR = 0x144, AIC_FFSR = 0x148,
}

/// Sources that come from pins: FIQ, IRQ0, IRQ1.
const EXTERNAL: u32 = 1 << 0 | 1 << 30 | 1 << 31;
const PROT: u32 = 1 << 0;
const GMSK: u32 = 1 << 1;
const STACK_LEVELS: usize = 8;

/// What an access did, for the observer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Nothing,
    Entered(u8),
    Left,
}

/// One level of the hardware stack; `source` is absent for a spurious interrupt.
#[derive(Clone, Copy, Debug)]
struct Level {
    priority: i8,
    source: Option<u8>,
}

/// Registers, pending sources and the priority stack.
#[derive(Clone, Debug)]
pub(crate) struct Aic {
    mode: [u32; 32],
    vector: [u32; 32],
    mask: u32,
    lines: u32,
    latched: u32,
    /// Sources that react to an edge, and sources whose active level is low.
    edges: u32,
    inverted: u32,
    ready_at: [Cycles; 32],
    spurious_vector: u32,
    debug_control: u32,
    fast_forced: u32,
    stack: [Level; STACK_LEVELS],
    depth: usize,
    memorised: Option<Option<u8>>,
    irq_at: Cycles,
    fiq_at: Cycles,
    irq_seen_at: Cycles,
    fiq_seen_at: Cycles,
    level_cycles: Cycles,
    edge_cycles: Cycles,
    sync_cycles: Cycles,
}

impl Aic {
    pub(crate) fn new(timing: &TimingProfile) -> Self {
        Self {
            mode: [0; 32],
            vector: [0; 32],
            mask: 0,
            lines: 0,
            latched: 0,
            edges: 0,
            inverted: EXTERNAL,
            ready_at: [0; 32],
            spurious_vector: 0,
            debug_control: 0,
            fast_forced: 0,
            stack: [Level {
                priority: -1,
                source: None,
            }; STACK_LEVELS],
            depth: 0,
            memorised: None,
            irq_at: NEVER,
            fiq_at: NEVER,
            irq_seen_at: NEVER,
            fiq_seen_at: NEVER,
            level_cycles: timing.aic_level_cycles,
            edge_cycles: timing.aic_edge_cycles,
            sync_cycles: timing.core_sync_cycles,
        }
    }

    /// The core sees nIRQ from this cycle on ([`NEVER`]: not asserted).
    #[inline(always)]
    pub(crate) fn irq_seen_at(&self) -> Cycles {
        self.irq_seen_at
    }

    /// The core sees nFIQ from this cycle on.
    #[inline(always)]
    pub(crate) fn fiq_seen_at(&self) -> Cycles {
        self.fiq_seen_at
    }

    /// When an interrupt wakes a stopped processor; the general mask does not prevent it.
    pub(crate) fn wake_at(&self) -> Cycles {
        self.irq_at.min(self.fiq_at)
    }

    /// The level of an interrupt source changed; the controller gets it `delay` cycles after
    /// `now`.
    #[inline]
    pub(crate) fn set_line(&mut self, source: u8, level: bool, now: Cycles, delay: Cycles) {
        let bit = 1u32 << source;
        if (self.lines & bit != 0) == level {
            return;
        }
        let before = self.active(source);
        self.lines ^= bit;
        if self.active(source) && !before {
            self.activate(source, now + delay);
        }
        self.update(now);
    }

    fn activate(&mut self, source: u8, at: Cycles) {
        let bit = 1u32 << source;
        if !self.is_edge(source) {
            self.ready_at[usize::from(source)] = at + self.level_cycles;
        } else if self.latched & bit == 0 {
            self.latched |= bit;
            self.ready_at[usize::from(source)] = at + self.edge_cycles;
        }
    }

    fn is_edge(&self, source: u8) -> bool {
        self.edges >> source & 1 != 0
    }

    /// The line is at its active level (external sources choose their polarity).
    fn active(&self, source: u8) -> bool {
        (self.lines ^ self.inverted) >> source & 1 != 0
    }

    fn pending(&self, source: u8) -> bool {
        self.all_pending() >> source & 1 != 0
    }

    /// Latched edges and active levels.
    fn all_pending(&self) -> u32 {
        let levels = self.lines ^ self.inverted;
        self.latched & self.edges | levels & !self.edges
    }

    fn current_priority(&self) -> i8 {
        if self.depth == 0 {
            -1
        } else {
            self.stack[self.depth - 1].priority
        }
    }

    fn priority(&self, source: u8) -> i8 {
        (self.mode[usize::from(source)] & 7) as i8
    }

    fn normal_sources(&self) -> u32 {
        self.mask & !1 & !self.fast_forced
    }

    fn fast_sources(&self) -> u32 {
        self.mask & (1 | self.fast_forced)
    }

    /// Highest-priority source that the controller sees at `now` above the current level.
    fn winner(&self, now: Cycles) -> Option<u8> {
        let mut best: Option<u8> = None;
        for source in bits(self.normal_sources() & self.all_pending()) {
            if self.ready_at[usize::from(source)] <= now
                && self.priority(source)
                    > best.map_or(self.current_priority(), |b| self.priority(b))
            {
                best = Some(source);
            }
        }
        best
    }

    /// Work out again when nIRQ and nFIQ are asserted.
    fn update(&mut self, now: Cycles) {
        let pending = self.all_pending();
        if (self.normal_sources() | self.fast_sources()) & pending == 0 {
            (self.irq_at, self.fiq_at) = (NEVER, NEVER);
            (self.irq_seen_at, self.fiq_seen_at) = (NEVER, NEVER);
            return;
        }
        let current = self.current_priority();
        let mut irq = NEVER;
        for source in bits(self.normal_sources() & pending) {
            if self.priority(source) > current {
                irq = irq.min(self.ready_at[usize::from(source)]);
            }
        }
        let mut fiq = NEVER;
        for source in bits(self.fast_sources() & pending) {
            fiq = fiq.min(self.ready_at[usize::from(source)]);
        }
        self.irq_at = assertion(self.irq_at, irq, now);
        self.fiq_at = assertion(self.fiq_at, fiq, now);
        let masked = self.debug_control & GMSK != 0;
        let seen = |at: Cycles| {
            if masked || at == NEVER {
                NEVER
            } else {
                at + self.sync_cycles
            }
        };
        self.irq_seen_at = seen(self.irq_at);
        self.fiq_seen_at = seen(self.fiq_at);
    }

    pub(crate) fn read(&mut self, offset: u32, now: Cycles) -> Access<(u32, Outcome)> {
        let value = match offset {
            AIC_SMR0..=AIC_SMR31 => self.mode[number_in_row(offset, AIC_SMR0)],
            AIC_SVR0..=AIC_SVR31 => self.vector[number_in_row(offset, AIC_SVR0)],
            AIC_IVR => return Ok(self.read_vector(now)),
            AIC_FVR => return Ok((self.read_fast_vector(now), Outcome::Nothing)),
            AIC_ISR => self.top_source(),
            AIC_IPR => self.pending_bits(now),
            AIC_IMR => self.mask,
            AIC_CISR => u32::from(self.fiq_at <= now) | u32::from(self.irq_at <= now) << 1,
            AIC_IECR..=AIC_EOICR => 0,
            AIC_SPU => self.spurious_vector,
            AIC_DCR => self.debug_control,
            AIC_FFER | AIC_FFDR => 0,
            AIC_FFSR => self.fast_forced,
            _ => return no_register("AIC", offset),
        };
        Ok((value, Outcome::Nothing))
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Cycles) -> Access<Outcome> {
        let mut outcome = Outcome::Nothing;
        match offset {
            AIC_SMR0..=AIC_SMR31 => self.set_mode((offset / 4) as u8, value, now),
            AIC_SVR0..=AIC_SVR31 => self.vector[number_in_row(offset, AIC_SVR0)] = value,
            AIC_IVR => {
                if self.debug_control & PROT != 0 {
                    return Ok(self.write_vector(now));
                }
            }
            AIC_FVR..=AIC_CISR => {}
            AIC_IECR => self.mask |= value,
            AIC_IDCR => self.mask &= !value,
            AIC_ICCR => self.latched &= !value,
            AIC_ISCR => self.set_by_software(value, now),
            AIC_EOICR => outcome = self.end_of_interrupt(),
            AIC_SPU => self.spurious_vector = value,
            AIC_DCR => self.debug_control = value & (PROT | GMSK),
            AIC_FFER => self.fast_forced |= value & !1,
            AIC_FFDR => self.fast_forced &= !value,
            AIC_FFSR => {}
            _ => return no_register("AIC", offset),
        }
        self.update(now);
        Ok(outcome)
    }

    /// A source that is active when it becomes edge-triggered has an edge at that instant. No
    /// document says so: nxtOSEK, which restarts on real bricks, sets the mode of its clock again
    /// while the interval timer's flag is up, and waits for that interrupt.
    fn set_mode(&mut self, source: u8, value: u32, now: Cycles) {
        let (was_edge, before) = (self.is_edge(source), self.pending(source));
        self.mode[usize::from(source)] = value & 0x67;
        let bit = 1 << source;
        self.edges = self.edges & !bit | if value & 1 << 5 != 0 { bit } else { 0 };
        let inverts = EXTERNAL & bit != 0 && value & 1 << 6 == 0;
        self.inverted = self.inverted & !bit | if inverts { bit } else { 0 };
        let edge = !was_edge && self.is_edge(source) && self.active(source);
        if edge || self.pending(source) && !before {
            self.activate(source, now);
        }
    }

    fn set_by_software(&mut self, value: u32, now: Cycles) {
        for source in bits(value & !self.latched) {
            if self.is_edge(source) {
                self.activate(source, now);
            }
        }
    }

    fn top_source(&self) -> u32 {
        let top = if self.depth == 0 {
            None
        } else {
            self.stack[self.depth - 1].source
        };
        top.map_or(0, u32::from)
    }

    fn pending_bits(&self, now: Cycles) -> u32 {
        let seen = |s: &u8| self.pending(*s) && self.ready_at[usize::from(*s)] <= now;
        (0u8..32).filter(seen).fold(0, |word, s| word | 1 << s)
    }

    fn read_vector(&mut self, now: Cycles) -> (u32, Outcome) {
        let winner = self.winner(now);
        self.memorised = Some(winner);
        let value = winner.map_or(self.spurious_vector, |s| self.vector[usize::from(s)]);
        if self.debug_control & PROT != 0 {
            return (value, Outcome::Nothing);
        }
        let outcome = self.take(now);
        (value, outcome)
    }

    fn write_vector(&mut self, now: Cycles) -> Outcome {
        if self.memorised.is_none() {
            self.memorised = Some(self.winner(now));
        }
        self.take(now)
    }

    /// Push the memorised interrupt on the stack and acknowledge it.
    fn take(&mut self, now: Cycles) -> Outcome {
        let source = self.memorised.take().flatten();
        let priority = source.map_or(self.current_priority(), |s| self.priority(s));
        if self.depth < STACK_LEVELS {
            self.stack[self.depth] = Level { priority, source };
            self.depth += 1;
        }
        if let Some(source) = source {
            self.latched &= !(1 << source);
        }
        self.irq_at = NEVER;
        self.update(now);
        source.map_or(Outcome::Nothing, Outcome::Entered)
    }

    fn end_of_interrupt(&mut self) -> Outcome {
        if self.depth == 0 {
            return Outcome::Nothing;
        }
        self.depth -= 1;
        if self.stack[self.depth].source.is_some() {
            Outcome::Left
        } else {
            Outcome::Nothing
        }
    }

    fn read_fast_vector(&mut self, now: Cycles) -> u32 {
        let seen = |s: &u8| self.pending(*s) && self.ready_at[usize::from(*s)] <= now;
        let found = bits(self.fast_sources()).find(seen);
        if found == Some(0) && self.is_edge(0) {
            self.latched &= !1;
        }
        self.fiq_at = NEVER;
        self.update(now);
        if found.is_some() {
            self.vector[0]
        } else {
            self.spurious_vector
        }
    }
}

/// A line that is asserted stays so; one that becomes asserted does so no earlier than now.
fn assertion(before: Cycles, wanted: Cycles, now: Cycles) -> Cycles {
    if wanted == NEVER {
        NEVER
    } else if before <= now {
        before
    } else {
        wanted.max(now)
    }
}

/// Numbers of the set bits, lowest first.
pub(crate) fn bits(mut word: u32) -> impl Iterator<Item = u8> {
    std::iter::from_fn(move || {
        if word == 0 {
            return None;
        }
        let number = word.trailing_zeros() as u8;
        word &= word - 1;
        Some(number)
    })
}
