// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of a task's jobs: its body is a loop that never ends, cut at the calls in which it waits
//! for its next release. A job is what lies between two of them, the second included. The body of a
//! task that ends without a wait is one job.

use crate::elapsed::Elapsed;
use crate::error::{Error, Place};
use crate::functions::bound::bound_summary;
use crate::functions::effects::{collect_functions, effects, effects_of_part, Endless};
use crate::functions::endless_loop::endless_loop;
use crate::functions::function_bound::{BoundOrigin, FunctionBound, RemainingTimes};
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::graph::control_flow::Target;
use crate::graph::loop_forest::LoopForest;
use crate::graph::subgraph::Subgraph;
use crate::inputs::image::Entry;
use crate::paths::critical_section::{merge, CriticalSections};
use crate::values::block_interpreter::{any_arguments, deeper, BlockInterpreter};
use crate::values::state::State;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::rc::Rc;

/// The jobs of a task.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Function with the loop.
    pub body: String,
    /// Functions in which the task waits for its next release.
    pub waits: Vec<String>,
    /// Those in which it waits if its body calls none of `waits`.
    #[serde(default)]
    pub otherwise: Vec<String>,
}

/// Bounds of a task.
pub struct JobBound {
    /// The longest job, the call in which the task waits included.
    pub bound: Rc<FunctionBound>,
    /// Functions that some job may execute.
    pub reached: BTreeSet<u32>,
    /// Those that a job calls before it waits; what happens in those whose suspension is a fact is
    /// left out.
    pub inside: BTreeSet<u32>,
    /// Those in which the task waits for its next release.
    pub waits: BTreeSet<u32>,
    /// Stack of the body with all it calls; none when not bounded.
    pub stack_bytes: Option<u32>,
    /// The instruction at which the depth of the stack is lost, if it is not bounded.
    pub stack_lost: Option<u32>,
}

/// What a task's body does.
pub enum TaskBody {
    /// It has jobs.
    Jobs(JobBound),
    /// It can stay for ever in a loop without a wait, which begins here.
    Endless(Place),
}

/// Bounds the jobs of a task.
pub fn bound_job(program: &Program<'_>, task: &Task) -> Result<TaskBody, Error> {
    let entry = program.function(&task.body)?;
    let summary = program.summary(entry, entry.0)?;
    let mut found = waits_of(program, &summary, &task.waits);
    if found.is_empty() {
        found = waits_of(program, &summary, &task.otherwise);
    }
    if found.is_empty() {
        return body_without_waits(program, task, entry, summary.returns);
    }
    let waiting: Vec<usize> = found.iter().map(|(block, _)| *block).collect();
    let callees: BTreeSet<Entry> = found.into_iter().flat_map(|(_, called)| called).collect();
    let mut longest: Option<FunctionBound> = None;
    let (mut sections, mut remaining) = (CriticalSections::new(), RemainingTimes::new());
    let (mut reached, mut inside) = (BTreeSet::new(), BTreeSet::new());
    let (mut stack_bytes, mut stack_lost) = (Some(0), None);
    for block in &waiting {
        for (start, state) in resume_points(program, &summary, *block) {
            let part = part_of(program, &summary, &waiting, start)?;
            let bound = bound_one_job(program, entry, &part, state)?;
            let mut loops = bound.loops.iter();
            if let Some(endless) = loops.find(|found| found.origin == BoundOrigin::NotNeeded) {
                return Ok(TaskBody::Endless(program.image.place(endless.address)));
            }
            stack_bytes = deeper(stack_bytes, bound.stack_bytes);
            stack_lost = stack_lost.or(bound.stack_lost);
            merge(&mut sections, &bound.sections);
            merge(&mut remaining, &bound.remaining);
            collect_functions(&bound, &|_| false, &mut reached);
            let calls = bound.blocks.iter().flat_map(|block| &block.calls);
            let suspends = |entry| program.facts.added_cycles(entry).is_some();
            calls
                .filter(|callee| !callees.contains(&callee.entry))
                .for_each(|callee| collect_functions(callee, &suspends, &mut inside));
            if longest
                .as_ref()
                .is_none_or(|known| known.cycles < bound.cycles)
            {
                longest = Some(bound);
            }
        }
    }
    let longest = longest.ok_or_else(|| Error::NeverReturns(program.image.place(entry.0)))?;
    let begin = part_of(program, &summary, &waiting, 0)?;
    let before = effects_of_part(program, entry, &begin)?;
    Ok(TaskBody::Jobs(JobBound {
        stack_bytes: deeper(before.stack_bytes, stack_bytes),
        stack_lost: before.stack_lost.or(stack_lost),
        reached,
        inside,
        waits: callees.iter().map(|callee| callee.0).collect(),
        bound: Rc::new(FunctionBound {
            sections,
            remaining,
            ..longest
        }),
    }))
}

