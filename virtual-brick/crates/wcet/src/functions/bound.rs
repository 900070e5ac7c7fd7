// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of a function: abstract execution of its graph and, where that cannot follow, the longest
//! path over its blocks. `Program::bound` and the calls in `context_sensitive_calls` need each
//! other: a call that is not analysed in its context costs what `Program::bound` says for its
//! arguments.

use crate::elapsed::{difference, Elapsed, PathTree, UNBOUNDED};
use crate::error::{Error, MissingBound};
use crate::functions::effects::{effects, Endless};
use crate::functions::execution::{combined_bound, execute, longest_call, repeats, Executed};
use crate::functions::function_bound::{BlockBound, BoundOrigin, FunctionBound, LoopBound};
use crate::functions::function_summary::FunctionSummary;
use crate::functions::program::{Arguments, BoundResult, Program};
use crate::functions::remaining_time::remaining_times;
use crate::graph::control_flow::{Block, Target};
use crate::inputs::image::Entry;
use crate::loops::abstract_execution::LoopFinding;
use crate::paths::block_cost::{edge_costs, edge_cycles};
use crate::paths::critical_section::{critical_sections, merge};
use crate::paths::longest_path::{longest_path, LongestPath, PathError, PathProblem};
use crate::values::block_interpreter::{any_arguments, as_arguments};
use crate::values::records::BlockRecord;
use crate::values::state::{State, ANY_URGENCY};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Argument sets for which one function is bounded separately; beyond, for any arguments.
const MAX_CONTEXTS: usize = 256;

impl Program<'_> {
    /// Bound of a function for what is known about its arguments, without the refill of its
    /// return.
    pub fn bound(&self, entry: Entry, arguments: &Arguments) -> BoundResult {
        let recursive = self.facts.recursion(entry).is_some();
        if self.bounding.borrow().contains(&entry) {
            if recursive {
                return Ok(Rc::new(FunctionBound::uncharged(entry)));
            }
            return Err(Error::Recursion(vec![self.image.place(entry.0)]));
        }
        let any = any_arguments();
        let arguments = if recursive { &any } else { arguments };
        if let Some(found) = self.cached_bound(entry, arguments) {
            return found;
        }
        let full = self.bounds.borrow().get(&entry).map_or(0, BTreeMap::len) >= MAX_CONTEXTS;
        let arguments = if full { &any } else { arguments };
        if let Some(found) = self.cached_bound(entry, arguments) {
            return found;
        }
        let found = self.compute_bound(entry, arguments);
        let depends_on_callers = matches!(found, Err(Error::Recursion(_)));
        if !depends_on_callers {
            let mut bounds = self.bounds.borrow_mut();
            let known = bounds.entry(entry).or_default();
            known.insert(arguments.clone(), found.clone());
        }
        found
    }

    fn cached_bound(&self, entry: Entry, arguments: &Arguments) -> Option<BoundResult> {
        self.bounds.borrow().get(&entry)?.get(arguments).cloned()
    }

    fn compute_bound(&self, entry: Entry, arguments: &Arguments) -> BoundResult {
        let summary = self.summary(entry, entry.0)?;
        if summary.avoided.first() == Some(&true) {
            return Err(Error::NeverReturns(self.image.place(entry.0)));
        }
        self.bounding.borrow_mut().push(entry);
        let bound = bound_summary(self, entry, &summary, self.entry_state(entry, arguments));
        self.bounding.borrow_mut().pop();
        let bound = match self.facts.recursion(entry) {
            Some((calls, depth)) => bound_recursive(bound?, calls, depth),
            None => bound?,
        };
        let cycles = self.facts.call_cycles(entry, bound.cycles);
        let more = cycles.saturating_sub(bound.cycles);
        let mut bound = FunctionBound { cycles, ..bound };
        bound.remaining.values_mut().for_each(|rest| *rest += more);
        if let Some(path) = bound.path.as_mut().map(Rc::make_mut) {
            path.difference += difference(cycles, path.cycles());
        }
        Ok(Rc::new(bound))
    }

    /// What holds at the entry. The callers of functions that leave a protected action are in one.
    fn entry_state(&self, entry: Entry, arguments: &Arguments) -> State {
        let mut state = State::entry(arguments);
        state.elapsed = Elapsed::begin(self.paths_recorded);
        if self.conventions.unlocks.contains(&entry.0) {
            state.enter(ANY_URGENCY);
            state.mask_count = None;
        }
        state
    }

    /// Bound of a named function, called from anywhere with any arguments.
    pub fn bound_of(&self, name: &str) -> Result<Rc<FunctionBound>, Error> {
        self.bound(self.function(name)?, &any_arguments())
    }
}

