// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Inputs wait for their instant; equal instants keep the order of scheduling.
//!
//! An input named `variable.<path>` or `variable.<path>:<kind>` is a variable of the program,
//! written from outside: a gain or a set-point that somebody changes while the robot runs.

use std::collections::BTreeMap;
use std::fmt;

use image::{Image, ScalarKind};

/// What the names of inputs begin with that write a variable.
const VARIABLE: &str = "variable.";

/// A change of an input from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Name, for example `touch.1`.
    pub name: String,
    /// New value, in the unit of the input.
    pub value: f64,
    /// For a variable: where it lies, and its new bytes.
    pub(crate) written: Option<(u32, Vec<u8>)>,
}

impl Input {
    /// An input; one of a variable is looked up in the image.
    pub(crate) fn new(image: &Image, name: &str, value: f64) -> Result<Self, InputError> {
        let written = match name.strip_prefix(VARIABLE) {
            Some(path) => Some(variable(image, path, value).map_err(|problem| {
                let name = name.to_owned();
                InputError::Variable { name, problem }
            })?),
            None => None,
        };
        let name = name.to_owned();
        Ok(Self {
            name,
            value,
            written,
        })
    }
}

fn variable(image: &Image, path: &str, value: f64) -> Result<(u32, Vec<u8>), String> {
    let (path, kind) = match path.split_once(':') {
        Some((path, kind)) => (path, Some(kind.parse::<ScalarKind>()?)),
        None => (path, None),
    };
    let found = image.variable(path).map_err(|error| error.to_string())?;
    let kind = kind.or(found.kind);
    let kind = kind.ok_or("its type is unknown; name it, as in variable.gain:f32")?;
    let bytes = kind.to_bytes(value);
    let bytes = bytes.ok_or_else(|| format!("{value} is no number of type {kind}"))?;
    Ok((found.address, bytes))
}

/// An input that was refused.
#[derive(Clone, Debug, PartialEq)]
pub enum InputError {
    /// The brick has no such input, or the input does not take this value.
    Refused(nxt::InputError),
    /// The program has no such variable in memory, or it cannot hold this value.
    Variable {
        /// Name given.
        name: String,
        /// What is wrong.
        problem: String,
    },
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
            Self::Variable { name, problem } => write!(f, "input {name}: {problem}"),
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
            written: None,
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
