// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Inputs wait for their instant; equal instants keep the order of scheduling.

use std::collections::BTreeMap;
use std::fmt;

/// A change of an input from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Name, for example `touch.1`.
    pub name: String,
    /// New value, in the unit of the input.
    pub value: f64,
}

/// An input that was refused.
#[derive(Clone, Debug, PartialEq)]
pub enum InputError {
    /// The brick has no such input, or the input does not take this value.
    Refused(nxt::InputError),
    /// The instant has passed.
    InPast {
        /// Name given.
        name: String,
        /// Instant wanted.
        at_cycles: u64,
        /// The present.
        now_cycles: u64,
    },
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(error) => error.fmt(f),
            Self::InPast {
                name,
                at_cycles,
                now_cycles,
            } => {
                write!(
                    f,
                    "input {name}: cycle {at_cycles} has passed, it is cycle {now_cycles}"
                )
            }
        }
    }
}

impl std::error::Error for InputError {}

/// Inputs in the order of their instants.
#[derive(Clone, Debug, Default)]
pub(crate) struct InputSchedule {
    waiting: BTreeMap<(u64, u64), Input>,
    scheduled: u64,
}

impl InputSchedule {
    pub(crate) fn add(&mut self, at_cycles: u64, input: Input) {
        self.waiting.insert((at_cycles, self.scheduled), input);
        self.scheduled += 1;
    }

    /// Instant of the next input; the end of time when none waits.
    pub(crate) fn next_cycles(&self) -> u64 {
        self.waiting
            .first_key_value()
            .map_or(u64::MAX, |((at_cycles, _), _)| *at_cycles)
    }

    /// Whether a change of this input waits.
    pub(crate) fn waits(&self, name: &str) -> bool {
        self.waiting.values().any(|input| input.name == name)
    }

    /// Take the next input due at `now`.
    pub(crate) fn take_due(&mut self, now: u64) -> Option<Input> {
        if self.next_cycles() > now {
            return None;
        }
        self.waiting.pop_first().map(|(_, input)| input)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(value: f64) -> Input {
        Input {
            name: "touch.1".to_owned(),
            value,
        }
    }

    #[test]
    fn inputs_come_by_instant_then_by_order_of_scheduling() {
        let mut schedule = InputSchedule::default();
        schedule.add(20, input(3.0));
        schedule.add(10, input(1.0));
        schedule.add(10, input(2.0));
        assert_eq!(schedule.next_cycles(), 10);
        assert_eq!(schedule.take_due(9), None);
        assert!(schedule.waits("touch.1") && !schedule.waits("touch.2"));
        let taken: Vec<f64> = std::iter::from_fn(|| schedule.take_due(20))
            .map(|input| input.value)
            .collect();
        assert_eq!(taken, [1.0, 2.0, 3.0]);
        assert_eq!(schedule.next_cycles(), u64::MAX);
    }
}