/// A call whose time has a bound only in the context in which it is made.
fn context_bound(program: &Program<'_>, entry: Entry, cycles: u64) -> Result<FunctionBound, Error> {
    let found = effects(program, entry, Endless::EndsProgram)?;
    Ok(FunctionBound {
        cycles,
        stack_bytes: found.stack_bytes,
        stack_lost: found.stack_lost,
        sections: found.sections,
        remaining: program.remaining_in_any(&found.functions, cycles),
        functions: found.functions,
        ..FunctionBound::uncharged(entry)
    })
}

/// A recursive function from one activation.
pub fn bound_recursive(one: FunctionBound, calls: u64, depth: u32) -> FunctionBound {
    let cycles = one.cycles.saturating_mul(calls);
    FunctionBound {
        cycles,
        remaining: one.remaining.keys().map(|group| (*group, cycles)).collect(),
        path: one.path.map(|path| {
            let mut all = PathTree::new(path.entry);
            all.add(&path, calls);
            Rc::new(PathTree { calls: 1, ..all })
        }),
        stack_bytes: one.stack_bytes.and_then(|bytes| bytes.checked_mul(depth)),
        ..one
    }
}

/// Bounds a function whose summary is known, from a state at its entry.
pub fn bound_summary(
    program: &Program<'_>,
    entry: Entry,
    summary: &FunctionSummary,
    state: State,
) -> Result<FunctionBound, Error> {
    let (flow, forest) = (&summary.flow, &summary.forest);
    let Executed {
        findings,
        records,
        elapsed,
    } = execute(program, entry, summary, state);
    let annotated = summary.limits_within(&[entry]);
    let (calls, never_returning) = callee_bounds(program, summary, &records, &|_| true)?;
    let (mut costs, mut charged) = (Vec::new(), Vec::new());
    for (index, block) in flow.blocks.iter().enumerate() {
        let call = longest_call(&calls[index], &records[index], program.paths_recorded);
        let mut edges = edge_costs(block, &summary.costs[index], &records[index], &call);
        for (taken, edge) in edges.iter_mut().zip(&block.edges) {
            if never_returning.contains(&index) && edge.executed {
                *taken = None;
            }
        }
        costs.push(edges);
        charged.push(call.cycles);
    }
    let cycles = costs.iter().map(|edges| edges.iter().map(edge_cycles));
    let cycles: Vec<Vec<_>> = cycles.map(Iterator::collect).collect();
    let bounds: Vec<Option<u64>> = findings
        .iter()
        .zip(&annotated)
        .map(combined_bound)
        .collect();
    let problem = PathProblem {
        flow,
        forest,
        cycles: &cycles,
        bounds: &bounds,
        repeats: &repeats(&findings, forest),
    };
    let solution =
        longest_path(&problem).map_err(|unsolved| path_error(program, entry, summary, unsolved))?;
    let mut sections = critical_sections(&problem, &records)?;
    let unlocks = &program.conventions.unlocks;
    for callee in calls.iter().flatten() {
        if !unlocks.contains(&callee.entry.0) {
            merge(&mut sections, &callee.sections);
        }
    }
    let loops = loop_bounds(summary, &findings, &annotated, &bounds);
    let elapsed = elapsed.filter(|own| own.cycles <= solution.cycles);
    let on_blocks = || path_of(entry, &solution, &costs);
    let path = program.paths_recorded.then(|| {
        let tree = elapsed.as_ref().and_then(|own| own.tree(entry.0));
        Rc::new(tree.unwrap_or_else(on_blocks))
    });
    Ok(FunctionBound {
        entry,
        path_cycles: solution.cycles,
        cycles: elapsed.map_or(solution.cycles, |own| own.cycles),
        path,
        stack_bytes: stack_bound(&records, &calls),
        stack_lost: stack_lost(&records, &calls),
        loops,
        sections,
        remaining: remaining_times(program, &problem, &calls, &charged)?,
        functions: BTreeSet::new(),
        blocks: block_bounds(summary, &solution, cycles, calls, &records),
    })
}

fn loop_bounds(
    summary: &FunctionSummary,
    findings: &[LoopFinding],
    annotated: &[Option<u64>],
    bounds: &[Option<u64>],
) -> Vec<LoopBound> {
    let loops = summary.forest.loops.iter().enumerate();
    let repeats = repeats(findings, &summary.forest);
    let around = |index: usize| {
        let parent = summary.forest.loops[index].parent?;
        Some((repeats[index]?, summary.forest.loops[parent].header))
    };
    loops
        .map(|(index, found)| LoopBound {
            repeats: around(index),
            address: summary.flow.blocks[found.header].node.address,
            number: summary.numbers[index],
            header_executions: bounds[index],
            origin: origin(&findings[index], annotated[index]),
            header: found.header,
            blocks: found.blocks.iter().copied().collect(),
        })
        .collect()
}

fn origin(finding: &LoopFinding, annotated: Option<u64>) -> BoundOrigin {
    match (finding.unbounded || finding.ended_by_fact, annotated) {
        (false, _) => BoundOrigin::Derived,
        (true, Some(_)) => BoundOrigin::Annotated,
        (true, None) => BoundOrigin::NotNeeded,
    }
}

