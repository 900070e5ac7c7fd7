// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! When each part of the chip wants to be served next.
//!
//! Each kind of event has one slot. Events are served in the order of (time, kind), kinds in the
//! order of their declaration: a total order, since no slot holds two events.

use crate::board::Cycles;
use crate::NEVER;

/// What can happen without the processor's doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EventKind {
    Board,
    Clocks,
    Watchdog,
    RealTimeTimer,
    IntervalTimer,
    Timer0,
    Timer1,
    Timer2,
    TwoWire,
    Serial,
    Converter,
    Sound,
    Characters,
    Periods,
    Usb,
    Flash,
    Wake,
}

impl EventKind {
    pub(crate) const ALL: [Self; 17] = [
        Self::Board,
        Self::Clocks,
        Self::Watchdog,
        Self::RealTimeTimer,
        Self::IntervalTimer,
        Self::Timer0,
        Self::Timer1,
        Self::Timer2,
        Self::TwoWire,
        Self::Serial,
        Self::Converter,
        Self::Sound,
        Self::Characters,
        Self::Periods,
        Self::Usb,
        Self::Flash,
        Self::Wake,
    ];
    pub(crate) const TIMERS: [Self; 3] = [Self::Timer0, Self::Timer1, Self::Timer2];
}

/// The pending events and the time of the first.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    earliest: Cycles,
    due: [Cycles; EventKind::ALL.len()],
}

impl Schedule {
    pub(crate) fn new() -> Self {
        Self {
            earliest: NEVER,
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
        let before = *slot;
        if at == before {
            return;
        }
        *slot = at;
        if at <= self.earliest {
            self.earliest = at;
        } else if before == self.earliest {
            self.earliest = self.due.iter().copied().min().unwrap_or(NEVER);
        }
    }

    /// The first event: its kind and time.
    #[inline]
    pub(crate) fn first(&self) -> (EventKind, Cycles) {
        let at = self.earliest;
        let first = self.due.iter().position(|due| *due == at);
        let kind = first.and_then(|index| EventKind::ALL.get(index));
        (kind.copied().unwrap_or(EventKind::Board), at)
    }
}
