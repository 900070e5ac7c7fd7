// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The longest time that a task executes between two waits and that is none of its jobs: what it
//! does outside of them (set-up, a search), however long that takes in all.
//!
//! Loops that wait in each pass need no bound. Of a function that may wait, four times are known
//! ([`Stretches`]), of which those of its callers are made. Whole blocks are counted, for any
//! arguments. A wait is charged to what it ends.

use crate::error::Error;
use crate::functions::bound::callee_bounds;
use crate::functions::execution::{combined_bound, execute, longest_call};
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::Program;
use crate::graph::control_flow::{ControlFlowGraph, Edge, Target};
use crate::inputs::annotations::Fact;
use crate::inputs::image::Entry;
use crate::paths::block_cost::{edge_costs, edge_cycles};
use crate::paths::critical_section::{longest_from, missing};
use crate::paths::longest_path::PathProblem;
use crate::queries::task_job::{waits_of, Task};
use crate::values::block_interpreter::any_arguments;
use crate::values::state::State;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Longest times in cycles, none where there is no such path.
#[derive(Clone, Copy, Debug, Default)]
struct Stretches {
    /// From the entry to the return, without a wait.
    through: Option<u64>,
    /// From the entry to the first wait.
    head: Option<u64>,
    /// From a wait to the return.
    tail: Option<u64>,
    /// From a wait to the next one.
    between: Option<u64>,
}

/// What a function, with all it calls, may do.
#[derive(Clone, Copy, Debug, Default)]
struct Kind {
    waits: bool,
    outside: bool,
}

struct Search<'p, 'a> {
    program: &'p Program<'a>,
    waits: BTreeSet<Entry>,
    places: &'p [Fact],
    kinds: BTreeMap<Entry, Kind>,
    known: BTreeMap<Entry, Stretches>,
}

/// A function's graph with one more edge out of each block, on which a path may end.
struct Paths<'p, 'a> {
    program: &'p Program<'a>,
    summary: Rc<FunctionSummary>,
    flow: ControlFlowGraph,
    bounds: Vec<Option<u64>>,
    /// Cycles by block and edge, without calls that may wait.
    cycles: Vec<Vec<Option<u64>>>,
    /// Blocks with such calls.
    waiting: BTreeMap<usize, Stretches>,
    /// Blocks that execute code outside of jobs, at least in what they call.
    outside: BTreeSet<usize>,
}

/// Longest time between two waits of a task, on paths with code at one of `places`, or from or to
/// a wait that is not in the task's own loop; none if there is none.
pub fn outside_of_jobs(
    program: &Program<'_>,
    task: &Task,
    places: &[Fact],
) -> Result<Option<u64>, Error> {
    let entry = program.function(&task.body)?;
    let names = task.waits.iter().chain(&task.otherwise);
    let mut search = Search {
        program,
        waits: names
            .filter_map(|name| program.image.function(name))
            .collect(),
        places,
        kinds: BTreeMap::new(),
        known: BTreeMap::new(),
    };
    let paths = search.paths(entry)?;
    let mut own = waits_of(program, &paths.summary, &task.waits);
    if own.is_empty() {
        own = waits_of(program, &paths.summary, &task.otherwise);
    }
    let own: BTreeSet<usize> = own.into_iter().map(|(block, _)| block).collect();
    let wait = |block| paths.to_wait(block);
    let other_wait = |block| paths.to_wait(block).filter(|_| !own.contains(&block));
    let mut longest = None;
    for (block, called) in &paths.waiting {
        if !own.contains(block) {
            let next = paths.after(*block, called.tail, false, &wait)?;
            longest = longest.max(called.between).max(next);
            continue;
        }
        longest = longest.max(paths.after(*block, called.tail, false, &other_wait)?);
        for place in &paths.outside {
            let here = |block| (block == *place).then_some(0);
            let before = paths.after(*block, called.tail, false, &here)?;
            let behind = paths.after(*place, paths.through(*place), false, &wait)?;
            longest = longest.max(sum(before, behind));
        }
    }
    Ok(longest)
}

fn sum(one: Option<u64>, other: Option<u64>) -> Option<u64> {
    Some(one?.saturating_add(other?))
}