/// Bounds of the functions called at the end of each block, and the blocks whose calls never
/// return with the arguments they have.
type CalleeBounds = (Vec<Vec<Rc<FunctionBound>>>, BTreeSet<usize>);

/// What [`CalleeBounds`] says, of calls of the functions for which `wanted` holds.
pub fn callee_bounds(
    program: &Program<'_>,
    summary: &FunctionSummary,
    records: &[BlockRecord],
    wanted: &dyn Fn(&Entry) -> bool,
) -> Result<CalleeBounds, Error> {
    let (mut all, mut never_returning) = (Vec::new(), BTreeSet::new());
    for (index, block) in summary.flow.blocks.iter().enumerate() {
        let mut bounds = Vec::new();
        let arguments = records[index].arguments.as_ref().map(as_arguments);
        let reached = &records[index].callees;
        for (callee, cached_bound) in block
            .calls
            .iter()
            .filter(|callee| reached.contains(callee) && wanted(callee))
            .flat_map(|c| arguments.iter().map(move |a| (c, a)))
        {
            match program.bound(*callee, cached_bound) {
                Ok(bound) => bounds.push(bound),
                Err(Error::NeverReturns(_)) => {}
                Err(error @ Error::MissingBounds(_)) => match &records[index].callee_elapsed {
                    Some(own) if own.cycles != UNBOUNDED => {
                        bounds.push(Rc::new(context_bound(program, *callee, own.cycles)?));
                    }
                    _ => return Err(error),
                },
                Err(error) => return Err(error),
            }
        }
        if arguments.is_some() && bounds.is_empty() {
            never_returning.insert(index);
        }
        all.push(bounds);
    }
    Ok((all, never_returning))
}

/// The longest path over the blocks.
fn path_of(entry: Entry, solution: &LongestPath, costs: &[Vec<Option<Elapsed>>]) -> PathTree {
    let mut tree = PathTree::new(entry.0);
    tree.calls = 1;
    let counts = solution.counts.iter().flatten();
    for (count, cost) in counts.zip(costs.iter().flatten()) {
        if let Some(cost) = cost.as_ref().filter(|_| *count > 0) {
            cost.add_to_tree(&mut tree, *count);
        }
    }
    tree
}

fn stack_bound(records: &[BlockRecord], calls: &[Vec<Rc<FunctionBound>>]) -> Option<u32> {
    let mut most = 0;
    for (record, callees) in records.iter().zip(calls) {
        most = most.max(record.depth_bytes?);
        for callee in callees {
            most = most.max(record.depth_of_call(callee.stack_bytes)?);
        }
    }
    Some(most)
}

/// The instruction at which the depth of the stack is lost, here or in a callee.
fn stack_lost(records: &[BlockRecord], calls: &[Vec<Rc<FunctionBound>>]) -> Option<u32> {
    let own = records.iter().find_map(|record| record.depth_lost);
    let lost =
        |callee: &Rc<FunctionBound>| callee.stack_lost.filter(|_| callee.stack_bytes.is_none());
    own.or_else(|| calls.iter().flatten().find_map(lost))
}

fn block_bounds(
    summary: &FunctionSummary,
    solution: &LongestPath,
    cycles: Vec<Vec<Option<u64>>>,
    calls: Vec<Vec<Rc<FunctionBound>>>,
    records: &[BlockRecord],
) -> Vec<BlockBound> {
    let parts = cycles.into_iter().zip(calls).zip(records).enumerate();
    parts
        .map(|(index, ((cycles, calls), record))| BlockBound {
            address: summary.flow.blocks[index].node.address,
            count: solution.counts[index].iter().sum(),
            cycles,
            calls,
            targets: targets(&summary.flow.blocks[index]),
            addresses: summary.flow.blocks[index]
                .instructions
                .iter()
                .map(|(address, _)| *address)
                .collect(),
            unknown_accesses: record
                .instructions
                .iter()
                .filter(|i| i.unknown_address)
                .count(),
        })
        .collect()
}

fn targets(block: &Block) -> Vec<Option<usize>> {
    let edges = block.edges.iter();
    edges
        .map(|edge| match edge.target {
            Target::Block(next) => Some(next),
            Target::Return => None,
        })
        .collect()
}

fn path_error(
    program: &Program<'_>,
    entry: Entry,
    summary: &FunctionSummary,
    unsolved: PathError,
) -> Error {
    match unsolved {
        PathError::Unbounded(loops) => {
            let missing = loops.into_iter();
            let active = program.bounding.borrow();
            let callers = active.iter().filter(|active| **active != entry);
            let callers: Vec<_> = callers.map(|f| program.image.name_at(f.0)).collect();
            let missing = missing.map(|index| MissingBound {
                callers: callers.clone(),
                ..summary.missing_bound(&program.facts, index)
            });
            Error::MissingBounds(missing.collect())
        }
        PathError::NoReturn => Error::NeverReturns(program.image.place(entry.0)),
    }
}
