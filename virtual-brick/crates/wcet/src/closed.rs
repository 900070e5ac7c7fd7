// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Programs that nothing else disturbs: they begin with memory as the image says, no interrupt or
//! other thread writes to it, and what they read was written by themselves. Loops, recursion and
//! branches that depend on such data only need no fact; what cannot be followed is bounded for any
//! data.

use crate::annotations::Annotations;
use crate::contents::Contents;
use crate::context::Follower;
use crate::error::Error;
use crate::image::Image;
use crate::memory::MemoryMap;
use crate::program::Program;
use crate::state::{State, ENDLESS};
use crate::summary::Summary;
use crate::value::Value;
use crate::walk::any_arguments;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Stack of the analysis itself, which follows calls by calls of its own.
const STACK_BYTES: usize = 1 << 30;

/// A variable that may have any content when the last function is called.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Its name.
    pub symbol: String,
    /// Least and greatest value of each of its words.
    #[serde(default)]
    pub range: Option<(u32, u32)>,
}

/// How often a source line is executed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LineCount {
    /// File and line.
    pub line: String,
    /// Executions of its most frequent block, on all ways that were followed.
    pub executions: u64,
}

/// What was found out about the last call.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Cycles, without the fetches after its return.
    pub cycles: u64,
    /// Source lines that were executed, in order.
    pub lines: Vec<LineCount>,
}

/// Functions called one after the other.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Closed {
    /// Their names; the last one is bounded.
    pub calls: Vec<String>,
    /// Stack pointer at the calls.
    pub stack_pointer: u32,
    /// What the last one is bounded for whatever it contains.
    #[serde(default)]
    pub inputs: Vec<Input>,
}

impl Closed {
    /// Bound of the last call, and what it executes.
    pub fn bound(
        &self,
        image: &Image,
        map: &MemoryMap,
        annotations: &Annotations,
    ) -> Result<Found, Error> {
        let work = || {
            let mut program = Program::new(image, map, annotations)?;
            program.closed = true;
            self.run(&program)
        };
        std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
            let handle = thread.spawn_scoped(scope, work);
            let ended = handle.map(|handle| handle.join());
            match ended {
                Ok(Ok(result)) => result,
                _ => Err(Error::Input("no memory for following calls".into())),
            }
        })
    }

    fn run(&self, program: &Program<'_>) -> Result<Found, Error> {
        let mut memory = Contents::of_image(program.image);
        let mut cycles = ENDLESS;
        for (position, name) in self.calls.iter().enumerate() {
            let entry = program.function(name)?;
            let summary = program.summary(entry, entry.0)?;
            if position + 1 == self.calls.len() {
                program.summaries(|_, summary| summary.visits.borrow_mut().clear());
                self.forget_inputs(program, &mut memory)?;
            }
            let mut state = State::entry(&any_arguments());
            state.registers[13] = Value::Constant(self.stack_pointer);
            state.lowest = None;
            state.memory = Some(memory);
            let follower = Follower::new(program, entry, true);
            let after = follower.execute(&summary, state);
            let never = || Error::NeverReturns(program.image.place(entry.0));
            let after = after.ok_or_else(never)?;
            cycles = after.elapsed.0;
            memory = after.memory.unwrap_or_default();
        }
        if cycles == ENDLESS {
            let name = self.calls.last().map_or("", String::as_str);
            return Err(Error::Input(format!(
                "{name}: not all of its ways could be followed; bound it for any data"
            )));
        }
        let lines = executed_lines(program);
        Ok(Found { cycles, lines })
    }

    fn forget_inputs(&self, program: &Program<'_>, memory: &mut Contents) -> Result<(), Error> {
        for input in &self.inputs {
            let missing = || Error::Input(format!("the image has no variable '{}'", input.symbol));
            let (address, size) = program.image.object(&input.symbol).ok_or_else(missing)?;
            let word = input
                .range
                .map_or(Value::Top, |(low, high)| Value::range(low, high));
            for place in (address & !3..address.saturating_add(size)).step_by(4) {
                memory.store(&Value::Constant(place), 4, &word);
            }
        }
        Ok(())
    }
}

fn executed_lines(program: &Program<'_>) -> Vec<LineCount> {
    let mut counts: BTreeMap<(String, u32), u64> = BTreeMap::new();
    program.summaries(|_, summary: &Summary| {
        for (block, count) in summary
            .flow
            .blocks
            .iter()
            .zip(summary.visits.borrow().iter())
        {
            for (address, _) in block.instructions.iter().filter(|_| *count > 0) {
                if let Some(line) = program.image.place(*address).line {
                    let known = counts.entry(line).or_insert(0);
                    *known = (*known).max(*count);
                }
            }
        }
    });
    let lines = counts.into_iter();
    lines
        .map(|((file, line), executions)| LineCount {
            line: format!("{file}:{line}"),
            executions,
        })
        .collect()
}
