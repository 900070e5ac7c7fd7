// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of a task's jobs: its body is a loop that never ends, cut at the calls in which it waits
//! for its next release. A job is what lies between two of them, the second included.

use crate::error::Error;
use crate::functions::bound::{bound_summary, stack_of};
use crate::functions::function_bound::FunctionBound;
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::graph::control_flow::Target;
use crate::graph::loop_forest::LoopForest;
use crate::graph::subgraph::Subgraph;
use crate::inputs::image::Entry;
use crate::values::block_interpreter::BlockInterpreter;
use crate::values::state::State;
use std::collections::BTreeSet;

/// Bounds of a task.
pub struct JobBound {
    /// The longest job, the call in which the task waits included.
    pub bound: FunctionBound,
    /// Stack of the body with all it calls; none when not bounded.
    pub stack_bytes: Option<u32>,
}

/// Bounds the jobs of the task whose body is `body`; `waits` are the functions in which a task
/// waits for its next release.
pub fn bound_job(program: &Program<'_>, body: &str, waits: &[String]) -> Result<JobBound, Error> {
    let entry = program.function(body)?;
    let callees: BTreeSet<Entry> = waits
        .iter()
        .filter_map(|name| program.image.function(name))
        .collect();
    let summary = program.summary(entry, entry.0)?;
    let waiting: Vec<usize> = (0..summary.flow.blocks.len())
        .filter(|block| {
            let calls = &summary.flow.blocks[*block].calls;
            calls.iter().any(|callee| callees.contains(callee))
        })
        .collect();
    if waiting.is_empty() {
        return Err(Error::Input(format!(
            "{}: the task '{body}' calls none of {}; name the function in which it waits for its \
             next release",
            program.image.place(entry.0),
            waits.join(", ")
        )));
    }
    let mut longest: Option<FunctionBound> = None;
    for block in &waiting {
        for (start, state) in resume_points(program, &summary, *block) {
            let bound = bound_one_job(program, entry, &summary, &waiting, start, state)?;
            if longest
                .as_ref()
                .is_none_or(|known| known.cycles < bound.cycles)
            {
                longest = Some(bound);
            }
        }
    }
    let bound = longest.ok_or_else(|| Error::NeverReturns(program.image.place(entry.0)))?;
    Ok(JobBound {
        stack_bytes: stack_of(program, entry, &summary)?,
        bound,
    })
}

/// Where a task goes on after it waited, and what it knows there.
fn resume_points(
    program: &Program<'_>,
    summary: &FunctionSummary,
    block: usize,
) -> Vec<(usize, State)> {
    let Some(state) = summary.states[block].clone() else {
        return Vec::new();
    };
    let mut interpreter =
        BlockInterpreter::new(program.environment(), &summary.flow, &summary.callees);
    let leaving = interpreter.run(block, state).edges.into_iter();
    leaving
        .filter_map(
            |(edge, state)| match summary.flow.blocks[block].edges[edge] {
                edge if !edge.executed => None,
                edge => match edge.target {
                    Target::Block(next) => Some((next, state)),
                    Target::Return => None,
                },
            },
        )
        .collect()
}

fn bound_one_job(
    program: &Program<'_>,
    entry: Entry,
    whole: &FunctionSummary,
    waiting: &[usize],
    start: usize,
    state: State,
) -> Result<FunctionBound, Error> {
    let part = Subgraph::new(
        &whole.flow,
        start,
        |_| true,
        |block, edge| !(edge.executed && waiting.contains(&block)),
    );
    let forest = LoopForest::new(&part.flow).map_err(|block| {
        Error::Irreducible(program.image.place(part.flow.blocks[block].node.address))
    })?;
    let numbers = forest.loops.iter().map(|found| {
        let header = part.origin[found.header];
        let known = whole.forest.loops.iter().position(|l| l.header == header);
        known.map_or(usize::MAX, |index| whole.numbers[index])
    });
    let numbers: Vec<usize> = numbers.collect();
    let graph = (part.flow, forest);
    let summary = FunctionSummary {
        returns: true,
        changed: whole.changed,
        callees: whole.callees.clone(),
        ..FunctionSummary::of_graph(&program.facts, program.map, graph, numbers)?
    };
    bound_summary(program, entry, &summary, state)
}