impl<'p, 'a> Search<'p, 'a> {
    /// In a function that calls itself, what is not found yet: counted as if it did not wait, it
    /// takes longer.
    fn kind(&mut self, entry: Entry) -> Result<Kind, Error> {
        if let Some(known) = self.kinds.get(&entry) {
            return Ok(*known);
        }
        let mut found = Kind {
            waits: self.waits.contains(&entry),
            outside: false,
        };
        self.kinds.insert(entry, found);
        if !found.waits {
            let summary = self.program.summary(entry, entry.0)?;
            for block in &summary.flow.blocks {
                let mut addresses = block.instructions.iter().map(|(address, _)| *address);
                found.outside |= addresses.any(|address| self.is_outside(address));
                for callee in &block.calls {
                    let called = self.kind(*callee)?;
                    found.waits |= called.waits;
                    found.outside |= called.outside;
                }
            }
            self.kinds.insert(entry, found);
        }
        Ok(found)
    }

    fn is_outside(&self, address: u32) -> bool {
        let image = self.program.image;
        let (place, names) = (image.place(address), image.names_at(address));
        let mut facts = self.places.iter();
        facts.any(|fact| fact.matches(&place, names, None))
    }

    /// Times of a function that may wait.
    fn function(&mut self, entry: Entry) -> Result<Stretches, Error> {
        if let Some(known) = self.known.get(&entry) {
            return Ok(*known);
        }
        if self.program.bounding.borrow().contains(&entry) {
            return Err(Error::Recursion(vec![self.program.image.place(entry.0)]));
        }
        let mut found = Stretches::default();
        if self.waits.contains(&entry) {
            found.head = Some(self.program.bound(entry, &any_arguments())?.cycles);
            found.tail = Some(0);
        } else {
            let paths = self.paths(entry)?;
            let (wait, nowhere) = (|block| paths.to_wait(block), |_| None);
            found.through = paths.longest(0, true, &nowhere)?;
            found.head = paths.longest(0, false, &wait)?;
            for (block, called) in &paths.waiting {
                let tail = paths.after(*block, called.tail, true, &nowhere)?;
                let next = paths.after(*block, called.tail, false, &wait)?;
                found.tail = found.tail.max(tail);
                found.between = found.between.max(called.between).max(next);
            }
        }
        self.known.insert(entry, found);
        Ok(found)
    }

    fn paths(&mut self, entry: Entry) -> Result<Paths<'p, 'a>, Error> {
        let summary = self.program.summary(entry, entry.0)?;
        self.program.bounding.borrow_mut().push(entry);
        let found = self.paths_of(entry, summary);
        self.program.bounding.borrow_mut().pop();
        found
    }

    fn paths_of(
        &mut self,
        entry: Entry,
        summary: Rc<FunctionSummary>,
    ) -> Result<Paths<'p, 'a>, Error> {
        let executed = execute(
            self.program,
            entry,
            &summary,
            State::entry(&any_arguments()),
        );
        let blocks = &summary.flow.blocks;
        let mut times = BTreeMap::new();
        let mut outside = BTreeSet::new();
        for (index, block) in blocks.iter().enumerate() {
            let mut addresses = block.instructions.iter().map(|(address, _)| *address);
            let mut is_outside = addresses.any(|address| self.is_outside(address));
            for callee in &block.calls {
                let kind = self.kind(*callee)?;
                is_outside |= kind.outside;
                if kind.waits {
                    times.insert(*callee, self.function(*callee)?);
                }
            }
            if is_outside {
                outside.insert(index);
            }
        }
        let ordinary = |callee: &Entry| !times.contains_key(callee);
        let (calls, never_returning) =
            callee_bounds(self.program, &summary, &executed.records, &ordinary)?;
        let (mut cycles, mut waiting) = (Vec::new(), BTreeMap::new());
        for (index, block) in blocks.iter().enumerate() {
            let record = &executed.records[index];
            let called = block.calls.iter().filter(|c| record.callees.contains(c));
            let called: Vec<Stretches> = called.filter_map(|c| times.get(c)).copied().collect();
            let call = longest_call(&calls[index], record, false);
            let mut edges = edge_costs(block, &summary.costs[index], record, &call);
            if !called.is_empty() {
                let ordinary = Stretches {
                    through: (!calls[index].is_empty()).then_some(0),
                    ..Stretches::default()
                };
                waiting.insert(index, called.into_iter().fold(ordinary, Stretches::longer));
            } else if never_returning.contains(&index) {
                let each = edges.iter_mut().zip(&block.edges);
                each.filter(|(_, edge)| edge.executed)
                    .for_each(|(taken, _)| *taken = None);
            }
            cycles.push(edges.iter().map(edge_cycles).collect());
        }
        let annotated = summary.limits_within(&[entry]);
        let findings = executed.findings.iter().zip(&annotated);
        let mut flow = summary.flow.clone();
        for block in &mut flow.blocks {
            block.edges.push(Edge {
                executed: false,
                target: Target::Return,
            });
        }
        Ok(Paths {
            program: self.program,
            bounds: findings.map(combined_bound).collect(),
            summary,
            flow,
            cycles,
            waiting,
            outside,
        })
    }
}

