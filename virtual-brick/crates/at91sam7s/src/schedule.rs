// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Time at which each part of the chip has to be served next.
//!
//! Each kind of event has one slot. Events are served in the order of (time, kind), kinds in the
//! order of their declaration: a total order, since no slot holds two events.

use crate::clock::{Cycles, NEVER};

/// Kind of an event that the processor does not cause; named after the peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EventKind {
    Board,
    Pmc,
    Wdt,
    Rtt,
    Pit,
    Tc0,
    Tc1,
    Tc2,
    Twi,
    Spi,
    Adc,
    Ssc,
    Usart,
    Pwmc,
    Udp,
    Flash,
    Wake,
}

impl EventKind {
    pub(crate) const ALL: [Self; 17] = [
        Self::Board,
        Self::Pmc,
        Self::Wdt,
        Self::Rtt,
        Self::Pit,
        Self::Tc0,
        Self::Tc1,
        Self::Tc2,
        Self::Twi,
        Self::Spi,
        Self::Adc,
        Self::Ssc,
        Self::Usart,
        Self::Pwmc,
        Self::Udp,
        Self::Flash,
        Self::Wake,
    ];
    pub(crate) const TIMERS: [Self; 3] = [Self::Tc0, Self::Tc1, Self::Tc2];
}

/// The pending events, and the first of them.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    earliest: Cycles,
    /// Kind of the first event; any while none is pending.
    first: EventKind,
    /// Bit n: the event of kind n is pending.
    pending: u32,
    due: [Cycles; EventKind::ALL.len()],
}

impl Schedule {
    pub(crate) fn new() -> Self {
        Self {
            earliest: NEVER,
            first: EventKind::Board,
            pending: 0,
            due: [NEVER; EventKind::ALL.len()],
        }
    }

    /// Time of the first event.
    #[inline(always)]
    pub(crate) fn earliest(&self) -> Cycles {
        self.earliest
    }

    /// Let the event of this kind happen at `at` ([`NEVER`] to cancel it).
    #[inline]
    pub(crate) fn set(&mut self, kind: EventKind, at: Cycles) {
        let slot = &mut self.due[kind as usize];
        if at == *slot {
            return;
        }
        *slot = at;
        let bit = 1 << kind as u32;
        if at == NEVER {
            self.pending &= !bit;
        } else {
            self.pending |= bit;
        }
        if (at, kind) < (self.earliest, self.first) {
            (self.earliest, self.first) = (at, kind);
        } else if kind == self.first {
            self.find_first();
        }
    }

    /// Of two events at one time the kind declared first is the first.
    #[inline]
    fn find_first(&mut self) {
        (self.earliest, self.first) = (NEVER, EventKind::Board);
        let mut left = self.pending;
        while left != 0 {
            let number = left.trailing_zeros() as usize;
            left &= left - 1;
            if let (Some(&at), Some(&kind)) = (self.due.get(number), EventKind::ALL.get(number)) {
                if at < self.earliest {
                    (self.earliest, self.first) = (at, kind);
                }
            }
        }
    }

    /// The first event: its kind and time.
    #[inline]
    pub(crate) fn first(&self) -> (EventKind, Cycles) {
        (self.first, self.earliest)
    }
}
