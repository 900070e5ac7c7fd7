// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Several questions about one program, and their answers, for other programs.

use crate::error::Error;
use crate::functions::bound::FunctionBound;
use crate::functions::program::Program;
use crate::graph::control_flow::Entry;
use crate::inputs::annotations::Annotations;
use crate::inputs::image::Image;
use crate::inputs::memory_map::MemoryMap;
use crate::queries::known_memory::{Closed, LineCount};
use crate::queries::path_problem::Graph;
use crate::queries::report::{name, Report};
use crate::queries::task_job::bound_job;
use crate::values::block::Walker;
use crate::values::value::Value;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// An annotation file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// For messages.
    pub name: String,
    /// TOML.
    pub text: String,
}

/// The jobs of a task.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Function with the loop.
    pub body: String,
    /// Functions in which the task waits for its next release.
    pub waits: Vec<String>,
}

/// All questions.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Request {
    /// Facts about the program.
    pub annotations: Vec<Source>,
    /// Functions to bound.
    pub functions: Vec<String>,
    /// Tasks to bound.
    pub jobs: Vec<Task>,
    /// Function from which calls are searched.
    pub root: Option<String>,
    /// Functions whose arguments at calls are wanted.
    pub callees: Vec<String>,
    /// Graphs are wanted too.
    pub graphs: bool,
    /// Calls that nothing disturbs, to bound as they are.
    pub closed: Option<Closed>,
}

/// A loop that needs a bound.
#[derive(Clone, Debug, Serialize)]
pub struct Missing {
    /// Function.
    pub symbol: String,
    /// Number in it.
    pub index: usize,
    /// File and line of its first instruction, empty when not known.
    pub line: String,
    /// Lines of all its blocks that are in no inner loop.
    pub lines: Vec<(String, u32)>,
}

/// Bounds of a function or a job, or why there are none.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answer {
    /// What was asked for.
    pub symbol: String,
    /// Why there is no bound.
    pub error: Option<String>,
    /// Loops that need a bound.
    pub missing: Vec<Missing>,
    /// Cycles, without the fetches after the return.
    pub cycles: u64,
    /// Stack with all callees.
    pub stack_bytes: Option<u32>,
    /// Longest stays in protected actions: urgency, cycles.
    pub sections: Vec<(u32, u64)>,
    /// All functions that may be executed.
    pub reached: Vec<String>,
    /// How the bound comes about.
    pub report: Option<Report>,
    /// What the longest path was sought in, if it was asked for.
    pub graph: Option<Graph>,
    /// Source lines executed by a call that nothing disturbs.
    pub lines: Vec<LineCount>,
}

/// Arguments at one call.
#[derive(Clone, Debug, Serialize)]
pub struct Call {
    /// Called function.
    pub callee: String,
    /// Calling function.
    pub caller: String,
    /// r0 to r3 where they are constants.
    pub arguments: [Option<u32>; 4],
}

/// What the analysis of functions and jobs went through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Functions.
    pub functions: usize,
    /// Their blocks.
    pub blocks: usize,
    /// Their loops.
    pub loops: usize,
    /// Their instructions.
    pub instructions: usize,
    /// Instructions executed on abstract values.
    pub steps: u64,
}

impl Work {
    fn of(program: &Program<'_>) -> Self {
        let mut work = Self {
            steps: program.steps(),
            ..Self::default()
        };
        program.summaries(|_, summary| {
            let blocks = &summary.flow.blocks;
            work.functions += 1;
            work.blocks += blocks.len();
            work.loops += summary.forest.loops.len();
            work.instructions += blocks.iter().map(|b| b.instructions.len()).sum::<usize>();
        });
        work
    }
}

/// All answers, in the order of the questions.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Response {
    /// What the times are of.
    pub timing: String,
    /// Dearest fetches after a return.
    pub return_cycles: u64,
    /// Bounds of functions.
    pub functions: Vec<Answer>,
    /// Bounds of jobs.
    pub jobs: Vec<Answer>,
    /// Calls that were searched.
    pub calls: Vec<Call>,
    /// Bound of the last of the calls that nothing disturbs.
    pub closed: Option<Answer>,
    /// What was gone through for `functions` and `jobs`.
    pub work: Work,
}

fn reach(bound: &FunctionBound, seen: &mut BTreeSet<u32>) {
    if seen.insert(bound.entry.0) {
        let calls = bound.blocks.iter().flat_map(|block| &block.calls);
        calls.for_each(|callee| reach(callee, seen));
    }
}

