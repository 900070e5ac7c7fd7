// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds with known memory, of programs that nothing else disturbs: they begin with memory as the
//! image says, no interrupt or other thread writes to it, and what they read was written by
//! themselves. Loops, recursion and branches that depend on such data only need no fact; what
//! cannot be executed is bounded for any data.

use crate::elapsed::UNBOUNDED;
use crate::error::Error;
use crate::functions::context_sensitive_calls::{ContextSensitiveCalls, STACK_BYTES};
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::inputs::annotations::Annotations;
use crate::inputs::image::Image;
use crate::inputs::memory_map::MemoryMap;
use crate::values::block_interpreter::any_arguments;
use crate::values::memory_contents::Contents;
use crate::values::state::State;
use crate::values::value::Value;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A variable that may have any content when the last function is called.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Its name.
    pub symbol: String,
    /// Where the input begins in it.
    #[serde(default)]
    pub offset_bytes: u32,
    /// How long it is; without, to the variable's end.
    #[serde(default)]
    pub size_bytes: Option<u32>,
    /// Size of an element: 1, 2 or 4.
    #[serde(default = "word")]
    pub element_bytes: u32,
    /// Least and greatest value of each element, without sign.
    #[serde(default)]
    pub range: Option<(u32, u32)>,
}

const fn word() -> u32 {
    4
}

impl Input {
    /// A whole variable, which may hold anything.
    pub fn any(symbol: String) -> Self {
        Self {
            symbol,
            offset_bytes: 0,
            size_bytes: None,
            element_bytes: word(),
            range: None,
        }
    }

    fn error(&self, what: &str) -> Error {
        Error::Input(format!("input '{}': {what}", self.symbol))
    }

    fn store_any(&self, image: &Image, memory: &mut Contents) -> Result<(), Error> {
        let missing = || self.error("the image has no such variable");
        let (address, size) = image.variable(&self.symbol).ok_or_else(missing)?;
        if ![1, 2, 4].contains(&self.element_bytes) {
            return Err(self.error("elements have 1, 2 or 4 bytes"));
        }
        let rest = size.checked_sub(self.offset_bytes);
        let rest = rest.ok_or_else(|| self.error("begins behind the variable's end"))?;
        let length = self.size_bytes.unwrap_or(rest);
        if length > rest {
            return Err(self.error("ends behind the variable's end"));
        }
        let (low, high) = self.range.unwrap_or((0, u32::MAX));
        if low > high {
            return Err(self.error("the least value is above the greatest"));
        }
        let first = address.saturating_add(self.offset_bytes) & !(self.element_bytes - 1);
        let end = address.saturating_add(self.offset_bytes + length);
        for place in (first..end).step_by(self.element_bytes as usize) {
            let any = Value::range(low, high);
            memory.store(&Value::Constant(place), self.element_bytes, &any);
        }
        Ok(())
    }
}

/// How often a source line is executed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LineCount {
    /// File and line.
    pub line: String,
    /// Executions of its most frequent block, on all paths that were executed.
    pub executions: u64,
}

/// What was found out about the last call.
#[derive(Clone, Debug, Default)]
pub struct KnownMemoryBound {
    /// Cycles, without the fetches after its return.
    pub cycles: u64,
    /// Source lines that were executed, in order.
    pub lines: Vec<LineCount>,
}

/// Functions called one after the other.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownMemory {
    /// Their names; the last one is bounded.
    pub calls: Vec<String>,
    /// Stack pointer at the calls.
    pub stack_pointer: u32,
    /// What the last one is bounded for whatever it contains.
    #[serde(default)]
    pub inputs: Vec<Input>,
}

impl KnownMemory {
    /// Bound of the last call, and what it executes.
    pub fn bound(
        &self,
        image: &Image,
        map: &MemoryMap,
        annotations: &Annotations,
    ) -> Result<KnownMemoryBound, Error> {
        let work = || {
            let mut program = Program::new(image, map, annotations)?;
            program.memory_known = true;
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

    fn run(&self, program: &Program<'_>) -> Result<KnownMemoryBound, Error> {
        let mut memory = Contents::of_image(program.image);
        let mut cycles = UNBOUNDED;
        for (position, name) in self.calls.iter().enumerate() {
            let entry = program.function(name)?;
            let summary = program.summary(entry, entry.0)?;
            if position + 1 == self.calls.len() {
                program.summaries(|summary| summary.visits.borrow_mut().clear());
                self.store_inputs(program, &mut memory)?;
            }
            let mut state = State::entry(&any_arguments());
            state.registers[13] = Value::Constant(self.stack_pointer);
            state.lowest_pointer = None;
            state.memory = Some(memory);
            let mut calls = ContextSensitiveCalls::new(program, entry, true);
            if position + 1 == self.calls.len() && !self.inputs.is_empty() {
                calls = calls.with_inputs();
            }
            let after = calls.execute(&summary, state);
            let never = || Error::NeverReturns(program.image.place(entry.0));
            let (after, _) = after.ok_or_else(never)?;
            cycles = after.elapsed.cycles;
            if cycles == UNBOUNDED && position + 1 == self.calls.len() {
                return Err(calls.failure());
            }
            memory = after.memory.unwrap_or_default();
        }
        let lines = executed_lines(program);
        Ok(KnownMemoryBound { cycles, lines })
    }

    fn store_inputs(&self, program: &Program<'_>, memory: &mut Contents) -> Result<(), Error> {
        let mut inputs = self.inputs.iter();
        inputs.try_for_each(|input| input.store_any(program.image, memory))
    }
}

fn executed_lines(program: &Program<'_>) -> Vec<LineCount> {
    let mut counts: BTreeMap<(String, u32), u64> = BTreeMap::new();
    program.summaries(|summary: &FunctionSummary| {
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