impl Stretches {
    fn longer(self, other: Self) -> Self {
        Self {
            through: self.through.max(other.through),
            head: self.head.max(other.head),
            tail: self.tail.max(other.tail),
            between: self.between.max(other.between),
        }
    }
}

impl Paths<'_, '_> {
    /// Loops that are asked for.
    fn missing(&self, headers: BTreeSet<usize>) -> Error {
        let loops = headers
            .iter()
            .filter_map(|h| self.summary.forest.innermost[*h]);
        let bounds = loops.map(|index| self.summary.missing_bound(&self.program.facts, index));
        let bounds: Vec<_> = bounds.collect();
        if bounds.is_empty() {
            return missing(headers);
        }
        Error::MissingBounds(bounds)
    }

    /// What is called at a block, if it is left without a wait.
    fn through(&self, block: usize) -> Option<u64> {
        self.waiting
            .get(&block)
            .map_or(Some(0), |called| called.through)
    }

    /// A block to the end of its first wait.
    fn to_wait(&self, block: usize) -> Option<u64> {
        let own = self.cycles[block].iter().flatten().max();
        sum(own.copied(), self.waiting.get(&block)?.head)
    }

    /// Longest path without a wait from a block on: to a return, if that is an end, or to a block
    /// of which `end` gives the cycles.
    fn longest(
        &self,
        start: usize,
        returns: bool,
        end: &dyn Fn(usize) -> Option<u64>,
    ) -> Result<Option<u64>, Error> {
        let of_block = |(index, own): (usize, &Vec<Option<u64>>)| {
            let edges = self.summary.flow.blocks[index].edges.iter().zip(own);
            let passed = edges.map(|(edge, own)| match edge {
                edge if edge.target == Target::Return && !returns => None,
                edge if edge.executed => sum(*own, self.through(index)),
                _ => *own,
            });
            passed.chain([end(index)]).collect()
        };
        let cycles: Vec<_> = self.cycles.iter().enumerate().map(of_block).collect();
        let problem = PathProblem {
            flow: &self.flow,
            forest: &self.summary.forest,
            cycles: &cycles,
            bounds: &self.bounds,
            repeats: &vec![None; self.bounds.len()],
        };
        longest_from(&problem, start, |_| true).map_err(|headers| self.missing(headers))
    }

    /// The same from behind a block on, of whose calls so many cycles count.
    fn after(
        &self,
        block: usize,
        called: Option<u64>,
        returns: bool,
        end: &dyn Fn(usize) -> Option<u64>,
    ) -> Result<Option<u64>, Error> {
        let mut longest = None;
        let edges = self.summary.flow.blocks[block].edges.iter();
        for (edge, own) in edges.zip(&self.cycles[block]) {
            let rest = match edge.target {
                _ if own.is_none() => None,
                Target::Block(next) => self.longest(next, returns, end)?,
                Target::Return => returns.then_some(0),
            };
            longest = longest.max(sum(sum(*own, called), rest));
        }
        Ok(longest)
    }
}
