// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The record of one run.

use crate::error::TraceError;
use crate::event::{Event, Events};
use crate::names::Names;
use crate::signals::Signals;

/// How much a trace may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Events; one takes 24 bytes.
    pub events: usize,
    /// Sampled values over all signals; one takes 8 bytes.
    pub signal_values: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            events: 20_000_000,
            signal_values: 50_000_000,
        }
    }
}

/// Events, signals and names of one run.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    limits: Limits,
    events: Events,
    signals: Signals,
    names: Names,
}

/// How far a trace had come: what [`Trace::truncate`] goes back to.
#[derive(Clone, Debug)]
pub struct Mark {
    events: usize,
    rows: usize,
    series: usize,
    names: Names,
}

impl Trace {
    /// An empty record.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }

    /// Append an event.
    ///
    /// # Errors
    /// The limit is reached, or the event lies before the last one.
    #[inline]
    pub fn record(&mut self, event: Event) -> Result<(), TraceError> {
        self.events.push(event, self.limits.events)
    }

    /// Events that can still be appended.
    #[must_use]
    pub fn event_room(&self) -> usize {
        self.limits.events.saturating_sub(self.events.len())
    }

    /// Declare a signal; its samples start with the next row. Returns its position in a row.
    /// A name that is declared already keeps its position.
    pub fn declare_signal(&mut self, name: &str) -> usize {
        self.signals.declare(name)
    }

    /// Append one row: a value for each declared signal, in the order of declaration.
    ///
    /// # Errors
    /// The limit is reached, the row lies before the last one or has a wrong length.
    pub fn sample(&mut self, at_cycles: u64, values: &[f64]) -> Result<(), TraceError> {
        self.signals
            .sample(at_cycles, values, self.limits.signal_values)
    }

    /// The present length, to go back to later.
    #[must_use]
    pub fn mark(&self) -> Mark {
        Mark {
            events: self.events.len(),
            rows: self.signals.rows(),
            series: self.signals.len(),
            names: self.names.clone(),
        }
    }

    /// Forget what was recorded after `mark` was taken. False, and nothing is changed, when the
    /// trace is shorter than the mark.
    #[must_use]
    pub fn truncate(&mut self, mark: &Mark) -> bool {
        if self.events.len() < mark.events
            || self.signals.rows() < mark.rows
            || self.signals.len() < mark.series
        {
            return false;
        }
        self.events.truncate(mark.events);
        self.signals.truncate(mark.rows, mark.series);
        self.names.clone_from(&mark.names);
        true
    }

    /// Hand out the events and forget them with all samples: for runs too long to keep whole.
    #[must_use]
    pub fn take_events(&mut self) -> Events {
        self.signals.truncate(0, self.signals.len());
        std::mem::take(&mut self.events)
    }

    /// The events.
    #[must_use]
    pub fn events(&self) -> &Events {
        &self.events
    }

    /// The signals.
    #[must_use]
    pub fn signals(&self) -> &Signals {
        &self.signals
    }

    /// The names of subjects.
    #[must_use]
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// The names of subjects, to add to.
    pub fn names_mut(&mut self) -> &mut Names {
        &mut self.names
    }
}
