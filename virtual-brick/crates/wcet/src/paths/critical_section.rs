// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Longest critical sections (protected actions), for the blocking of more urgent threads.

use crate::error::Error;
use crate::graph::control_flow::Target;
use crate::graph::loop_forest::Loop;
use crate::graph::node_splitting::{reducible, ReducibleGraph};
use crate::graph::subgraph::Subgraph;
use crate::paths::longest_path::{longest_path, PathError, PathProblem};
use crate::values::records::BlockRecord;
use std::collections::{BTreeMap, BTreeSet};

/// Longest time in cycles spent at an urgency or above, by urgency.
pub type CriticalSections = BTreeMap<u32, u64>;

/// Longest critical sections within a function, of whose blocks `records` are known. Whole blocks
/// are counted.
pub fn critical_sections(
    function: &PathProblem<'_>,
    records: &[BlockRecord],
) -> Result<CriticalSections, Error> {
    let levels: BTreeSet<u32> = records.iter().filter_map(|r| r.urgency).collect();
    let mut sections = CriticalSections::new();
    for level in levels {
        let inside = |block: usize| records[block].urgency >= Some(level);
        let mut longest = None;
        for start in entries(function, inside) {
            longest = longest.max(longest_from(function, start, inside).map_err(missing)?);
        }
        sections.insert(level, longest.unwrap_or(0));
    }
    Ok(sections)
}

/// Blocks of a part of a function that are reached from outside of it, on edges that are taken.
fn entries(function: &PathProblem<'_>, inside: impl Fn(usize) -> bool) -> Vec<usize> {
    let blocks = function.flow.blocks.iter().zip(function.cycles).enumerate();
    let outside = blocks.filter(|(index, _)| !inside(*index));
    let edges = outside.flat_map(|(_, (block, cycles))| block.edges.iter().zip(cycles));
    let entered: BTreeSet<usize> = edges
        .filter_map(|(edge, cycles)| match edge.target {
            Target::Block(next) => cycles.map(|_| next),
            Target::Return => None,
        })
        .collect();
    let is_entry = |block: &usize| inside(*block) && (*block == 0 || entered.contains(block));
    (0..function.flow.blocks.len()).filter(is_entry).collect()
}

/// An error that does not name the loops.
pub fn missing(_headers: BTreeSet<usize>) -> Error {
    Error::Input("a loop in a part of a function has no bound".into())
}

/// Longest path within a part of a function that begins at `start`, perhaps amid a loop; none if no
/// path leads out of the part. An error are the first blocks of loops without a bound, in the
/// numbers of the function.
pub fn longest_from(
    function: &PathProblem<'_>,
    start: usize,
    inside: impl Fn(usize) -> bool,
) -> Result<Option<u64>, BTreeSet<usize>> {
    let part = Subgraph::new(function.flow, start, inside, |_, _| true);
    let ReducibleGraph {
        flow,
        forest,
        origin,
    } = reducible(part.flow).map_err(|_| BTreeSet::new())?;
    let origin: Vec<usize> = origin.iter().map(|block| part.origin[*block]).collect();
    let cycles: Vec<_> = origin.iter().map(|b| function.cycles[*b].clone()).collect();
    let bound = |found: &Loop| header_executions(function, found, &origin);
    let problem = PathProblem {
        flow: &flow,
        forest: &forest,
        cycles: &cycles,
        bounds: &forest.loops.iter().map(bound).collect::<Vec<_>>(),
        repeats: &vec![None; forest.loops.len()],
    };
    match longest_path(&problem) {
        Ok(solution) => Ok(Some(solution.cycles)),
        Err(PathError::NoReturn) => Ok(None),
        Err(PathError::Unbounded(loops)) => {
            let headers = loops
                .iter()
                .map(|index| origin[forest.loops[*index].header]);
            Err(headers.collect())
        }
    }
}

/// Most executions of the header of a loop in a part of the function. The part may begin amid loops
/// of the whole function, so its loop may have another header and more blocks than any of these
/// with that header. The smallest loop of the function around all its blocks is not left meanwhile,
/// and within it a block is executed at most once for each execution of the header of its innermost
/// loop, which is entered at most once for each execution of the next header further out.
fn header_executions(function: &PathProblem<'_>, found: &Loop, origin: &[usize]) -> Option<u64> {
    let mut scope = function.forest.innermost[origin[found.header]];
    let mut executions = 1_u64;
    loop {
        let around = &function.forest.loops[scope?];
        executions = executions.saturating_mul(function.bounds[scope?]?);
        let mut blocks = found.blocks.iter();
        if blocks.all(|block| around.blocks.contains(&origin[*block])) {
            return Some(executions);
        }
        scope = around.parent;
    }
}

/// The longer of both for each number; a section at an urgency is one at every lower.
pub fn merge(sections: &mut CriticalSections, more: &CriticalSections) {
    for (urgency, cycles) in more {
        let known = sections.entry(*urgency).or_insert(0);
        *known = (*known).max(*cycles);
    }
}