/// A body that waits for no release of its own: it ends, or it is a loop without a wait.
fn body_without_waits(
    program: &Program<'_>,
    task: &Task,
    entry: Entry,
    returns: bool,
) -> Result<TaskBody, Error> {
    if returns {
        let bound = program.bound(entry, &any_arguments())?;
        let (mut reached, mut inside) = (BTreeSet::new(), BTreeSet::new());
        let suspends = |entry| program.facts.added_cycles(entry).is_some();
        collect_functions(&bound, &|_| false, &mut reached);
        collect_functions(&bound, &suspends, &mut inside);
        return Ok(TaskBody::Jobs(JobBound {
            stack_bytes: bound.stack_bytes,
            stack_lost: bound.stack_lost,
            reached,
            inside,
            waits: BTreeSet::new(),
            bound,
        }));
    }
    let names = [&task.waits[..], &task.otherwise[..]].concat();
    let reached = effects(program, entry, Endless::Followed)?.functions;
    let mut waits = names.iter().filter_map(|name| program.image.function(name));
    if !waits.any(|wait| reached.contains(&wait.0)) {
        let place = endless_loop(program, entry)?;
        return Ok(TaskBody::Endless(
            place.unwrap_or_else(|| program.image.place(entry.0)),
        ));
    }
    Err(Error::Input(format!(
        "{}: the task '{}' calls none of {} in its own loop; wait there for its next release",
        program.image.place(entry.0),
        task.body,
        names.join(", ")
    )))
}

/// Blocks that call some of these functions, with those they call.
pub fn waits_of(
    program: &Program<'_>,
    summary: &FunctionSummary,
    names: &[String],
) -> Vec<(usize, Vec<Entry>)> {
    let functions = names.iter().filter_map(|name| program.image.function(name));
    let functions: BTreeSet<Entry> = functions.collect();
    let blocks = summary.flow.blocks.iter().enumerate();
    let calls = blocks.map(|(index, block)| {
        let called = block.calls.iter().copied();
        (
            index,
            called.filter(|c| functions.contains(c)).collect::<Vec<_>>(),
        )
    });
    calls.filter(|(_, called)| !called.is_empty()).collect()
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

/// The part of a body from a block to the next waits.
fn part_of(
    program: &Program<'_>,
    whole: &FunctionSummary,
    waiting: &[usize],
    start: usize,
) -> Result<FunctionSummary, Error> {
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
    Ok(FunctionSummary {
        returns: true,
        changed: whole.changed,
        callees: whole.callees.clone(),
        ..FunctionSummary::of_graph(&program.facts, program.map, graph, numbers)?
    })
}

fn bound_one_job(
    program: &Program<'_>,
    entry: Entry,
    part: &FunctionSummary,
    mut state: State,
) -> Result<FunctionBound, Error> {
    state.elapsed = Elapsed::begin(program.paths_recorded);
    program.bounding.borrow_mut().push(entry);
    let bound = bound_summary(program, entry, part, state);
    program.bounding.borrow_mut().pop();
    bound
}
