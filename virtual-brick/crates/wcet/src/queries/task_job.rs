// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of a task's jobs: its body is a loop that never ends, cut at the calls in which it waits
//! for its next release. A job is what lies between two of them, the second included.

use crate::error::Error;
use crate::functions::bound::{bound_summary, stack_of, FunctionBound};
use crate::functions::program::Program;
use crate::functions::summary::Summary;
use crate::graph::control_flow::{Entry, Target};
use crate::graph::loop_forest::Forest;
use crate::graph::subgraph::Subgraph;
use crate::paths::block_cost::block_costs;
use crate::values::block::Walker;
use crate::values::state::State;
use std::cell::RefCell;
use std::collections::BTreeSet;

/// Bounds of a task.
pub struct Job {
    /// The longest job, the call in which the task waits included.
    pub bound: FunctionBound,
    /// Stack of the body with all it calls; none when not bounded.
    pub stack_bytes: Option<u32>,
}

/// Bounds the jobs of the task whose body is `body`; `waits` are the functions in which a task
/// waits for its next release.
pub fn bound_job(program: &Program<'_>, body: &str, waits: &[String]) -> Result<Job, Error> {
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
        for (start, state) in resumed(program, &summary, *block) {
            let bound = one_job(program, entry, &summary, &waiting, start, state)?;
            if longest
                .as_ref()
                .is_none_or(|known| known.cycles < bound.cycles)
            {
                longest = Some(bound);
            }
        }
    }
    let bound = longest.ok_or_else(|| Error::NeverReturns(program.image.place(entry.0)))?;
    Ok(Job {
        stack_bytes: stack_of(program, entry, &summary)?,
        bound,
    })
}

/// Where a task goes on after it waited, and what it knows there.
fn resumed(program: &Program<'_>, summary: &Summary, block: usize) -> Vec<(usize, State)> {
    let Some(state) = summary.states[block].clone() else {
        return Vec::new();
    };
    let region = |address| program.given_region(address);
    let mut walker = Walker::new(program.world(), &summary.flow, &summary.callees, &region);
    let leaving = walker.run(block, state).edges.into_iter();
    leaving
        .filter_map(
            |(edge, state)| match summary.flow.blocks[block].edges[edge] {
                way if !way.executed => None,
                way => match way.target {
                    Target::Block(next) => Some((next, state)),
                    Target::Return => None,
                },
            },
        )
        .collect()
}

fn one_job(
    program: &Program<'_>,
    entry: Entry,
    whole: &Summary,
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
    let forest = Forest::new(&part.flow).map_err(|block| {
        Error::Irreducible(program.image.place(part.flow.blocks[block].node.address))
    })?;
    let numbers = forest.loops.iter().map(|found| {
        let header = part.origin[found.header];
        let known = whole.forest.loops.iter().position(|l| l.header == header);
        known.map_or(usize::MAX, |index| whole.numbers[index])
    });
    let numbers: Vec<usize> = numbers.collect();
    let (limits, limits_in) = program.given_bounds(&part.flow, &forest, &numbers);
    let summary = Summary {
        costs: block_costs(program.map, &part.flow)?,
        avoided: program.avoided(&part.flow),
        limits,
        limits_in,
        numbers,
        forest,
        flow: part.flow,
        returns: true,
        changed: whole.changed,
        callees: whole.callees.clone(),
        states: Vec::new(),
        visits: RefCell::default(),
    };
    bound_summary(program, entry, &summary, state)
}