fn answer(
    program: &Program<'_>,
    symbol: &str,
    bound: Result<(&FunctionBound, Option<u32>), &Error>,
) -> Answer {
    let (bound, stack_bytes) = match bound {
        Ok(found) => found,
        Err(error) => {
            return Answer {
                symbol: symbol.to_owned(),
                error: Some(error.to_string()),
                missing: missing(error),
                ..Answer::default()
            }
        }
    };
    let mut seen = BTreeSet::new();
    reach(bound, &mut seen);
    Answer {
        symbol: symbol.to_owned(),
        cycles: bound.cycles,
        stack_bytes,
        sections: bound.sections.iter().map(|(u, c)| (*u, *c)).collect(),
        reached: seen.into_iter().map(|entry| name(program, entry)).collect(),
        report: Some(Report::of_bound(program, symbol, bound, bound.cycles)),
        ..Answer::default()
    }
}

fn missing(error: &Error) -> Vec<Missing> {
    let Error::MissingBounds(loops) = error else {
        return Vec::new();
    };
    let each = loops.iter().map(|found| {
        let symbol = found.place.symbol.as_ref().map_or("", |(name, _)| name);
        let line = found.place.line.as_ref();
        let line = line.map_or(String::new(), |(file, line)| format!("{file}:{line}"));
        Missing {
            symbol: symbol.to_owned(),
            index: found.index,
            line,
            lines: found.lines.clone(),
        }
    });
    each.collect()
}

/// Calls of `callees` in everything that `root` calls.
fn calls(program: &Program<'_>, root: &str, callees: &[String]) -> Result<Vec<Call>, Error> {
    let wanted = callees.iter().filter_map(|c| program.image.function(c));
    let wanted: BTreeSet<Entry> = wanted.collect();
    let mut found = Vec::new();
    let mut open = vec![program.function(root)?];
    let mut seen: BTreeSet<Entry> = BTreeSet::new();
    while let Some(entry) = open.pop() {
        if !seen.insert(entry) {
            continue;
        }
        let summary = program.summary(entry, entry.0)?;
        let region = |_| None;
        let mut walker = Walker::new(program.world(), &summary.flow, &summary.callees, &region);
        for (index, block) in summary.flow.blocks.iter().enumerate() {
            open.extend(&block.calls);
            let reached = block.calls.iter().find(|callee| wanted.contains(callee));
            let (Some(callee), Some(state)) = (reached, &summary.states[index]) else {
                continue;
            };
            walker.run(index, state.clone());
            let arguments = walker.records[index].arguments.as_ref();
            found.push(Call {
                callee: name(program, callee.0),
                caller: name(program, entry.0),
                arguments: std::array::from_fn(|n| arguments.and_then(|a| Value::constant(&a[n]))),
            });
        }
    }
    Ok(found)
}

impl Request {
    /// Answers all questions. An error is one of the image or of the annotations as a whole.
    pub fn answer(&self, elf: &[u8], map: &MemoryMap) -> Result<Response, Error> {
        let image = Image::read(elf)?;
        let mut annotations = Annotations::default();
        for source in &self.annotations {
            annotations.extend(Annotations::parse(&source.text, &source.name)?);
        }
        let program = Program::new(&image, map, &annotations)?;
        let mut response = Response {
            timing: map.name.clone(),
            return_cycles: program.return_cycles()?,
            ..Response::default()
        };
        for symbol in &self.functions {
            let bound = program.bound_of(symbol);
            let found = bound.as_ref().map(|bound| (&**bound, bound.stack_bytes));
            let graph = found.as_ref().ok().filter(|_| self.graphs);
            let graph = graph.map(|(bound, _)| Graph::new(&program, bound));
            let found = answer(&program, symbol, found);
            response.functions.push(Answer { graph, ..found });
        }
        for task in &self.jobs {
            let job = bound_job(&program, &task.body, &task.waits);
            let found = job.as_ref().map(|job| (&job.bound, job.stack_bytes));
            let graph = found.as_ref().ok().filter(|_| self.graphs);
            let graph = graph.map(|(bound, _)| Graph::new(&program, bound));
            let found = answer(&program, &task.body, found);
            response.jobs.push(Answer { graph, ..found });
        }
        if let Some(closed) = &self.closed {
            let symbol = closed.calls.last().cloned().unwrap_or_default();
            let found = closed.bound(&image, map, &annotations);
            response.closed = Some(Answer {
                error: found.as_ref().err().map(Error::to_string),
                missing: found.as_ref().err().map(missing).unwrap_or_default(),
                cycles: found.as_ref().map_or(0, |found| found.cycles),
                lines: found.map(|found| found.lines).unwrap_or_default(),
                symbol,
                ..Answer::default()
            });
        }
        response.work = Work::of(&program);
        if let Some(root) = &self.root {
            response.calls = calls(&program, root, &self.callees)?;
        }
        program.check_uses()?;
        Ok(response)
    }
}
