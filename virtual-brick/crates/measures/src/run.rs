// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The record of a run, as measures read it.

use trace::{Event, EventKind, Events, Signal};

/// A clock of exactly `numerator / denominator` cycles per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    /// Cycles in `denominator` seconds.
    pub numerator: u64,
    /// Seconds.
    pub denominator: u64,
}

impl Clock {
    /// Duration of a number of cycles in s; exact to the last bit below 2^50 cycles.
    #[must_use]
    pub fn seconds(self, cycles: u64) -> f64 {
        (u128::from(cycles) * u128::from(self.denominator)) as f64 / self.numerator as f64
    }

    /// Instants of samples in s.
    #[must_use]
    pub fn instants(self, cycles: &[u64]) -> Vec<f64> {
        let hertz = self.numerator as f64 / self.denominator as f64;
        cycles.iter().map(|&at| at as f64 / hertz).collect()
    }

    /// Whole cycles of a number of microseconds, rounded down.
    #[must_use]
    pub fn cycles_of_us(self, microseconds: u64) -> u64 {
        let cycles = u128::from(microseconds) * u128::from(self.numerator)
            / (1_000_000 * u128::from(self.denominator));
        cycles as u64
    }
}

/// Why and when the run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stop {
    /// `reached`, `power_off`, `fault` or `halted`.
    pub reason: String,
    /// When, in cycles.
    pub at_cycles: u64,
    /// A sentence.
    pub message: String,
}

impl Stop {
    /// The program did not fail.
    #[must_use]
    pub fn alive(&self) -> bool {
        matches!(self.reason.as_str(), "reached" | "power_off")
    }

    /// The reason in words.
    #[must_use]
    pub fn words(&self) -> String {
        self.reason.replace('_', " ")
    }
}

/// A thread of the program; its position is the subject of its events.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thread {
    /// The task's name.
    pub name: String,
    /// Larger is more urgent.
    pub base_priority: u32,
}

/// The text that the display shows from an instant on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screen {
    /// When, in cycles.
    pub at_cycles: u64,
    /// Line by line; none where the letters of the image are unknown.
    pub text: Vec<String>,
}

/// An input that was applied.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// When, in cycles.
    pub at_cycles: u64,
    /// Its name.
    pub name: String,
    /// What it became.
    pub value: f64,
}

/// One run up to its end, or up to now.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    /// The clock of all instants.
    pub clock: Clock,
    /// How it ended.
    pub stop: Stop,
    /// All events.
    pub events: &'a Events,
    /// All signals; each with its own instants.
    pub signals: Vec<Signal<'a>>,
    /// All threads.
    pub threads: &'a [Thread],
    /// What the display showed.
    pub screens: &'a [Screen],
    /// What was applied.
    pub inputs: &'a [Input],
}

impl<'a> Run<'a> {
    /// The end in s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.clock.seconds(self.stop.at_cycles)
    }

    /// The recorded names in order, joined by commas.
    #[must_use]
    pub fn signal_names(&self) -> String {
        let mut names: Vec<_> = self.signals.iter().map(|signal| signal.name).collect();
        names.sort_unstable();
        names.join(", ")
    }

    /// A signal by its name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<Signal<'a>> {
        self.signals.iter().copied().find(|s| s.name == name)
    }

    /// Instants (s) and values of a signal.
    ///
    /// # Errors
    /// It was not recorded; the sentence names those that were.
    pub fn signal(&self, name: &str) -> Result<(Vec<f64>, &'a [f64]), String> {
        let found = self.find(name).ok_or_else(|| {
            let known = self.signal_names();
            format!("the signal '{name}' was not recorded; recorded are: {known}")
        })?;
        Ok((self.clock.instants(found.at_cycles), found.values))
    }

    /// The events of one kind, in order.
    pub fn of_kind(&self, kind: EventKind) -> impl Iterator<Item = Event> + 'a {
        self.events.iter().filter(move |event| event.kind == kind)
    }
}
